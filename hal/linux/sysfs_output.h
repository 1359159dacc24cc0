/// An attribute file that sets an output and is written again and again: something else may change
/// what the device holds.
#ifndef SYSFS_OUTPUT_H
#define SYSFS_OUTPUT_H

#include "linux_error.h"

#include <stdint.h>

typedef struct {
    int fd;
    bool is_readable;
    bool is_known; ///< value was taken
    int64_t value; ///< as written last
} sysfs_output_t;

#define SYSFS_OUTPUT_NONE ((sysfs_output_t){.fd = -1})

/// To write it, and to read it back where the kernel lets it be read.
bool sysfs_output_open(sysfs_output_t *output, const char *path, linux_error_t *error);
void sysfs_output_close(sysfs_output_t *output);

/// Writes it, whatever it was. Returns false iff that is refused.
bool sysfs_output_write(sysfs_output_t *output, int64_t value);

/// Writes it where it is another value than before, or the last one was refused.
bool sysfs_output_put(sysfs_output_t *output, int64_t value);

/// Returns false iff it can be read and says another value than was written last.
bool sysfs_output_holds(const sysfs_output_t *output);

/// When what has not changed is written again.
typedef struct {
    int64_t period_ns;
    int64_t due_ns; ///< CLOCK_MONOTONIC
} refresh_t;

/// Returns true iff it is time: the next one is a period later.
bool refresh_is_due(refresh_t *refresh);

#endif
