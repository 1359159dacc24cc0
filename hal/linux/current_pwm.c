// Current driver at a PWM output (Documentation/driver-api/pwm.rst, sysfs interface).
//
// Order of writes: the duty cycle is right before the output goes on; the output is off before the
// duty cycle moves. An inverted driver has its full current at 0 % and so where the output is off:
// it is kept on, at 100 %.
//
// The kernel drops a write of what it believes the chip to hold. So that it does reach the chip
// again the duty cycle goes a nanosecond beside first, at each refresh.
//
// A channel that has just been exported belongs to root until udev's rule has given it to the
// program's group, a moment later: opening waits for that.
#include "current_backends.h"
#include "current_scale.h"
#include "sysfs.h"
#include "sysfs_output.h"

#include <errno.h>
#include <fcntl.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

#define NS_PER_MS 1000000
#define ACCESS_TRIES 100
#define ACCESS_PAUSE_NS 10000000 // 1 s in all

struct current_pwm {
    sysfs_path_t folder;
    int32_t full_scale_mA;
    int64_t zero_ns; ///< duty cycle at 0 mA and at full scale
    int64_t full_ns;
    bool is_inverted;
    sysfs_output_t duty_ns;
    sysfs_output_t enable;
    refresh_t refresh;
    uint32_t failures;
};

static bool noted(current_pwm_t *self, bool is_right) {
    self->failures += !is_right && self->failures < UINT32_MAX ? 1u : 0u;
    return is_right;
}

/// A nanosecond of less current; where there is none, of more.
static int64_t beside(const current_pwm_t *self, int64_t duty_ns) {
    const int64_t less_ns = self->is_inverted ? duty_ns + 1 : duty_ns - 1;
    const bool has_less = self->is_inverted ? duty_ns < self->zero_ns : duty_ns > 0;
    return has_less ? less_ns : 2 * duty_ns - less_ns;
}

/// What is held is looked at, and everything is written anew.
static void begin_refresh(current_pwm_t *self, int64_t duty_ns) {
    (void)noted(self, sysfs_output_holds(&self->duty_ns));
    (void)noted(self, sysfs_output_holds(&self->enable));
    if (self->duty_ns.is_known && self->duty_ns.value == duty_ns) {
        (void)noted(self, sysfs_output_write(&self->duty_ns, beside(self, duty_ns)));
    }
    self->enable.is_known = false;
}

static void write_current(void *backend, int32_t current_mA, bool enable) {
    current_pwm_t *const self = backend;
    const int64_t duty_ns =
        enable ? current_scale(current_mA, self->full_scale_mA, self->zero_ns, self->full_ns)
               : self->zero_ns;
    const bool is_on = enable || self->is_inverted;
    if (refresh_is_due(&self->refresh)) {
        begin_refresh(self, duty_ns);
    }
    if (!is_on) {
        (void)noted(self, sysfs_output_put(&self->enable, 0));
    }
    if (noted(self, sysfs_output_put(&self->duty_ns, duty_ns)) && is_on) {
        (void)noted(self, sysfs_output_put(&self->enable, 1));
    }
}

/// Makes the channel's folder appear.
static bool export_channel(const current_pwm_options_t *options, sysfs_path_t *folder,
                           linux_error_t *error) {
    sysfs_path_t chip;
    sysfs_path_t exporter;
    int64_t channels;
    char text[SYSFS_TEXT_BYTES];
    if (!sysfs_path(&chip, error, "%s/%s/npwm", options->sysfs_root, options->chip)) {
        return false;
    }
    if (!sysfs_read(chip.text, text) || !sysfs_parse(text, 1, INT32_MAX, &channels)) {
        return linux_fail(error, "PWM chip '%s': there is none in %s", options->chip,
                          options->sysfs_root);
    }
    if (options->channel >= channels) {
        return linux_fail(error, "PWM chip '%s': channel %u: it has 0 .. %d", options->chip,
                          options->channel, (int)channels - 1);
    }
    if (!sysfs_path(folder, error, "%s/%s/pwm%u", options->sysfs_root, options->chip,
                    options->channel) ||
        !sysfs_path(&exporter, error, "%s/%s/export", options->sysfs_root, options->chip)) {
        return false;
    }
    if (sysfs_exists(folder->text)) {
        return true;
    }
    if (!sysfs_write_number(exporter.text, options->channel)) {
        return linux_fail(error, "PWM chip '%s': cannot export channel %u: %s%s", options->chip,
                          options->channel, strerror(errno),
                          errno == EBUSY ? " (a driver of the kernel has it)" : "");
    }
    return sysfs_exists(folder->text) ||
           linux_fail(error, "PWM chip '%s': channel %u did not appear", options->chip,
                      options->channel);
}

/// False where one of the channel's files is there but not to be written.
static bool is_ours(const sysfs_path_t *folder) {
    static const char *const files[] = {"period", "duty_cycle", "enable", "polarity"};
    sysfs_path_t path;
    for (size_t i = 0; i < sizeof files / sizeof files[0]; i++) {
        if (sysfs_path(&path, NULL, "%s/%s", folder->text, files[i]) &&
            faccessat(AT_FDCWD, path.text, W_OK, AT_EACCESS) != 0 && errno == EACCES) {
            return false;
        }
    }
    return true;
}

/// Where rights do not come, the first write says so.
static void await_rights(const sysfs_path_t *folder) {
    const struct timespec pause = {.tv_nsec = ACCESS_PAUSE_NS};
    for (int tries = 0; tries < ACCESS_TRIES && !is_ours(folder); tries++) {
        (void)nanosleep(&pause, NULL);
    }
}

