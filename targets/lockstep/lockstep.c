#include "lockstep.h"

bool lockstep_start(lockstep_t *server, const quiesce_params_t *params) {
    server->accel = (hal_accel_t){0};
    server->current = (hal_current_t){0};
    return app_init(&server->app, params, &server->accel, &server->current);
}

void lockstep_exchange(lockstep_t *server, const lockstep_stimulus_t *in, lockstep_reply_t *out) {
    const app_operator_t op = {
        .enable = (in->flags & LOCKSTEP_ENABLE) != 0,
        .estop = (in->flags & LOCKSTEP_ESTOP) != 0,
        .fault_reset = (in->flags & LOCKSTEP_FAULT_RESET) != 0,
    };
    hal_sim_accel_set(&server->accel, in->accel_counts, (in->flags & LOCKSTEP_FRESH) != 0);
    hal_sim_current_set(&server->current, in->current_meas_mA,
                        (in->flags & LOCKSTEP_HAS_CURRENT) != 0);
    app_tick(&server->app, &op, 1);
    out->current_cmd_mA = server->current.command_mA;
    out->is_driver_enabled = server->current.is_enabled ? 1u : 0u;
    out->telemetry = server->app.out.telemetry;
}
