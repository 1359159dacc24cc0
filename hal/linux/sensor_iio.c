// One channel of an IIO device (Documentation/ABI/testing/sysfs-bus-iio), read by itself.
#include "accel_backends.h"
#include "sysfs.h"

#include <errno.h>
#include <fcntl.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

struct sensor_iio {
    uint32_t failures;
    int raw_fd;
};

// It has one axis only.
static bool read_raw(void *backend, hal_axis_t axis, int32_t *counts) {
    sensor_iio_t *const self = backend;
    int64_t value;
    (void)axis;
    if (!sysfs_read_kept(self->raw_fd, INT32_MIN, INT32_MAX, &value)) {
        self->failures += self->failures < UINT32_MAX ? 1u : 0u;
        return false;
    }
    *counts = (int32_t)value;
    return true;
}

static bool open_raw(sensor_iio_t *self, const sensor_iio_options_t *options,
                     linux_error_t *error) {
    sysfs_path_t folder;
    sysfs_path_t path;
    if (!sysfs_find_iio(options->sysfs_root, options->device, &folder, error) ||
        !sysfs_path(&path, error, "%s/in_%s_raw", folder.text, options->channel)) {
        return false;
    }
    self->raw_fd = open(path.text, O_RDONLY | O_CLOEXEC);
    return self->raw_fd >= 0 || linux_fail(error, "%s: %s", path.text, strerror(errno));
}

sensor_iio_t *sensor_iio_open(const sensor_iio_options_t *options, hal_accel_t *sensor,
                              linux_error_t *error) {
    sensor_iio_t *const self = calloc(1, sizeof *self);
    if (self == NULL) {
        (void)linux_fail(error, "out of memory");
        return NULL;
    }
    self->raw_fd = -1;
    if (!open_raw(self, options, error)) {
        sensor_iio_close(self);
        return NULL;
    }
    *sensor = (hal_accel_t){.read = read_raw, .backend = self};
    return self;
}

void sensor_iio_close(sensor_iio_t *self) {
    if (self == NULL) {
        return;
    }
    if (self->raw_fd >= 0) {
        (void)close(self->raw_fd);
    }
    free(self);
}

uint32_t sensor_iio_failures(const sensor_iio_t *self) {
    return self->failures;
}
