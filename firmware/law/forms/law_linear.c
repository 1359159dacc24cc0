// Forces from measurements through a linear system: state feedback with its observer, filters,
// skyhook and groundhook, a sliding surface within its boundary layer.
//
// Its table, after the head of all tables: ticks a second that it is made for, states n, inputs m,
// rows q; m inputs (view_signal.h); n
// states (state_space.h); q rows {damper, shift, limit in mN, n + m coefficients}. A row is limited
// by itself; a damper's demand is the sum of its rows. `quiesce law make` writes them.
#include <stddef.h>

#include "fixq.h"
#include "law.h"
#include "state_space.h"
#include "table.h"
#include "view_signal.h"

#define LINEAR_MAGIC UINT32_C(0x314E4C51)

enum { HEADER_WORDS = 7, MOST_ROWS = 8, ROW_WORDS = 3, MOST_SHIFT = 62 };

typedef struct {
    uint32_t head[TABLE_HEAD_WORDS];
    uint32_t rate_Hz;
    uint32_t states;
    uint32_t inputs;
    uint32_t rows;
    view_input_t input[];
} linear_table_t;

_Static_assert(offsetof(linear_table_t, input) == 4u * HEADER_WORDS, "words on the wire");

typedef struct {
    uint32_t damper;
    uint32_t shift;
    int32_t limit_mN;
    int32_t coefficient[];
} linear_row_t;

typedef struct {
    state_space_t system;
    uint32_t overflows; ///< since it was set up
} linear_t;

_Static_assert(sizeof(linear_t) <= LAW_FORCE_STATE_BYTES, "the arena is too small");

static const linear_table_t *as_table(const uint32_t *words) {
    return (const linear_table_t *)(const void *)words;
}

static const int32_t *states_of(const linear_table_t *table) {
    return (const int32_t *)(const void *)&table->input[table->inputs];
}

static const linear_row_t *row_of(const linear_table_t *table, uint32_t i) {
    const uint32_t words = ROW_WORDS + table->states + table->inputs;
    return (const linear_row_t *)(const void *)(states_of(table) +
                                                state_space_words(table->states, table->inputs) +
                                                i * words);
}

static bool has_shape(const linear_table_t *table) {
    const uint32_t n = table->states;
    const uint32_t m = table->inputs;
    const uint32_t q = table->rows;
    return n <= STATE_SPACE_MAX_STATES && m >= 1u && m <= STATE_SPACE_MAX_INPUTS && q >= 1u &&
           q <= MOST_ROWS &&
           table->head[TABLE_WORDS] == HEADER_WORDS + VIEW_INPUT_WORDS * m +
                                           state_space_words(n, m) + q * (ROW_WORDS + n + m);
}

static bool is_row_good(const linear_row_t *row, uint32_t coefficients) {
    return row->damper < QUIESCE_MAX_DAMPERS && row->shift <= MOST_SHIFT && row->limit_mN > 0 &&
           row->limit_mN <= VIEW_LIMIT &&
           state_space_are_coefficients_good(row->coefficient, coefficients);
}

static bool are_points_good(const linear_table_t *table) {
    const uint32_t n = table->states;
    const uint32_t m = table->inputs;
    bool are_good = view_inputs_are_good(table->input, m) &&
                    state_space_are_states_good(states_of(table), n, m);
    for (uint32_t i = 0; i < table->rows; i++) {
        are_good = are_good && is_row_good(row_of(table, i), n + m);
    }
    return are_good;
}

static quiesce_table_verdict_t check(const uint32_t *words) {
    const linear_table_t *table = as_table(words);
    if (!has_shape(table)) {
        return QUIESCE_TABLE_SHAPE;
    }
    return are_points_good(table) ? QUIESCE_TABLE_OK : QUIESCE_TABLE_POINT;
}

static uint64_t needs(const uint32_t *words) {
    const linear_table_t *table = as_table(words);
    uint64_t bits = view_inputs_need(table->input, table->inputs);
    for (uint32_t i = 0; i < table->rows; i++) {
        bits |= view_needs_damper(row_of(table, i)->damper);
    }
    return bits;
}

static uint32_t rate_Hz(const uint32_t *words) {
    return as_table(words)->rate_Hz;
}

// To the nearest mN.
static int32_t force_mN(const linear_row_t *row, const linear_table_t *table,
                        const state_space_t *system, const int32_t *u) {
    const int64_t sum =
        state_space_output(system, row->coefficient, table->states, table->inputs, u);
    const int64_t half = row->shift == 0 ? 0 : INT64_C(1) << (row->shift - 1u);
    return (int32_t)clamp_i64((sum + half) >> row->shift, -(int64_t)row->limit_mN, row->limit_mN);
}

static bool step(void *state, const law_setup_t *setup, const view_t *view, law_demand_t *out) {
    linear_t *self = state;
    const linear_table_t *table = as_table(setup->table);
    int32_t u[VIEW_INPUTS_MAX];
    view_inputs_read(table->input, table->inputs, view, u);
    law_demand_all(out, 0);
    for (uint32_t i = 0; i < table->rows; i++) {
        const linear_row_t *row = row_of(table, i);
        int32_t *demand_mN = &out->value[row->damper];
        // Below 2^31: each of the two is below 2^30.
        *demand_mN =
            clamp_i32(*demand_mN + force_mN(row, table, &self->system, u), -VIEW_LIMIT, VIEW_LIMIT);
    }
    const bool is_inside =
        state_space_step(&self->system, states_of(table), table->states, table->inputs, u);
    self->overflows += is_inside ? 0u : 1u;
    return is_inside;
}

static const quiesce_word_t reports[QUIESCE_REPORT_WORDS] = {
    {"overflows", "-"},
    {"largest_state", "2^-10 of its range"},
};

static void report(const void *state, const law_setup_t *setup, int32_t word[]) {
    const linear_t *self = state;
    int32_t largest = 0;
    for (uint32_t i = 0; i < STATE_SPACE_MAX_STATES; i++) {
        const int32_t size = abs_i32(self->system.x[i]);
        largest = size > largest ? size : largest;
    }
    (void)setup;
    word[0] = (int32_t)(self->overflows & INT32_MAX);
    word[1] = largest >> 20;
}

static const table_kind_t system = {
    .name = "linear",
    .magic = LINEAR_MAGIC,
    .least_words = HEADER_WORDS,
    .check = check,
    .needs = needs,
    .rate_Hz = rate_Hz,
};

extern const law_t law_linear;
const law_t law_linear = {
    .name = "linear",
    .kind = &system,
    .demands = LAW_DEMANDS_FORCE,
    .reports = reports,
    .step = step,
    .report = report,
};
