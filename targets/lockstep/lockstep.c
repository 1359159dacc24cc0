#include "lockstep.h"

#include <stddef.h>

static bool start(lockstep_t *server, const quiesce_board_t *board,
                  const quiesce_params_t *params) {
    return board == NULL ? quiesce_init(&server->controller, params)
                         : quiesce_init_board(&server->controller, board, params);
}

static quiesce_table_verdict_t use(lockstep_t *server, const lockstep_table_t *table) {
    if (table->count == 0) {
        return QUIESCE_TABLE_OK;
    }
    return table->count <= QUIESCE_TABLE_WORDS
               ? quiesce_table_use(&server->controller, table->words, table->count)
               : QUIESCE_TABLE_SIZE;
}

// One after the other, until one is refused.
static bool use_tables(lockstep_t *server, const lockstep_table_t *tables) {
    server->refused = (lockstep_refusal_t){QUIESCE_TABLE_OK, LOCKSTEP_LAW_TABLE};
    for (uint32_t i = 0; tables != NULL && i < LOCKSTEP_TABLES; i++) {
        const quiesce_table_verdict_t verdict = use(server, &tables[i]);
        if (verdict != QUIESCE_TABLE_OK) {
            server->refused = (lockstep_refusal_t){(uint32_t)verdict, i};
            return false;
        }
    }
    return true;
}

bool lockstep_start(lockstep_t *server, const quiesce_board_t *board,
                    const quiesce_params_t *params, const lockstep_table_t *tables) {
    server->in = (quiesce_in_t){0};
    const bool is_accepted = start(server, board, params);
    if (use_tables(server, is_accepted ? tables : NULL)) {
        return is_accepted;
    }
    quiesce_params_t refused = *params; // else what ships ran in the place of what was asked for
    refused.tick_rate_Hz = 0;
    (void)start(server, board, &refused);
    return false;
}

void lockstep_take(const lockstep_stimulus_t *stimulus, quiesce_sample_t sensor[QUIESCE_SENSORS],
                   quiesce_driver_t driver[QUIESCE_DAMPERS]) {
    for (uint32_t i = 0; i < QUIESCE_SENSORS; i++) {
        sensor[i].counts = stimulus->counts[i];
        sensor[i].is_fresh = (stimulus->flags & LOCKSTEP_FRESH << i) != 0;
    }
    for (uint32_t i = 0; i < QUIESCE_DAMPERS; i++) {
        driver[i].current_mA = stimulus->current_meas_mA[i];
        driver[i].is_measured = (stimulus->flags & LOCKSTEP_HAS_CURRENT << i) != 0;
    }
}

static void report(const quiesce_t *controller, bool is_wanted,
                   int32_t word[QUIESCE_REPORT_WORDS]) {
    if (is_wanted) {
        quiesce_report(controller, word);
        return;
    }
    for (uint32_t i = 0; i < QUIESCE_REPORT_WORDS; i++) {
        word[i] = 0;
    }
}

void lockstep_tell(const quiesce_t *controller, const quiesce_out_t *out, uint32_t flags,
                   lockstep_reply_t *reply) {
    reply->drivers_enabled = 0;
    for (uint32_t i = 0; i < QUIESCE_DAMPERS; i++) {
        reply->current_cmd_mA[i] = out->damper[i].current_cmd_mA;
        reply->drivers_enabled |= (out->damper[i].driver_enable ? 1u : 0u) << i;
    }
    reply->telemetry = out->telemetry;
    report(controller, (flags & LOCKSTEP_REPORT) != 0, reply->report);
    if ((flags & LOCKSTEP_PICTURE) != 0) {
        quiesce_picture(controller, &reply->picture);
    }
}

void lockstep_exchange(lockstep_t *server, const lockstep_stimulus_t *in, lockstep_reply_t *out) {
    server->in.tick++;
    if ((in->flags & LOCKSTEP_LOST) == 0) {
        lockstep_take(in, server->in.sensor, server->in.driver);
        server->in.enable = (in->flags & LOCKSTEP_ENABLE) != 0;
        server->in.estop = (in->flags & LOCKSTEP_ESTOP) != 0;
        server->in.fault_reset = (in->flags & LOCKSTEP_FAULT_RESET) != 0;
        quiesce_step(&server->controller, &server->in, &server->out);
    }
    lockstep_tell(&server->controller, &server->out, in->flags, out);
}
