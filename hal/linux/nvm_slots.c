#include "nvm_slots.h"

#include <errno.h>
#include <fcntl.h>
#include <limits.h>
#include <stdio.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "crc32.h"

#define MAGIC 0x3153564Eu ///< "NVS1"
#define SLOTS 2u
#define SLOT_STEP 4096 ///< so that two slots are not in one block of a disk
#define FILE_BYTES (SLOTS * SLOT_STEP)
#define FILE_MODE 0640
#define LEAST_BYTES 32u ///< of data, zeros after shorter ones

/// A slot: little-endian as all Linux targets are, zeros after the data up to a whole word.
typedef struct {
    uint32_t magic;
    uint32_t crc;     ///< CRC-32 of all that follows
    uint32_t kind[2]; ///< characters, zeros after them
    uint32_t sequence;
    uint32_t bytes;
    uint32_t data[NVM_SLOT_BYTES / 4u];
} slot_t;

/// On the disk.
static size_t length_of(size_t bytes) {
    return offsetof(slot_t, data) + (bytes > LEAST_BYTES ? (bytes + 3u) / 4u * 4u : LEAST_BYTES);
}

/// bytes: of its data, NVM_SLOT_BYTES at most.
static uint32_t crc_of(const slot_t *slot, size_t bytes) {
    const uint32_t from = offsetof(slot_t, kind) / 4u;
    return crc32_words((const uint32_t *)slot + from, (uint32_t)(length_of(bytes) / 4u) - from);
}

static slot_t make_slot(const char *kind, uint32_t sequence, const void *data, size_t bytes) {
    slot_t slot;
    memset(&slot, 0, sizeof slot);
    slot.magic = MAGIC;
    memcpy(slot.kind, kind, strnlen(kind, sizeof slot.kind));
    slot.sequence = sequence;
    slot.bytes = (uint32_t)bytes;
    memcpy(slot.data, data, bytes);
    slot.crc = crc_of(&slot, bytes);
    return slot;
}

static bool is_whole(const slot_t *slot, const char *kind, size_t bytes) {
    char expected[sizeof slot->kind] = {0};
    memcpy(expected, kind, strnlen(kind, sizeof expected));
    return slot->magic == MAGIC && slot->bytes == bytes && slot->crc == crc_of(slot, bytes) &&
           memcmp(slot->kind, expected, sizeof expected) == 0;
}

/// Reads both slots. Returns false, with errno, where that is refused; *are_whole: both are.
static bool read_slots(int fd, const char *kind, size_t bytes, slot_t slots[SLOTS],
                       bool *are_whole) {
    struct stat about;
    if (fstat(fd, &about) != 0) {
        return false;
    }
    *are_whole = S_ISREG(about.st_mode) && about.st_size == FILE_BYTES;
    for (uint32_t i = 0; *are_whole && i < SLOTS; i++) {
        const ssize_t got = pread(fd, &slots[i], length_of(bytes), (off_t)i * SLOT_STEP);
        if (got < 0) {
            return false;
        }
        *are_whole = got == (ssize_t)length_of(bytes) && is_whole(&slots[i], kind, bytes);
    }
    return true;
}

/// Of sequences that go round.
static uint32_t newer_of(const slot_t slots[SLOTS]) {
    return (int32_t)(slots[1].sequence - slots[0].sequence) > 0 ? 1u : 0u;
}

nvm_verdict_t nvm_slots_read(const char *path, const char *kind, void *data, size_t bytes,
                             linux_error_t *error) {
    slot_t slots[SLOTS];
    bool are_whole = false;
    const int fd = open(path, O_RDONLY | O_CLOEXEC | O_NONBLOCK);
    if (fd < 0 && errno == ENOENT) {
        return NVM_MISSING;
    }
    const bool is_read = fd >= 0 && read_slots(fd, kind, bytes, slots, &are_whole);
    const int number = errno;
    if (fd >= 0) {
        (void)close(fd);
    }
    if (!is_read) {
        (void)linux_fail(error, "%s: cannot read it: %s", path, strerror(number));
        return NVM_FAILED;
    }
    if (!are_whole) {
        (void)linux_fail(error, "%s: damaged", path);
        return NVM_DAMAGED;
    }
    memcpy(data, slots[newer_of(slots)].data, bytes);
    return NVM_OK;
}

