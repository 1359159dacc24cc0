/// Simulated peripherals, caller-owned: what the host bench and the lock-step images run on.
/// The HAL sees hal_accel_t and hal_current_t; whoever simulates steers them through this header.
#ifndef HAL_SIM_H
#define HAL_SIM_H

#include "hal/accel.h"
#include "hal/current.h"

struct hal_accel {
    int32_t counts;
    bool is_fresh;
    hal_axis_t axis; ///< that was read last
};

struct hal_current {
    int32_t command_mA;
    bool is_enabled;
    int32_t measured_mA;
    bool has_measurement;
};

/// Next sample of the accelerometer. is_fresh = false is a dropout.
void hal_sim_accel_set(hal_accel_t *accel, int32_t counts, bool is_fresh);

/// Next measurement of the coil current.
void hal_sim_current_set(hal_current_t *driver, int32_t measured_mA, bool has_measurement);

#endif
