// A law with its tables: in the whole controller, alone, or with its tables spoilt. The same words
// come out of every build; a CRC-32 of each block of ticks says so.
#include <stddef.h>

#include "law_order.h"
#include "law_trial.h"
#include "table.h"
#include "word_crc.h"

enum { REARM_TICKS = 2048, SPOILT_TICKS = 200 };

typedef struct {
    uint32_t crc;
    uint32_t block;
    uint32_t ticks;
} digest_t;

static void digest_words(digest_t *self, const void *data, uint32_t bytes) {
    const uint32_t *words = data;
    for (uint32_t i = 0; i < bytes / sizeof *words; i++) {
        self->crc = word_crc_append(self->crc, words[i]);
    }
}

// The name has room for 9999 blocks.
static void say_block(const digest_t *self, const law_door_t *door) {
    char name[] = "block0000";
    uint32_t number = self->block;
    for (uint32_t i = sizeof name - 2u; i > 4u; i--, number /= 10u) {
        name[i] = (char)('0' + number % 10u);
    }
    door->say(name, ~self->crc);
}

static void digest_tick(digest_t *self, const law_door_t *door, uint32_t block_ticks,
                        bool is_last) {
    if (++self->ticks == block_ticks || is_last) {
        say_block(self, door);
        *self = (digest_t){.crc = WORD_CRC_START, .block = self->block + 1u};
    }
}

// ---- the whole controller -----------------------------------------------------------------------

typedef struct {
    quiesce_t controller;
    quiesce_in_t in;
    quiesce_out_t out;
    uint32_t running_ticks;
    uint32_t moving_ticks; ///< with another request than in the last one
    uint32_t beyond_ticks; ///< a command below 0 or above its ceiling
    int32_t last_mA;
} whole_t;

static void step_whole(void *context) {
    whole_t *self = context;
    quiesce_step(&self->controller, &self->in, &self->out);
}

// Every now and then the output is disabled, a fault acknowledged, and armed anew.
static void next_in(quiesce_in_t *in, uint32_t tick, const int32_t *counts, uint32_t sensors) {
    *in = (quiesce_in_t){
        .tick = tick,
        .enable = tick % REARM_TICKS > 1,
        .fault_reset = tick % REARM_TICKS == 1,
    };
    for (uint32_t i = 0; i < sensors; i++) {
        in->sensor[i].is_fresh = counts[i] != LAW_ORDER_NO_SAMPLE;
        in->sensor[i].counts = in->sensor[i].is_fresh ? counts[i] : 0;
    }
}

static void take_note(whole_t *self, const quiesce_board_t *board) {
    const quiesce_telemetry_t *telemetry = &self->out.telemetry;
    const bool is_running =
        telemetry->state == QUIESCE_STATE_RUN || telemetry->state == QUIESCE_STATE_DEGRADED;
    bool is_beyond = false;
    for (uint32_t i = 0; i < (uint32_t)board->dampers; i++) {
        const int32_t current_mA = self->out.damper[i].current_cmd_mA;
        is_beyond = is_beyond || current_mA < 0 || current_mA > board->damper[i].ceiling_mA;
    }
    self->running_ticks += is_running ? 1u : 0u;
    self->moving_ticks += telemetry->current_law_mA != self->last_mA ? 1u : 0u;
    self->beyond_ticks += is_beyond ? 1u : 0u;
    self->last_mA = telemetry->current_law_mA;
}

static void digest_out(digest_t *digest, const quiesce_out_t *out) {
    digest_words(digest, &out->telemetry, sizeof out->telemetry);
    for (uint32_t i = 0; i < QUIESCE_DAMPERS; i++) {
        const uint32_t words[] = {(uint32_t)out->damper[i].current_cmd_mA,
                                  out->damper[i].driver_enable};
        digest_words(digest, words, sizeof words);
    }
}

static bool start_whole(whole_t *self, const law_order_t *order) {
    const uint32_t *table = law_order_table(order);
    const uint32_t *map = law_order_map(order);
    return quiesce_init_board(&self->controller, &order->board, &order->params) &&
           (table == NULL ||
            quiesce_table_use(&self->controller, table, order->law_words) == QUIESCE_TABLE_OK) &&
           (map == NULL ||
            quiesce_table_use(&self->controller, map, order->map_words) == QUIESCE_TABLE_OK) &&
           quiesce_lacks_table(&self->controller) == NULL;
}

static bool run_whole(const law_order_t *order, const law_door_t *door) {
    static whole_t whole;
    const uint32_t sensors = (uint32_t)order->board.sensors;
    digest_t digest = {.crc = WORD_CRC_START};
    if (!start_whole(&whole, order)) {
        return false;
    }
    for (uint32_t tick = 0; tick < order->ticks; tick++) {
        int32_t report[QUIESCE_REPORT_WORDS];
        next_in(&whole.in, tick, &law_order_counts(order)[(size_t)tick * sensors], sensors);
        door->count(step_whole, &whole);
        take_note(&whole, &order->board);
        quiesce_report(&whole.controller, report);
        digest_out(&digest, &whole.out);
        digest_words(&digest, report, sizeof report);
        digest_tick(&digest, door, order->block_ticks, tick + 1u == order->ticks);
    }
    door->say("words_a_tick", sizeof whole.out.telemetry / sizeof(uint32_t) + 2u * QUIESCE_DAMPERS +
                                  QUIESCE_REPORT_WORDS);
    door->say("running_ticks", whole.running_ticks);
    door->say("moving_ticks", whole.moving_ticks);
    door->say("beyond_ticks", whole.beyond_ticks);
    return true;
}

