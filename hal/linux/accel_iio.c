// Accelerometer as an IIO device (Documentation/ABI/testing/sysfs-bus-iio).
#include "accel_backends.h"
#include "iio_scan.h"
#include "sysfs.h"

#include <dirent.h>
#include <errno.h>
#include <fcntl.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#define AXES 3
#define BUFFER_SCANS 128
#define READ_SCANS 16u
#define READS_AT_ONCE 16
#define MAX_SCAN_BYTES (AXES * 8u)

static const char axis_letters[AXES] = {'x', 'y', 'z'};

struct accel_iio {
    sysfs_path_t folder;
    bool use_buffer;
    int only_axis; ///< of a sensor that has but one: it answers on all; else -1
    uint32_t failures;
    int raw_fds[AXES]; ///< single reads; -1: no such axis
    int buffer_fd;
    uint32_t scan_bytes;
    iio_channel_t channels[AXES]; ///< storage 0: no such axis
    int32_t counts[AXES];
    bool is_fresh[AXES];
};

static void count_failure(accel_iio_t *self) {
    self->failures += self->failures < UINT32_MAX ? 1u : 0u;
}

static int axis_of(const accel_iio_t *self, hal_axis_t axis) {
    return self->only_axis >= 0 ? self->only_axis : (int)axis;
}

// Single reads: each makes the sensor convert, and takes as long as that takes.

static bool read_single(void *backend, hal_axis_t axis, int32_t *counts) {
    accel_iio_t *const self = backend;
    const int fd = self->raw_fds[axis_of(self, axis)];
    int64_t value;
    if (fd < 0) {
        return false;
    }
    if (!sysfs_read_kept(fd, INT32_MIN, INT32_MAX, &value)) {
        count_failure(self);
        return false;
    }
    *counts = (int32_t)value;
    return true;
}

static bool open_single(accel_iio_t *self, linux_error_t *error) {
    int found = 0;
    for (int i = 0; i < AXES; i++) {
        sysfs_path_t path;
        if (!sysfs_path(&path, error, "%s/in_accel_%c_raw", self->folder.text, axis_letters[i])) {
            return false;
        }
        self->raw_fds[i] = open(path.text, O_RDONLY | O_CLOEXEC);
        if (self->raw_fds[i] >= 0) {
            self->only_axis = i;
            found++;
        } else if (errno != ENOENT) {
            return linux_fail(error, "%s: %s", path.text, strerror(errno));
        }
    }
    if (found != 1) {
        self->only_axis = -1;
    }
    return found > 0 ||
           linux_fail(error, "%s: no in_accel_x_raw, _y_raw or _z_raw: this is no accelerometer",
                      self->folder.text);
}

// Buffer: whole scans from the character device.

static void take_scan(accel_iio_t *self, const uint8_t *scan) {
    for (int i = 0; i < AXES; i++) {
        if (self->channels[i].storage != 0u) {
            self->counts[i] = iio_value(&self->channels[i], scan);
            self->is_fresh[i] = true;
        }
    }
}

/// Takes the newest scan of what has arrived. Bounded.
static void drain(accel_iio_t *self) {
    uint8_t scans[READ_SCANS * MAX_SCAN_BYTES];
    const size_t bytes = READ_SCANS * self->scan_bytes;
    for (int i = 0; i < READS_AT_ONCE; i++) {
        const ssize_t got = read(self->buffer_fd, scans, bytes);
        if (got < 0 && (errno == EAGAIN || errno == EINTR)) {
            return;
        }
        if (got <= 0 || (size_t)got % self->scan_bytes != 0u) {
            count_failure(self);
            return;
        }
        take_scan(self, &scans[(size_t)got - self->scan_bytes]);
        if ((size_t)got < bytes) {
            return;
        }
    }
}

static bool read_buffer(void *backend, hal_axis_t axis, int32_t *counts) {
    accel_iio_t *const self = backend;
    const int index = axis_of(self, axis);
    drain(self);
    if (!self->is_fresh[index]) {
        return false;
    }
    self->is_fresh[index] = false;
    *counts = self->counts[index];
    return true;
}

static bool is_accel(const char *name) {
    return strlen(name) == strlen("in_accel_x_en") &&
           strncmp(name, "in_accel_", strlen("in_accel_")) == 0 &&
           strchr("xyz", name[strlen("in_accel_")]) != NULL;
}

/// Switches the channels in scan_elements on (the axes) or off (all others, a time stamp too).
static bool select_channels(const accel_iio_t *self, linux_error_t *error) {
    sysfs_path_t elements;
    sysfs_path_t path;
    if (!sysfs_path(&elements, error, "%s/scan_elements", self->folder.text)) {
        return false;
    }
    DIR *const folder = opendir(elements.text);
    if (folder == NULL) {
        return linux_fail(error, "%s: %s: this device has no buffer; set use_buffer = false",
                          elements.text, strerror(errno));
    }
    bool is_done = true;
    for (const struct dirent *entry = readdir(folder); entry != NULL && is_done;
         entry = readdir(folder)) {
        const size_t length = strlen(entry->d_name);
        if (length > 3u && strcmp(&entry->d_name[length - 3u], "_en") == 0) {
            is_done = sysfs_path(&path, error, "%s/%s", elements.text, entry->d_name) &&
                      sysfs_set(path.text, is_accel(entry->d_name) ? 1 : 0, error);
        }
    }
    (void)closedir(folder);
    return is_done;
}

