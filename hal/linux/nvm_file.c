#include "nvm_file.h"

#include <errno.h>
#include <fcntl.h>
#include <libgen.h>
#include <limits.h>
#include <stdio.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "crc32.h"

#define MAGIC 0x314D564Eu ///< "NVM1"
#define KIND_BYTES 8u
#define RECORD_WORDS (NVM_MAX_BYTES / 4u)
#define FILE_MODE 0640

/// A file: little-endian as all Linux targets are, zeros after the data up to a whole word.
typedef struct {
    uint32_t magic;
    uint32_t crc;                   ///< CRC-32 of all that follows
    uint32_t kind[KIND_BYTES / 4u]; ///< characters, zeros after them
    uint32_t version;
    uint32_t bytes; ///< of data, without the zeros
    uint32_t data[RECORD_WORDS];
} record_t;

#define HEADER_BYTES offsetof(record_t, data)
#define CRC_FROM_WORD (offsetof(record_t, kind) / 4u)

static size_t file_bytes(size_t bytes) {
    return HEADER_BYTES + (bytes + 3u) / 4u * 4u;
}

static uint32_t crc_of(const record_t *record, size_t bytes) {
    return crc32_words((const uint32_t *)record + CRC_FROM_WORD,
                       (uint32_t)(file_bytes(bytes) / 4u - CRC_FROM_WORD));
}

/// A record without checksum and data.
static void put_header(record_t *record, const char *kind, uint32_t version, size_t bytes) {
    memset(record, 0, sizeof *record);
    record->magic = MAGIC;
    memcpy(record->kind, kind, strnlen(kind, KIND_BYTES));
    record->version = version;
    record->bytes = (uint32_t)bytes;
}

/// Reads to the end of the file, or the record's. Returns the number of bytes, -1 and errno.
static ssize_t read_all(int fd, void *out, size_t bytes) {
    size_t done = 0;
    while (done < bytes) {
        const ssize_t got = read(fd, (uint8_t *)out + done, bytes - done);
        if (got < 0 && errno == EINTR) {
            continue;
        }
        if (got < 0) {
            return -1;
        }
        if (got == 0) {
            break;
        }
        done += (size_t)got;
    }
    return (ssize_t)done;
}

static bool write_all(int fd, const void *bytes, size_t count) {
    size_t done = 0;
    while (done < count) {
        const ssize_t put = write(fd, (const uint8_t *)bytes + done, count - done);
        if (put < 0 && errno == EINTR) {
            continue;
        }
        if (put <= 0) {
            errno = put == 0 ? EIO : errno;
            return false;
        }
        done += (size_t)put;
    }
    return true;
}

/// What is wrong with a record of this many bytes, or NULL.
static const char *judge(const record_t *record, const record_t *expected, size_t got) {
    const bool has_header = got >= HEADER_BYTES;
    if (!has_header || record->magic != MAGIC) {
        return "this is no record";
    }
    if (memcmp(record->kind, expected->kind, KIND_BYTES) != 0) {
        return "it is of another kind";
    }
    if (record->version != expected->version) {
        return "it is of another version";
    }
    if (record->bytes != expected->bytes || got != file_bytes(expected->bytes)) {
        return "its length is wrong";
    }
    return record->crc == crc_of(record, record->bytes) ? NULL : "its checksum is wrong";
}

nvm_verdict_t nvm_file_read(const char *path, const char *kind, uint32_t version, void *data,
                            size_t bytes, linux_error_t *error) {
    record_t record;
    record_t expected;
    if (bytes > NVM_MAX_BYTES) {
        (void)linux_fail(error, "%s: a record has at most %u bytes", path, NVM_MAX_BYTES);
        return NVM_FAILED;
    }
    const int fd = open(path, O_RDONLY | O_CLOEXEC | O_NONBLOCK);
    if (fd < 0 && errno == ENOENT) {
        (void)linux_fail(error, "%s: there is no such file", path);
        return NVM_MISSING;
    }
    const ssize_t got = fd < 0 ? -1 : read_all(fd, &record, sizeof record);
    const int number = errno;
    if (fd >= 0) {
        (void)close(fd);
    }
    if (got < 0) {
        (void)linux_fail(error, "%s: cannot read it: %s", path, strerror(number));
        return NVM_FAILED;
    }
    put_header(&expected, kind, version, bytes);
    const char *const wrong = judge(&record, &expected, (size_t)got);
    if (wrong != NULL) {
        (void)linux_fail(error, "%s: damaged: %s; move it away to start from defaults", path,
                         wrong);
        return NVM_DAMAGED;
    }
    memcpy(data, record.data, bytes);
    return NVM_OK;
}

static bool write_aside(const char *path, const record_t *record) {
    const int fd = open(path, O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC | O_NOFOLLOW, FILE_MODE);
    if (fd < 0) {
        return false;
    }
    const bool is_written = write_all(fd, record, file_bytes(record->bytes)) && fsync(fd) == 0;
    const int number = errno;
    const bool is_closed = close(fd) == 0;
    errno = is_written ? errno : number;
    return is_written && is_closed;
}

bool nvm_sync_folder(const char *path) {
    char folder[PATH_MAX];
    (void)snprintf(folder, sizeof folder, "%s", path);
    const int fd = open(dirname(folder), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
    if (fd < 0) {
        return false;
    }
    const bool is_synced = fsync(fd) == 0;
    const int number = errno;
    (void)close(fd);
    errno = number;
    return is_synced;
}

bool nvm_file_write(const char *path, const char *kind, uint32_t version, const void *data,
                    size_t bytes, linux_error_t *error) {
    record_t record;
    char aside[PATH_MAX];
    const int length = snprintf(aside, sizeof aside, "%s.new", path);
    if (length < 0 || (size_t)length >= sizeof aside || bytes > NVM_MAX_BYTES) {
        return linux_fail(
            error, "%.100s: cannot save: the path is too long, or there are more than %u bytes",
            path, NVM_MAX_BYTES);
    }
    put_header(&record, kind, version, bytes);
    memcpy(record.data, data, bytes);
    record.crc = crc_of(&record, bytes);
    if (!write_aside(aside, &record) || rename(aside, path) != 0) {
        const int number = errno;
        (void)unlink(aside);
        return linux_fail(error, "%s: cannot save: %s", path, strerror(number));
    }
    return nvm_sync_folder(path) ||
           linux_fail(error, "%s: saved, but a power cut may undo it: %s", path, strerror(errno));
}
