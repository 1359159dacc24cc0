#include "hal_sim.h"

bool hal_accel_read(hal_accel_t *accel, hal_axis_t axis, int32_t *counts) {
    const bool is_fresh = accel->is_fresh;
    accel->axis = axis;
    if (is_fresh) {
        *counts = accel->counts;
    }
    accel->is_fresh = false;
    return is_fresh;
}

void hal_current_write(hal_current_t *driver, int32_t current_mA, bool enable) {
    driver->command_mA = current_mA;
    driver->is_enabled = enable;
}

bool hal_current_read(hal_current_t *driver, int32_t *current_mA) {
    if (driver->has_measurement) {
        *current_mA = driver->measured_mA;
    }
    return driver->has_measurement;
}

void hal_sim_accel_set(hal_accel_t *accel, int32_t counts, bool is_fresh) {
    accel->counts = counts;
    accel->is_fresh = is_fresh;
}

void hal_sim_current_set(hal_current_t *driver, int32_t measured_mA, bool has_measurement) {
    driver->measured_mA = measured_mA;
    driver->has_measurement = has_measurement;
}
