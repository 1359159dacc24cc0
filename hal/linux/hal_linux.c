#include "hal_linux.h"

#include <stddef.h>

bool hal_accel_read(hal_accel_t *accel, hal_axis_t axis, int32_t *counts) {
    return accel->read(accel->backend, axis, counts);
}

void hal_current_write(hal_current_t *driver, int32_t current_mA, bool enable) {
    driver->write(driver->backend, current_mA, enable);
}

bool hal_current_read(hal_current_t *driver, int32_t *current_mA) {
    return driver->read != NULL && driver->read(driver->backend, current_mA);
}
