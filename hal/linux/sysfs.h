/// The kernel's attribute files: one short text each.
#ifndef SYSFS_H
#define SYSFS_H

#include "linux_error.h"

#include <stddef.h>
#include <stdint.h>

#define SYSFS_PATH_BYTES 256
#define SYSFS_TEXT_BYTES 64

typedef struct {
    char text[SYSFS_PATH_BYTES];
} sysfs_path_t;

/// Joins the formatted path. Returns false and says so where it is too long.
__attribute__((format(printf, 3, 4))) bool sysfs_path(sysfs_path_t *path, linux_error_t *error,
                                                      const char *format, ...);

bool sysfs_exists(const char *path);

/// The file's text without its line end. Returns false, with errno, where it cannot be read or is
/// too long (EOVERFLOW).
bool sysfs_read(const char *path, char text[SYSFS_TEXT_BYTES]);

/// Writes a text to a file that is there. Returns false, with errno, where it is refused.
bool sysfs_write(const char *path, const char *text);
bool sysfs_write_number(const char *path, int64_t number);

/// As sysfs_write_number; says what was refused.
bool sysfs_set(const char *path, int64_t number, linux_error_t *error);

/// A whole decimal number with nothing but white space at its end, in low .. high.
bool sysfs_parse(const char *text, int64_t low, int64_t high, int64_t *number);

/// Reads one from a file that is kept open: its first line. Returns false where that fails.
bool sysfs_read_kept(int fd, int64_t low, int64_t high, int64_t *number);

/// Writes one to a file that is kept open, at its start.
bool sysfs_write_kept(int fd, int64_t number);

/// Folder of an IIO device: "iio:device0", or the name in its file `name`.
bool sysfs_find_iio(const char *root, const char *device, sysfs_path_t *folder,
                    linux_error_t *error);

#endif