static bool get(const current_pwm_t *self, const char *file, int64_t *value, linux_error_t *error) {
    sysfs_path_t path;
    char text[SYSFS_TEXT_BYTES];
    return sysfs_path(&path, error, "%s/%s", self->folder.text, file) &&
           ((sysfs_read(path.text, text) && sysfs_parse(text, 0, INT64_MAX, value)) ||
            linux_fail(error, "%s: not the number that a PWM has there", path.text));
}

static bool set(const current_pwm_t *self, const char *file, int64_t value, linux_error_t *error) {
    sysfs_path_t path;
    return sysfs_path(&path, error, "%s/%s", self->folder.text, file) &&
           sysfs_set(path.text, value, error);
}

/// is_inverted is for the driver behind the pin; the pin itself is not to invert once more.
static bool set_polarity(const current_pwm_t *self, linux_error_t *error) {
    sysfs_path_t path;
    char text[SYSFS_TEXT_BYTES];
    if (!sysfs_path(&path, error, "%s/polarity", self->folder.text)) {
        return false;
    }
    if (!sysfs_read(path.text, text) || strcmp(text, "normal") == 0) {
        return true; // a chip that cannot invert has no such file
    }
    // The kernel changes it only while the output is off.
    return set(self, "enable", 0, error) &&
           (sysfs_write(path.text, "normal") ||
            linux_fail(error, "%s: cannot write normal: %s", path.text, strerror(errno)));
}

/// Period and zero current, without a moment of more. The kernel refuses a duty cycle beyond the
/// period, and every write but the period's while that is 0.
static bool set_period(const current_pwm_t *self, int64_t period_ns, linux_error_t *error) {
    int64_t enable = 0;
    int64_t duty_ns = 0;
    if (!get(self, "enable", &enable, error) || !get(self, "duty_cycle", &duty_ns, error)) {
        return false;
    }
    if (!self->is_inverted && enable != 0 && !set(self, "enable", 0, error)) {
        return false;
    }
    const bool is_duty_first = self->is_inverted ? duty_ns > period_ns : duty_ns > 0;
    return (!is_duty_first || set(self, "duty_cycle", self->zero_ns, error)) &&
           set(self, "period", period_ns, error) && set_polarity(self, error) &&
           set(self, "duty_cycle", self->zero_ns, error);
}

static bool open_kept(const current_pwm_t *self, const char *file, sysfs_output_t *output,
                      linux_error_t *error) {
    sysfs_path_t path;
    return sysfs_path(&path, error, "%s/%s", self->folder.text, file) &&
           sysfs_output_open(output, path.text, error);
}

static bool set_up(current_pwm_t *self, const current_pwm_options_t *options,
                   linux_error_t *error) {
    if (!export_channel(options, &self->folder, error)) {
        return false;
    }
    await_rights(&self->folder);
    if (!set_period(self, options->period_ns, error)) {
        return false;
    }
    if (!open_kept(self, "duty_cycle", &self->duty_ns, error) ||
        !open_kept(self, "enable", &self->enable, error)) {
        return false;
    }
    write_current(self, 0, false);
    const bool is_held = sysfs_output_holds(&self->duty_ns) && sysfs_output_holds(&self->enable);
    return (self->failures == 0u && is_held) ||
           linux_fail(error, "%s: cannot switch to zero current", self->folder.text);
}

static bool check(const current_pwm_options_t *options, linux_error_t *error) {
    if (options->chip == NULL || options->chip[0] == '\0' || strchr(options->chip, '/') != NULL) {
        return linux_fail(error, "PWM chip '%s': give it as pwmchip0",
                          options->chip != NULL ? options->chip : "");
    }
    if (options->period_ns == 0u || options->full_scale_mA < 1) {
        return linux_fail(error, "PWM chip '%s': period and full scale must be at least 1",
                          options->chip);
    }
    return true;
}

current_pwm_t *current_pwm_open(const current_pwm_options_t *options, hal_current_t *current,
                                linux_error_t *error) {
    if (!check(options, error)) {
        return NULL;
    }
    current_pwm_t *const self = calloc(1, sizeof *self);
    if (self == NULL) {
        (void)linux_fail(error, "out of memory");
        return NULL;
    }
    *self = (current_pwm_t){
        .full_scale_mA = options->full_scale_mA,
        .zero_ns = options->is_inverted ? options->period_ns : 0,
        .full_ns = options->is_inverted ? 0 : options->period_ns,
        .is_inverted = options->is_inverted,
        .duty_ns = SYSFS_OUTPUT_NONE,
        .enable = SYSFS_OUTPUT_NONE,
        .refresh = {.period_ns = (int64_t)options->refresh_ms * NS_PER_MS},
    };
    if (!set_up(self, options, error)) {
        current_pwm_close(self);
        return NULL;
    }
    *current = (hal_current_t){.write = write_current, .backend = self};
    return self;
}

void current_pwm_close(current_pwm_t *self) {
    if (self == NULL) {
        return;
    }
    if (self->duty_ns.fd >= 0) {
        (void)sysfs_output_write(&self->duty_ns, self->zero_ns);
    }
    sysfs_output_close(&self->duty_ns);
    sysfs_output_close(&self->enable);
    free(self);
}

uint32_t current_pwm_failures(const current_pwm_t *self) {
    return self->failures;
}