// ---- alone --------------------------------------------------------------------------------------

static void step_alone(void *context) {
    law_trial_step(context);
}

typedef struct {
    uint32_t ticks;
    uint32_t energised_ticks;
    uint32_t beyond_ticks;
    uint32_t demand_ticks;
    uint32_t current_ticks; ///< with a current of the first damper
    uint32_t state_bytes;
    uint32_t tables;
    uint32_t accepted;
} found_t;

static void note(found_t *self, law_trial_t *trial) {
    law_trial_guard(trial);
    const uint32_t breaks = law_trial_breaks(trial);
    const uint32_t bytes = law_trial_state_bytes(trial);
    self->ticks++;
    self->energised_ticks += (breaks & LAW_TRIAL_ENERGISED) != 0 ? 1u : 0u;
    self->beyond_ticks += (breaks & LAW_TRIAL_BEYOND) != 0 ? 1u : 0u;
    self->demand_ticks += trial->has_demand ? 1u : 0u;
    self->current_ticks += trial->current.value[0] > 0 ? 1u : 0u;
    self->state_bytes = bytes > self->state_bytes ? bytes : self->state_bytes;
}

static void say_found(const found_t *found, const law_door_t *door) {
    door->say("trial_ticks", found->ticks);
    door->say("energised_ticks", found->energised_ticks);
    door->say("beyond_ticks", found->beyond_ticks);
    door->say("demand_ticks", found->demand_ticks);
    door->say("current_ticks", found->current_ticks);
    door->say("state_bytes", found->state_bytes);
    door->say("tables", found->tables);
    door->say("accepted", found->accepted);
}

static bool run_alone(const law_order_t *order, const law_door_t *door) {
    static law_trial_t trial;
    digest_t digest = {.crc = WORD_CRC_START};
    found_t found = {0};
    if (!law_trial_start(&trial, &order->params, law_order_table(order), order->law_words,
                         law_order_map(order), order->map_words, order->seed)) {
        return false;
    }
    for (uint32_t tick = 0; tick < order->ticks; tick++) {
        law_trial_look(&trial);
        door->count(step_alone, &trial);
        note(&found, &trial);
        digest_words(&digest, &trial.demand, sizeof trial.demand);
        digest_words(&digest, &trial.current, sizeof trial.current);
        digest_tick(&digest, door, order->block_ticks, tick + 1u == order->ticks);
    }
    door->say("words_a_tick", 2u * QUIESCE_DAMPERS);
    say_found(&found, door);
    return true;
}

// ---- with tables spoilt -------------------------------------------------------------------------

typedef struct {
    uint32_t law[QUIESCE_TABLE_WORDS];
    uint32_t map[QUIESCE_TABLE_WORDS];
} spoilt_t;

static void copy(uint32_t *to, const uint32_t *from, uint32_t words) {
    for (uint32_t i = 0; from != NULL && i < words; i++) {
        to[i] = from[i];
    }
}

// The order's, or the one that ships; NULL: the law has none.
static const uint32_t *table_to_spoil(const law_order_t *order, uint32_t *count) {
    const table_kind_t *kind = law_find(order->params.law)->kind;
    const uint32_t *own = law_order_table(order);
    const uint32_t *table = own == NULL && kind != NULL ? kind->shipped : own;
    *count = table != NULL ? table[TABLE_WORDS] : 0;
    return *count <= QUIESCE_TABLE_WORDS ? table : NULL;
}

static bool run_spoilt(const law_order_t *order, const law_door_t *door) {
    static law_trial_t trial;
    static spoilt_t spoilt;
    uint32_t count;
    const uint32_t *table = table_to_spoil(order, &count);
    const uint32_t *map = law_order_map(order);
    found_t found = {0};
    uint32_t seed = order->seed;
    // A table that is refused takes the time of a tick.
    for (uint32_t left = order->ticks; left > 0; left--) {
        copy(spoilt.law, table, count);
        copy(spoilt.map, map, order->map_words);
        const bool is_map = map != NULL && (table == NULL || found.tables % 2u == 1u);
        if (is_map) {
            law_trial_spoil(spoilt.map, order->map_words, &seed);
        } else if (table != NULL) {
            law_trial_spoil(spoilt.law, count, &seed);
        }
        found.tables++;
        if (!law_trial_start(&trial, &order->params, table != NULL ? spoilt.law : NULL, count,
                             map != NULL ? spoilt.map : NULL, order->map_words, seed)) {
            continue;
        }
        found.accepted++;
        for (uint32_t i = 0; i < SPOILT_TICKS && left > 1u; i++, left--) {
            law_trial_look(&trial);
            law_trial_step(&trial);
            note(&found, &trial);
        }
    }
    say_found(&found, door);
    return true;
}

bool law_runs(const law_order_t *order, const law_door_t *door) {
    switch (order->mode) {
    case LAW_ORDER_WHOLE:
        return run_whole(order, door);
    case LAW_ORDER_ALONE:
        return run_alone(order, door);
    case LAW_ORDER_SPOIL:
        return run_spoilt(order, door);
    default:
        return false;
    }
}