static bool write_whole(int fd, const void *bytes, size_t count, off_t at) {
    const ssize_t put = pwrite(fd, bytes, count, at);
    errno = put >= 0 && put != (ssize_t)count ? ENOSPC : errno;
    return put == (ssize_t)count;
}

/// All of its bytes, so that the disk has the room.
static bool fill(const nvm_slots_t *slots, int fd, const void *data) {
    static const uint8_t zeros[FILE_BYTES];
    bool is_done = write_whole(fd, zeros, sizeof zeros, 0);
    for (uint32_t i = 0; is_done && i < SLOTS; i++) {
        const slot_t slot = make_slot(slots->kind, i, data, slots->bytes);
        is_done = write_whole(fd, &slot, length_of(slots->bytes), (off_t)i * SLOT_STEP);
    }
    return is_done && fsync(fd) == 0;
}

static bool make(nvm_slots_t *slots, const char *path, const void *data) {
    char aside[PATH_MAX];
    const int length = snprintf(aside, sizeof aside, "%s.make", path);
    if (length < 0 || (size_t)length >= sizeof aside) {
        errno = ENAMETOOLONG;
        return false;
    }
    const int fd = open(aside, O_RDWR | O_CREAT | O_TRUNC | O_CLOEXEC | O_NOFOLLOW, FILE_MODE);
    if (fd < 0) {
        return false;
    }
    if (!fill(slots, fd, data) || rename(aside, path) != 0 || !nvm_sync_folder(path)) {
        const int number = errno;
        (void)close(fd);
        (void)unlink(aside);
        errno = number;
        return false;
    }
    slots->fd = fd;
    slots->newer = 1;
    slots->sequence = 1;
    return true;
}

/// The file that is there. Returns false where it cannot be written or is damaged.
static bool take(nvm_slots_t *slots, const char *path) {
    slot_t found[SLOTS];
    bool are_whole = false;
    const int fd = open(path, O_RDWR | O_CLOEXEC | O_NOFOLLOW | O_NONBLOCK);
    if (fd < 0) {
        return false;
    }
    if (!read_slots(fd, slots->kind, slots->bytes, found, &are_whole) || !are_whole) {
        (void)close(fd);
        return false;
    }
    slots->fd = fd;
    slots->newer = newer_of(found);
    slots->sequence = found[slots->newer].sequence;
    return true;
}

bool nvm_slots_open(nvm_slots_t *slots, const char *path, const char *kind, const void *data,
                    size_t bytes, linux_error_t *error) {
    *slots = (nvm_slots_t){.fd = -1};
    if (bytes > NVM_SLOT_BYTES) {
        return linux_fail(error, "%s: a slot has at most %u bytes", path, NVM_SLOT_BYTES);
    }
    memcpy(slots->kind, kind, strnlen(kind, sizeof slots->kind - 1u));
    slots->bytes = bytes;
    return take(slots, path) || make(slots, path, data) ||
           linux_fail(error, "%s: cannot reserve its room: %s", path, strerror(errno));
}

void nvm_slots_close(nvm_slots_t *slots) {
    if (slots->fd >= 0) {
        (void)close(slots->fd);
    }
    *slots = (nvm_slots_t){.fd = -1};
}

bool nvm_slots_write(nvm_slots_t *slots, const void *data) {
    const uint32_t older = 1u - slots->newer;
    const slot_t slot = make_slot(slots->kind, slots->sequence + 1u, data, slots->bytes);
    if (!write_whole(slots->fd, &slot, length_of(slots->bytes), (off_t)older * SLOT_STEP) ||
        fdatasync(slots->fd) != 0) {
        return false;
    }
    slots->newer = older;
    slots->sequence++;
    return true;
}

bool nvm_slots_are_at(const nvm_slots_t *slots, const char *path) {
    struct stat mine;
    struct stat there;
    return slots->fd >= 0 && fstat(slots->fd, &mine) == 0 && lstat(path, &there) == 0 &&
           mine.st_dev == there.st_dev && mine.st_ino == there.st_ino;
}