/// One axis's place in the scan; none where it has no such file.
static bool read_channel(accel_iio_t *self, int axis, linux_error_t *error) {
    sysfs_path_t path;
    char text[SYSFS_TEXT_BYTES];
    int64_t index;
    const char letter = axis_letters[axis];
    if (!sysfs_path(&path, error, "%s/scan_elements/in_accel_%c_type", self->folder.text, letter)) {
        return false;
    }
    if (!sysfs_exists(path.text)) {
        return true;
    }
    if (!sysfs_read(path.text, text)) {
        return linux_fail(error, "%s: %s", path.text, strerror(errno));
    }
    if (!iio_parse_type(text, &self->channels[axis])) {
        return linux_fail(error, "%s: '%s' is no type that fits 32 bits", path.text, text);
    }
    if (!sysfs_path(&path, error, "%s/scan_elements/in_accel_%c_index", self->folder.text,
                    letter)) {
        return false;
    }
    if (!sysfs_read(path.text, text) || !sysfs_parse(text, 0, INT16_MAX, &index)) {
        return linux_fail(error, "%s: no index of a channel", path.text);
    }
    self->channels[axis].index = (uint32_t)index;
    return true;
}

static bool indices_differ(const iio_channel_t *channels, uint32_t count) {
    for (uint32_t i = 1; i < count; i++) {
        for (uint32_t k = 0; k < i; k++) {
            if (channels[i].index == channels[k].index) {
                return false;
            }
        }
    }
    return true;
}

static bool lay_out(accel_iio_t *self, linux_error_t *error) {
    iio_channel_t present[AXES];
    int axes[AXES];
    uint32_t count = 0;
    for (int i = 0; i < AXES; i++) {
        if (!read_channel(self, i, error)) {
            return false;
        }
        if (self->channels[i].storage != 0u) {
            axes[count] = i;
            present[count++] = self->channels[i];
        }
    }
    if (count == 0u || !indices_differ(present, count)) {
        return linux_fail(error, "%s/scan_elements: %s", self->folder.text,
                          count == 0u ? "no in_accel_x, _y or _z: this is no accelerometer"
                                      : "two axes have the same index");
    }
    self->scan_bytes = iio_lay_out(present, count);
    for (uint32_t i = 0; i < count; i++) {
        self->channels[axes[i]] = present[i];
    }
    self->only_axis = count == 1u ? axes[0] : -1;
    return true;
}

static bool set_trigger(const accel_iio_t *self, const char *trigger, linux_error_t *error) {
    sysfs_path_t path;
    if (trigger == NULL) {
        return true;
    }
    if (!sysfs_path(&path, error, "%s/trigger/current_trigger", self->folder.text)) {
        return false;
    }
    return sysfs_write(path.text, trigger) ||
           linux_fail(error, "%s: cannot set the trigger '%s': %s", path.text, trigger,
                      strerror(errno));
}

static bool set_buffer(const accel_iio_t *self, const char *file, int value, linux_error_t *error) {
    sysfs_path_t path;
    return sysfs_path(&path, error, "%s/buffer/%s", self->folder.text, file) &&
           sysfs_set(path.text, value, error);
}

static bool open_buffer(accel_iio_t *self, const accel_iio_options_t *options,
                        linux_error_t *error) {
    sysfs_path_t path;
    const char *const number = strrchr(self->folder.text, '/');
    // Channels and length can be set only while the buffer is off.
    if (!set_buffer(self, "enable", 0, error) || !select_channels(self, error) ||
        !lay_out(self, error) || !set_trigger(self, options->trigger, error) ||
        !set_buffer(self, "length", BUFFER_SCANS, error) || !set_buffer(self, "enable", 1, error) ||
        !sysfs_path(&path, error, "%s%s", options->dev_root, number)) {
        return false;
    }
    self->buffer_fd = open(path.text, O_RDONLY | O_NONBLOCK | O_CLOEXEC);
    return self->buffer_fd >= 0 || linux_fail(error, "%s: %s", path.text, strerror(errno));
}

accel_iio_t *accel_iio_open(const accel_iio_options_t *options, hal_accel_t *accel,
                            linux_error_t *error) {
    accel_iio_t *const self = calloc(1, sizeof *self);
    if (self == NULL) {
        (void)linux_fail(error, "out of memory");
        return NULL;
    }
    self->use_buffer = options->use_buffer;
    self->only_axis = -1;
    self->buffer_fd = -1;
    for (int i = 0; i < AXES; i++) {
        self->raw_fds[i] = -1;
    }
    if (!sysfs_find_iio(options->sysfs_root, options->device, &self->folder, error) ||
        !(options->use_buffer ? open_buffer(self, options, error) : open_single(self, error))) {
        accel_iio_close(self);
        return NULL;
    }
    *accel =
        (hal_accel_t){.read = options->use_buffer ? read_buffer : read_single, .backend = self};
    return self;
}

void accel_iio_close(accel_iio_t *self) {
    if (self == NULL) {
        return;
    }
    for (int i = 0; i < AXES; i++) {
        if (self->raw_fds[i] >= 0) {
            (void)close(self->raw_fds[i]);
        }
    }
    if (self->buffer_fd >= 0) {
        (void)close(self->buffer_fd);
        (void)set_buffer(self, "enable", 0, NULL); // the device may be gone
    }
    free(self);
}

uint32_t accel_iio_failures(const accel_iio_t *self) {
    return self->failures;
}
