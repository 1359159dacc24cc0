// Current driver at an IIO DAC (out_voltageN_raw).
#include "current_backends.h"
#include "current_scale.h"
#include "sysfs.h"
#include "sysfs_output.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>

#define NS_PER_MS 1000000

struct current_dac {
    current_dac_options_t options;
    sysfs_output_t code;
    refresh_t refresh;
    uint32_t failures;
};

static void count_failure(current_dac_t *self) {
    self->failures += self->failures < UINT32_MAX ? 1u : 0u;
}

/// There is no output stage to switch off: zero current instead.
static void write_current(void *backend, int32_t current_mA, bool enable) {
    current_dac_t *const self = backend;
    const current_dac_options_t *const options = &self->options;
    const int64_t code = current_scale(enable ? current_mA : 0, options->full_scale_mA,
                                       options->zero_code, options->full_scale_code);
    if (refresh_is_due(&self->refresh)) {
        if (!sysfs_output_holds(&self->code)) {
            count_failure(self);
        }
        self->code.is_known = false;
    }
    if (!sysfs_output_put(&self->code, code)) {
        count_failure(self);
    }
}

/// Zero current first, then the output on, where the DAC can be powered down.
static bool power_up(const sysfs_path_t *folder, uint32_t channel, linux_error_t *error) {
    sysfs_path_t path;
    return sysfs_path(&path, error, "%s/out_voltage%u_powerdown", folder->text, channel) &&
           (!sysfs_exists(path.text) || sysfs_set(path.text, 0, error));
}

static bool set_up(current_dac_t *self, linux_error_t *error) {
    const current_dac_options_t *const options = &self->options;
    sysfs_path_t folder;
    sysfs_path_t raw;
    if (!sysfs_find_iio(options->sysfs_root, options->device, &folder, error) ||
        !sysfs_path(&raw, error, "%s/out_voltage%u_raw", folder.text, options->channel)) {
        return false;
    }
    if (!sysfs_output_open(&self->code, raw.text, error)) {
        return false;
    }
    write_current(self, 0, false);
    if (self->failures != 0u) {
        return linux_fail(error, "%s: cannot write %d: %s", raw.text, (int)options->zero_code,
                          strerror(errno));
    }
    if (!sysfs_output_holds(&self->code)) {
        return linux_fail(error, "%s: does not hold the %d that was written", raw.text,
                          (int)options->zero_code);
    }
    return power_up(&folder, options->channel, error);
}

current_dac_t *current_dac_open(const current_dac_options_t *options, hal_current_t *current,
                                linux_error_t *error) {
    if (options->full_scale_mA < 1 || options->zero_code == options->full_scale_code) {
        (void)linux_fail(error,
                         "IIO DAC '%s': full scale must be at least 1 mA, and its code another "
                         "one than that of 0 mA",
                         options->device != NULL ? options->device : "");
        return NULL;
    }
    current_dac_t *const self = calloc(1, sizeof *self);
    if (self == NULL) {
        (void)linux_fail(error, "out of memory");
        return NULL;
    }
    *self = (current_dac_t){
        .options = *options,
        .code = SYSFS_OUTPUT_NONE,
        .refresh = {.period_ns = (int64_t)options->refresh_ms * NS_PER_MS},
    };
    if (!set_up(self, error)) {
        current_dac_close(self);
        return NULL;
    }
    *current = (hal_current_t){.write = write_current, .backend = self};
    return self;
}

void current_dac_close(current_dac_t *self) {
    if (self == NULL) {
        return;
    }
    if (self->code.fd >= 0) {
        (void)sysfs_output_write(&self->code, self->options.zero_code);
        sysfs_output_close(&self->code);
    }
    free(self);
}

uint32_t current_dac_failures(const current_dac_t *self) {
    return self->failures;
}
