#include "lockstep.h"

bool lockstep_start(lockstep_t *server, const quiesce_params_t *params) {
    server->in = (quiesce_in_t){0};
    return quiesce_init(&server->controller, params);
}

static void take(quiesce_in_t *in, const lockstep_stimulus_t *stimulus) {
    const uint32_t flags = stimulus->flags;
    in->tick++;
    in->sensor[0].counts = stimulus->accel_counts;
    in->driver[0].current_mA = stimulus->current_meas_mA;
    in->sensor[0].is_fresh = (flags & LOCKSTEP_FRESH) != 0;
    in->driver[0].is_measured = (flags & LOCKSTEP_HAS_CURRENT) != 0;
    in->enable = (flags & LOCKSTEP_ENABLE) != 0;
    in->estop = (flags & LOCKSTEP_ESTOP) != 0;
    in->fault_reset = (flags & LOCKSTEP_FAULT_RESET) != 0;
}

static void report(const lockstep_t *server, bool is_wanted, int32_t word[QUIESCE_REPORT_WORDS]) {
    if (is_wanted) {
        quiesce_report(&server->controller, word);
        return;
    }
    for (uint32_t i = 0; i < QUIESCE_REPORT_WORDS; i++) {
        word[i] = 0;
    }
}

void lockstep_exchange(lockstep_t *server, const lockstep_stimulus_t *in, lockstep_reply_t *out) {
    take(&server->in, in);
    quiesce_step(&server->controller, &server->in, &server->out);
    out->current_cmd_mA = server->out.damper[0].current_cmd_mA;
    out->is_driver_enabled = server->out.damper[0].driver_enable ? 1u : 0u;
    out->telemetry = server->out.telemetry;
    report(server, (in->flags & LOCKSTEP_REPORT) != 0, out->report);
}
