/// What a target runs: the controller between its accelerometer and its current driver.
#ifndef APP_H
#define APP_H

#include "hal/accel.h"
#include "hal/current.h"
#include "quiesce.h"

/// What the operator and the board's inputs ask for, read once a tick.
typedef struct {
    bool enable;
    bool estop;
    bool fault_reset;
    bool driver_has_failed; ///< no wish, but it comes the same way
} app_operator_t;

typedef struct {
    quiesce_t controller;
    quiesce_in_t in;   ///< of the last tick; accel_counts and current_meas_mA: the last ones read
    quiesce_out_t out; ///< of the last tick: command and telemetry
    hal_accel_t *accel;
    hal_current_t *current;
    hal_axis_t axis;
    uint32_t tick;
} app_t;

/// Starts from rest, the safe current written to the driver.
/// Returns false iff a parameter is refused (the controller then stays in its latched fault state).
bool app_init(app_t *app, const quiesce_params_t *params, hal_accel_t *accel,
              hal_current_t *current);

/// One control tick: sample, step, command. ticks_elapsed: from the tick source, normally 1; more
/// means that ticks were lost.
void app_tick(app_t *app, const app_operator_t *op, uint32_t ticks_elapsed);

#endif
