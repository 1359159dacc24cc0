#include "sysfs.h"

#include <dirent.h>
#include <errno.h>
#include <fcntl.h>
#include <inttypes.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#define IIO_PREFIX "iio:device"

bool sysfs_path(sysfs_path_t *path, linux_error_t *error, const char *format, ...) {
    va_list arguments;
    path->text[0] = '\0';
    va_start(arguments, format);
    const int bytes = vsnprintf(path->text, sizeof path->text, format, arguments);
    va_end(arguments);
    if (bytes < 0 || (size_t)bytes >= sizeof path->text) {
        return linux_fail(error, "%.60s...: the path is too long", path->text);
    }
    return true;
}

bool sysfs_exists(const char *path) {
    return access(path, F_OK) == 0;
}

bool sysfs_read(const char *path, char text[SYSFS_TEXT_BYTES]) {
    const int fd = open(path, O_RDONLY | O_CLOEXEC);
    if (fd < 0) {
        return false;
    }
    const ssize_t bytes = read(fd, text, SYSFS_TEXT_BYTES);
    const int number = errno;
    (void)close(fd);
    errno = bytes < 0 ? number : EOVERFLOW;
    if (bytes < 0 || bytes == SYSFS_TEXT_BYTES) {
        return false;
    }
    text[bytes] = '\0';
    text[strcspn(text, "\n")] = '\0';
    return true;
}

bool sysfs_write(const char *path, const char *text) {
    const int fd = open(path, O_WRONLY | O_CLOEXEC);
    if (fd < 0) {
        return false;
    }
    const size_t bytes = strlen(text);
    const bool is_written = write(fd, text, bytes) == (ssize_t)bytes;
    const int number = errno;
    const bool is_closed = close(fd) == 0;
    errno = is_written ? errno : number;
    return is_written && is_closed;
}

bool sysfs_write_number(const char *path, int64_t number) {
    char text[SYSFS_TEXT_BYTES];
    (void)snprintf(text, sizeof text, "%" PRId64, number);
    return sysfs_write(path, text);
}

bool sysfs_set(const char *path, int64_t number, linux_error_t *error) {
    return sysfs_write_number(path, number) ||
           linux_fail(error, "%s: cannot write %" PRId64 ": %s", path, number, strerror(errno));
}

bool sysfs_parse(const char *text, int64_t low, int64_t high, int64_t *number) {
    char *end = NULL;
    errno = 0;
    const long long value = strtoll(text, &end, 10);
    if (end == text || errno != 0 || value < low || value > high) {
        return false;
    }
    if (end[strspn(end, " \t\n")] != '\0') {
        return false;
    }
    *number = value;
    return true;
}

bool sysfs_read_kept(int fd, int64_t low, int64_t high, int64_t *number) {
    char text[SYSFS_TEXT_BYTES];
    const ssize_t bytes = pread(fd, text, sizeof text - 1u, 0);
    if (bytes <= 0) {
        return false;
    }
    text[bytes] = '\0';
    text[strcspn(text, "\n")] = '\0';
    return sysfs_parse(text, low, high, number);
}

bool sysfs_write_kept(int fd, int64_t number) {
    char text[SYSFS_TEXT_BYTES];
    const int bytes = snprintf(text, sizeof text, "%" PRId64 "\n", number);
    return pwrite(fd, text, (size_t)bytes, 0) == bytes;
}

static bool has_name(const char *root, const char *entry, const char *name) {
    sysfs_path_t path;
    char text[SYSFS_TEXT_BYTES];
    return sysfs_path(&path, NULL, "%s/%s/name", root, entry) && sysfs_read(path.text, text) &&
           strcmp(text, name) == 0;
}

static bool find_by_name(const char *root, const char *name, sysfs_path_t *folder,
                         linux_error_t *error) {
    DIR *const devices = opendir(root);
    int found = 0;
    bool fits = true;
    if (devices == NULL) {
        return linux_fail(error, "IIO device '%s': %s: %s", name, root, strerror(errno));
    }
    for (const struct dirent *entry = readdir(devices); entry != NULL; entry = readdir(devices)) {
        if (strncmp(entry->d_name, IIO_PREFIX, strlen(IIO_PREFIX)) == 0 &&
            has_name(root, entry->d_name, name)) {
            fits = sysfs_path(folder, error, "%s/%s", root, entry->d_name);
            found++;
        }
    }
    (void)closedir(devices);
    if (found > 1) {
        return linux_fail(error,
                          "IIO device '%s': %d devices in %s have this name; give iio:deviceN",
                          name, found, root);
    }
    return found == 1
               ? fits
               : linux_fail(error, "IIO device '%s': there is none of this name in %s", name, root);
}

bool sysfs_find_iio(const char *root, const char *device, sysfs_path_t *folder,
                    linux_error_t *error) {
    if (device == NULL || device[0] == '\0' || strchr(device, '/') != NULL) {
        return linux_fail(error, "IIO device '%s': give iio:device0, or the device's name",
                          device != NULL ? device : "");
    }
    if (strncmp(device, IIO_PREFIX, strlen(IIO_PREFIX)) != 0) {
        return find_by_name(root, device, folder, error);
    }
    if (!sysfs_path(folder, error, "%s/%s", root, device)) {
        return false;
    }
    return sysfs_exists(folder->text) ||
           linux_fail(error, "IIO device '%s': there is none in %s", device, root);
}
