#include "sysfs_output.h"

#include "sysfs.h"
#include "tick_linux.h"

#include <errno.h>
#include <fcntl.h>
#include <string.h>
#include <unistd.h>

static bool can_be_read(int fd) {
    int64_t ignored;
    return sysfs_read_kept(fd, INT64_MIN, INT64_MAX, &ignored);
}

bool sysfs_output_open(sysfs_output_t *output, const char *path, linux_error_t *error) {
    *output = SYSFS_OUTPUT_NONE;
    output->fd = open(path, O_RDWR | O_CLOEXEC);
    output->is_readable = output->fd >= 0 && can_be_read(output->fd);
    if (output->fd < 0 && errno == EACCES) {
        output->fd = open(path, O_WRONLY | O_CLOEXEC);
    }
    return output->fd >= 0 || linux_fail(error, "%s: %s", path, strerror(errno));
}

void sysfs_output_close(sysfs_output_t *output) {
    if (output->fd >= 0) {
        (void)close(output->fd);
    }
    *output = SYSFS_OUTPUT_NONE;
}

bool sysfs_output_write(sysfs_output_t *output, int64_t value) {
    output->is_known = sysfs_write_kept(output->fd, value);
    output->value = value;
    return output->is_known;
}

bool sysfs_output_put(sysfs_output_t *output, int64_t value) {
    return (output->is_known && output->value == value) || sysfs_output_write(output, value);
}

bool sysfs_output_holds(const sysfs_output_t *output) {
    int64_t held;
    return !output->is_readable || !output->is_known ||
           (sysfs_read_kept(output->fd, INT64_MIN, INT64_MAX, &held) && held == output->value);
}

bool refresh_is_due(refresh_t *refresh) {
    const int64_t now_ns = tick_linux_now_ns();
    if (now_ns < refresh->due_ns) {
        return false;
    }
    refresh->due_ns = now_ns + refresh->period_ns;
    return true;
}
