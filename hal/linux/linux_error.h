/// Why a backend could not be opened: one line for the user that says what and what to do.
#ifndef LINUX_ERROR_H
#define LINUX_ERROR_H

#include <stdbool.h>

#define LINUX_ERROR_BYTES 256

typedef struct {
    char text[LINUX_ERROR_BYTES];
} linux_error_t;

/// Writes the line (cut where it is too long). error may be NULL. Returns false, so that a function
/// can `return linux_fail(error, ...)`.
__attribute__((format(printf, 2, 3))) bool linux_fail(linux_error_t *error, const char *format,
                                                      ...);

#endif
