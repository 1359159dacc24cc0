#include "app.h"

#include <stddef.h>

bool app_init(app_t *app, const quiesce_params_t *params, hal_accel_t *accel,
              hal_current_t *current) {
    *app = (app_t){.accel = accel, .current = current};
    const bool accepted = quiesce_init(&app->controller, params);
    app->axis = accepted ? (hal_axis_t)params->accel_axis : HAL_AXIS_Z;
    hal_current_write(current, quiesce_params_safe_current_mA(params), accepted);
    return accepted;
}

void app_tick(app_t *app, const app_operator_t *op, uint32_t ticks_elapsed) {
    app->tick += ticks_elapsed;
    quiesce_in_t *const in = &app->in;
    in->tick = app->tick;
    in->enable = op->enable;
    in->estop = op->estop;
    in->fault_reset = op->fault_reset;
    in->driver_has_failed = op->driver_has_failed;
    in->accel_is_fresh = hal_accel_read(app->accel, app->axis, &in->accel_counts);
    in->current_is_measured = hal_current_read(app->current, &in->current_meas_mA);
    quiesce_step(&app->controller, in, &app->out);
    hal_current_write(app->current, app->out.current_cmd_mA, app->out.driver_enable);
}
