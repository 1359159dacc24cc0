/// Current drivers on Linux. CAN needs none: the demand frame goes out every tick (node.h).
///
/// What a driver holds may change behind our back (a disturbance, another program). So a command
/// that has not changed is written again every refresh_ms, by the first write after it, and what
/// can be read is read before: a device that does not hold what it was told counts as a failed
/// write.
///
/// Second way to the safe current where the program dies: a CAN driver by its own timeout; PWM and
/// DAC by `quiesced --make-safe`, which systemd runs as ExecStopPost, by the enable line, and by
/// the hardware watchdog.
#ifndef CURRENT_BACKENDS_H
#define CURRENT_BACKENDS_H

#include "hal_linux.h"
#include "linux_error.h"

#include <stdint.h>

/// A driver whose current is proportional to the duty cycle (/sys/class/pwm).
typedef struct {
    const char *chip; ///< "pwmchip0"
    uint32_t channel;
    uint32_t period_ns;
    int32_t full_scale_mA;  ///< at 100 % duty
    uint32_t refresh_ms;    ///< 0: every write
    bool is_inverted;       ///< 0 % duty is the full scale: the output is then never switched off
    const char *sysfs_root; ///< "/sys/class/pwm"
} current_pwm_options_t;

typedef struct current_pwm current_pwm_t;
/// Waits up to a second for the right to write to the channel: udev gives it after the export.
current_pwm_t *current_pwm_open(const current_pwm_options_t *options, hal_current_t *current,
                                linux_error_t *error);
/// Leaves the duty at zero current and the output on or off as the last command said.
void current_pwm_close(current_pwm_t *self);

/// A driver whose current is proportional to a voltage (out_voltageN_raw of an IIO DAC).
typedef struct {
    const char *device; ///< "iio:device1", or the device's name
    uint32_t channel;
    int32_t zero_code; ///< at 0 mA
    int32_t full_scale_code;
    int32_t full_scale_mA;
    uint32_t refresh_ms;    ///< 0: every write
    const char *sysfs_root; ///< "/sys/bus/iio/devices"
} current_dac_options_t;

typedef struct current_dac current_dac_t;
/// Has no output stage to switch off: enable = false is zero_code.
current_dac_t *current_dac_open(const current_dac_options_t *options, hal_current_t *current,
                                linux_error_t *error);
void current_dac_close(current_dac_t *self);

/// Writes that failed, or that the device did not hold, since the opening, saturating; the program
/// reports them.
uint32_t current_pwm_failures(const current_pwm_t *self);
uint32_t current_dac_failures(const current_dac_t *self);

#endif
