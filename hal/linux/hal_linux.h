/// Handles of the Linux backends: hal_accel_t and hal_current_t call whichever backend the
/// configuration chose. A backend is one file that fills in one of these.
#ifndef HAL_LINUX_H
#define HAL_LINUX_H

#include "hal/accel.h"
#include "hal/current.h"

struct hal_accel {
    bool (*read)(void *backend, hal_axis_t axis, int32_t *counts);
    void *backend;
};

struct hal_current {
    void (*write)(void *backend, int32_t current_mA, bool enable);
    bool (*read)(void *backend, int32_t *current_mA); ///< NULL: there is no measurement
    void *backend;
};

#endif
