#include "law_phase.h"

#include <stddef.h>

#include "adapt_store.h"
#include "law_state.h"

enum { WHOLE_q16 = 65536 };

_Static_assert(QUIESCE_ADAPTATION_WORDS == ADAPT_STORE_WORDS, "what is learnt, in words");

static const phase_table_t *as_table(const uint32_t *words) {
    return (const phase_table_t *)(const void *)words;
}

// Unlocked, nothing learnt.
static void start(phase_state_t *self, const quiesce_params_t *p, const phase_table_t *table) {
    const uint32_t blend_ticks = ticks_in_ms(p->phase_blend_ms, p->tick_rate_Hz);
    const uint32_t setting = (uint32_t)p->phase_setting;
    *self = (phase_state_t){
        .table = table,
        .points = phase_table_points(table, setting),
        .point_count = table->points[setting],
        .is_stale = true,
        .blend_step_q16 = WHOLE_q16 / (blend_ticks + 1u) + 1u,
    };
    adapt_init(&self->adapt, &(adapt_cfg_t){
                                 .start_ticks = ticks_in_ms(p->adapt_start_ms, p->tick_rate_Hz),
                                 .settle_ticks = ticks_in_ms(p->adapt_settle_ms, p->tick_rate_Hz),
                                 .measure_ticks = ticks_in_ms(p->adapt_measure_ms, p->tick_rate_Hz),
                                 .rest_ticks = ticks_in_ms(p->adapt_rest_ms, p->tick_rate_Hz),
                                 .edge_limit_q16 = (int32_t)((int64_t)p->adapt_edge_limit_mdeg *
                                                             INT16_MAX / 90000),
                                 .level_limit_q15 = p->adapt_level_limit_pct * 32768 / 100,
                             });
}

static void trim_pulse(phase_pulse_t *pulse, const adapt_trim_t *trim) {
    const int32_t width_q16 =
        (int32_t)pulse->width_q16 + trim->value[ADAPT_OFF_EDGE] - trim->value[ADAPT_ON_EDGE];
    pulse->on_q16 = (uint32_t)((int32_t)pulse->on_q16 + trim->value[ADAPT_ON_EDGE]) & 0xFFFFu;
    pulse->width_q16 = trim->value[ADAPT_WHOLE] != 0
                           ? PHASE_WIDTH_ALL
                           : (uint32_t)clamp_i32(width_q16, 0, (int32_t)PHASE_WIDTH_ALL);
    const int32_t level_mA = pulse->level_mA + ((pulse->level_mA * trim->value[ADAPT_LEVEL]) >> 15);
    pulse->level_mA = level_mA > pulse->floor_mA ? level_mA : pulse->floor_mA;
}

// Frequency, pulse and trim of the half cycle that has begun.
static void refresh(phase_state_t *self, const quiesce_params_t *params, uint32_t step_turn) {
    const uint64_t per_tick = (uint64_t)step_turn * (uint32_t)params->tick_rate_Hz;
    self->freq_mHz = (uint32_t)((per_tick * 1000u) >> 32);
    self->place = phase_place(self->points, self->point_count, self->freq_mHz);
    self->pulse = phase_pulse_at(self->points, self->place);
    self->trim = (adapt_trim_t){{0}};
    if (params->adapt != QUIESCE_ADAPT_OFF) {
        self->trim = adapt_trim_at(&self->adapt, self->place.index, self->place.part_q16);
    }
    trim_pulse(&self->pulse, &self->trim);
    self->is_stale = false;
}

static void let_go(phase_state_t *self) {
    self->blend_q16 = 0;
    self->is_stale = true;
    adapt_pause(&self->adapt);
}

static int32_t blended(phase_state_t *self, int32_t from_mA, int32_t to_mA) {
    const uint32_t next_q16 = self->blend_q16 + self->blend_step_q16;
    self->blend_q16 = next_q16 < WHOLE_q16 ? next_q16 : WHOLE_q16;
    return from_mA + (int32_t)(((int64_t)(to_mA - from_mA) * self->blend_q16) >> 16);
}

