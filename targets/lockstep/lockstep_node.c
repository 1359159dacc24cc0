#include "lockstep_node.h"

#include <stddef.h>

// The same order as LOCKSTEP_LAW_TABLE, LOCKSTEP_TRACKER_TABLE.
static const keeper_record_t record_of[LOCKSTEP_TABLES] = {KEEPER_LAW_TABLE, KEEPER_TRACKER_TABLE};

static quiesce_table_verdict_t use(lockstep_node_t *self, uint32_t table,
                                   const lockstep_table_t *words) {
    if (words->count == 0) {
        return QUIESCE_TABLE_OK;
    }
    const table_found_t found = {.record = record_of[table],
                                 .source = TABLE_FROM_CONFIG,
                                 .words = words->words,
                                 .count = words->count};
    return node_found(&self->node, &found);
}

bool lockstep_node_start(lockstep_node_t *self, const quiesce_board_t *board,
                         const quiesce_params_t *params, const lockstep_table_t *tables) {
    static const node_sources_t sources = {.enable = NODE_ENABLE_BOARD, .sensors_on_bus = 0};
    self->missed = 0;
    self->refused = (lockstep_refusal_t){QUIESCE_TABLE_OK, LOCKSTEP_LAW_TABLE};
    const bool is_accepted = node_init(&self->node, board, params, sources);
    for (uint32_t i = 0; is_accepted && tables != NULL && i < LOCKSTEP_TABLES; i++) {
        const quiesce_table_verdict_t verdict = use(self, i, &tables[i]);
        if (verdict != QUIESCE_TABLE_OK) {
            self->refused = (lockstep_refusal_t){(uint32_t)verdict, i};
            return false;
        }
    }
    return is_accepted;
}

uint32_t lockstep_node_exchange(lockstep_node_t *self, const lockstep_stimulus_t *in,
                                const lockstep_pace_t *pace, lockstep_reply_t *out,
                                can_frame_t frames[NODE_MAX_FRAMES]) {
    uint32_t count = 0;
    if ((in->flags & LOCKSTEP_LOST) != 0) {
        self->missed++;
    } else {
        node_inputs_t inputs = {
            .enable = (in->flags & LOCKSTEP_ENABLE) != 0,
            .estop = (in->flags & LOCKSTEP_ESTOP) != 0,
            .fault_reset = (in->flags & LOCKSTEP_FAULT_RESET) != 0,
            .ticks_elapsed = self->missed + 1u,
            .overruns = pace->overruns,
            .lateness_us = pace->lateness_us,
            .work_us = pace->work_us,
            .unsent = pace->unsent,
            .rx_lost = pace->rx_lost,
        };
        lockstep_take(in, inputs.sensor, inputs.driver);
        count = node_tick(&self->node, &inputs, frames);
        self->missed = 0;
    }
    lockstep_tell(&self->node.controller, &self->node.out, in->flags, out);
    return count;
}
