/// Accelerometer: one sample of one axis a control tick.
///
/// A backend defines struct hal_accel; handles are distinct types, so that a wrong one does not
/// compile.
#ifndef HAL_ACCEL_H
#define HAL_ACCEL_H

#include <stdbool.h>
#include <stdint.h>

typedef struct hal_accel hal_accel_t;

/// A sensor of one axis answers on all of them.
typedef enum {
    HAL_AXIS_X = 0,
    HAL_AXIS_Y = 1,
    HAL_AXIS_Z = 2,
} hal_axis_t;

/// Latest sample along an axis. Call once a tick, from the tick.
/// counts: raw ADC counts, signed; written only where the function returns true.
/// Returns false iff no sample has arrived since the last call.
bool hal_accel_read(hal_accel_t *accel, hal_axis_t axis, int32_t *counts);

#endif