static void adapt(phase_state_t *self, const quiesce_params_t *params, const law_in_t *in) {
    adapt_step(&self->adapt, &(adapt_in_t){
                                 .may_try = params->adapt == QUIESCE_ADAPT_ON && !self->is_frozen &&
                                            self->blend_q16 == WHOLE_q16,
                                 .freq_mHz = self->freq_mHz,
                                 .index = self->place.index,
                                 .part_q16 = self->place.part_q16,
                                 .goal = {self->pulse.accel_weight_q8, self->pulse.accel_shape_q14},
                                 .half = in->lock.half,
                             });
}

static int32_t step(law_state_t *state, const quiesce_params_t *params, const law_in_t *in) {
    phase_state_t *self = &state->phase;
    if (!in->lock.is_on || !in->is_output_on) {
        let_go(self);
        return params->unlock_current_mA;
    }
    if (self->is_stale) {
        refresh(self, params, in->lock.step_turn);
    }
    self->is_stale = in->lock.half != NULL;
    adapt(self, params, in);
    // What is requested now acts during the next tick. Half turns: the current repeats twice a
    // cycle.
    const uint32_t start_turn = (in->lock.phase_turn + in->lock.step_turn) << 1;
    const int32_t pulse_mA =
        phase_pulse_current_mA(&self->pulse, start_turn, in->lock.step_turn << 1);
    return blended(self, params->unlock_current_mA, pulse_mA);
}

static void init(law_state_t *state, const quiesce_params_t *params, const uint32_t *table) {
    start(&state->phase, params, as_table(table));
}

const law_t law_phase = {.name = "phase", .init = init, .step = step, .uses_lock = true};

phase_table_verdict_t law_phase_use(law_state_t *state, const quiesce_params_t *params,
                                    const uint32_t *words, uint32_t count) {
    const phase_table_verdict_t verdict = phase_table_check(words, count);
    if (verdict == PHASE_TABLE_OK) {
        const bool is_frozen = state->phase.is_frozen;
        start(&state->phase, params, as_table(words));
        state->phase.is_frozen = is_frozen;
    }
    return verdict;
}

static adapt_owner_t owner_of(const phase_state_t *self, const quiesce_params_t *params) {
    return (adapt_owner_t){self->table->crc, (uint32_t)params->phase_setting};
}

void law_phase_save(const law_state_t *state, const quiesce_params_t *params, uint32_t *words) {
    adapt_store(&state->phase.adapt, owner_of(&state->phase, params), words);
}

bool law_phase_load(law_state_t *state, const quiesce_params_t *params, const uint32_t *words) {
    return adapt_restore(&state->phase.adapt, owner_of(&state->phase, params), words);
}

void law_phase_reset(law_state_t *state) {
    adapt_clear(&state->phase.adapt);
}

void law_phase_freeze(law_state_t *state, bool is_frozen) {
    state->phase.is_frozen = is_frozen;
}

// Half turns Q16 in thousandths of a degree.
static int32_t half_turn_mdeg(int32_t half_turn_q16) {
    return half_turn_q16 * 5625 / 2048;
}

void law_phase_report(const law_state_t *state, quiesce_telemetry_t *t) {
    const adapt_t *self = &state->phase.adapt;
    const int16_t *trim = state->phase.trim.value;
    t->adapt_state = (uint32_t)self->state;
    t->adapt_trials = self->trials;
    t->adapt_gains = self->gains;
    t->trim_on_mdeg = half_turn_mdeg(trim[ADAPT_ON_EDGE]);
    t->trim_off_mdeg = half_turn_mdeg(trim[ADAPT_OFF_EDGE]);
    t->trim_level_q15 = 32768 + trim[ADAPT_LEVEL];
    t->trim_is_whole = trim[ADAPT_WHOLE] != 0 ? 1u : 0u;
}
