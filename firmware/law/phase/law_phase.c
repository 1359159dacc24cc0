// The phase law: a pulse of current at the right phase of every half cycle, from a table over
// frequency, trimmed on line to the plant at hand.
//
// Below resonance the damper holds on until just after the peak and lets go: it works like a
// spring that gives nothing back. Above resonance it lets go on the way out: like a mass. The
// table knows where (docs/explanation/phase-law.md).
//
// While nothing is locked on to, the request is unlock_current_mA; in setting balanced it is
// narrow_current_mA where the motion is a narrow band in which current costs acceleration. From
// there the pulses are faded in over phase_blend_ms, so that the vibration changes slowly enough to
// be followed.
#include "law.h"

#include <stddef.h>

#include "adapt_store.h"
#include "at_start.h"
#include "phase_state.h"
#include "plant_pulses.h"

enum { WHOLE_q16 = 65536, NO_FLOOR_pct = -100 };

_Static_assert(sizeof(phase_t) <= LAW_STATE_BYTES, "the arena is too small");
_Static_assert(ADAPT_STORE_WORDS <= QUIESCE_LEARNT_MAX_WORDS, "what is learnt, in words");

static const phase_table_t *table_of(const law_setup_t *setup) {
    return (const phase_table_t *)(const void *)setup->table;
}

static const table_kind_t pulses = {
    .name = "pulses",
    .magic = PHASE_TABLE_MAGIC,
    .least_words = PHASE_TABLE_HEADER_WORDS,
    .shipped = plant_pulses_table,
    .check = phase_table_check,
};

static const quiesce_word_t reports[QUIESCE_REPORT_WORDS] = {
    {"adapt_state", "adapt_state_t"}, {"adapt_trials", "-"},     {"adapt_gains", "-"},
    {"trim_on_mdeg", "mdeg"},         {"trim_off_mdeg", "mdeg"}, {"trim_level_q15", "Q15"},
    {"trim_is_whole", "-"},
};

// Unlocked, nothing learnt.
AT_START static void init(void *state, const law_setup_t *setup) {
    phase_t *self = state;
    const quiesce_params_t *p = &setup->params;
    const phase_table_t *table = table_of(setup);
    const uint32_t setting = (uint32_t)p->phase_setting;
    const uint32_t blend_ticks = ticks_in_ms(p->phase_blend_ms, p->tick_rate_Hz);
    *self = (phase_t){
        .first_point = (uint16_t)(phase_table_points(table, setting) - table->point),
        .point_count = table->points[setting],
        .is_stale = true,
        .blend_step_q16 = WHOLE_q16 / (blend_ticks + 1u) + 1u,
    };
    adapt_init(
        &self->adapt,
        &(adapt_cfg_t){
            .start_ticks = ticks_in_ms(p->adapt_start_ms, p->tick_rate_Hz),
            .settle_ticks = ticks_in_ms(p->adapt_settle_ms, p->tick_rate_Hz),
            .measure_ticks = ticks_in_ms(p->adapt_measure_ms, p->tick_rate_Hz),
            .rest_ticks = ticks_in_ms(p->adapt_rest_ms, p->tick_rate_Hz),
            .edge_limit_q16 = (int16_t)((int64_t)p->adapt_edge_limit_mdeg * INT16_MAX / 90000),
            .level_limit_q15 = (int16_t)(p->adapt_level_limit_pct * 32768 / 100),
        });
}

static void trim_pulse(phase_pulse_t *pulse, const adapt_trim_t *trim) {
    const int32_t width_q16 =
        (int32_t)pulse->width_q16 + trim->value[ADAPT_OFF_EDGE] - trim->value[ADAPT_ON_EDGE];
    if (trim->value[ADAPT_LEVEL] == ADAPT_NO_CURRENT) {
        pulse->level_mA = 0;
        pulse->floor_mA = 0;
        return;
    }
    pulse->on_q16 = (uint16_t)(pulse->on_q16 + trim->value[ADAPT_ON_EDGE]);
    pulse->width_q16 = trim->value[ADAPT_WHOLE] != 0
                           ? PHASE_WIDTH_ALL
                           : (uint32_t)clamp_i32(width_q16, 0, (int32_t)PHASE_WIDTH_ALL);
    const int32_t level_mA = pulse->level_mA + ((pulse->level_mA * trim->value[ADAPT_LEVEL]) >> 15);
    pulse->level_mA = level_mA > pulse->floor_mA ? level_mA : pulse->floor_mA;
}

// Setting displacement may spend acceleration down to the floor; balanced has a table's weights.
static uint16_t accel_limit_pct(const quiesce_params_t *params) {
    const int32_t floor_pct = params->phase_accel_floor_pct;
    const bool has_floor =
        params->phase_setting == QUIESCE_PHASE_SETTING_DISPLACEMENT && floor_pct > NO_FLOOR_pct;
    return has_floor ? (uint16_t)(100 - floor_pct) : 0;
}

// Frequency, pulse and trim of the half cycle that has begun.
static void refresh(phase_t *self, const law_setup_t *setup, uint32_t step_turn) {
    const quiesce_params_t *params = &setup->params;
    const phase_point_t *points = &table_of(setup)->point[self->first_point];
    const uint64_t per_tick = (uint64_t)step_turn * (uint32_t)params->tick_rate_Hz;
    self->freq_mHz = (uint32_t)((per_tick * 1000u) >> 32);
    self->place = phase_place(points, self->point_count, self->freq_mHz, self->place.index);
    self->pulse = phase_pulse_at(points, self->place);
    self->trim = (adapt_trim_t){{0}};
    if (params->adapt != QUIESCE_ADAPT_OFF) {
        self->trim = adapt_trim_at(&self->adapt, self->place.index, self->place.part_q16);
    }
    trim_pulse(&self->pulse, &self->trim);
    adapt_aim(&self->adapt, &(adapt_aim_t){self->place.index,
                                           self->place.part_q16,
                                           {self->pulse.accel_weight_q8,
                                            self->pulse.accel_shape_q14, accel_limit_pct(params)}});
    self->is_stale = false;
}

// While the output is off the pulses fade as they were faded in: after a tick or two of the safe
// current they go on.
static void let_go(phase_t *self, bool is_locked) {
    const uint32_t step_q16 = self->blend_step_q16;
    self->blend_q16 = is_locked && self->blend_q16 > step_q16 ? self->blend_q16 - step_q16 : 0;
    self->is_stale = true;
    adapt_pause(&self->adapt, !is_locked);
}

static int32_t blended(phase_t *self, int32_t from_mA, int32_t to_mA) {
    const uint32_t next_q16 = self->blend_q16 + self->blend_step_q16;
    self->blend_q16 = next_q16 < WHOLE_q16 ? next_q16 : WHOLE_q16;
    return from_mA + (int32_t)(((int64_t)(to_mA - from_mA) * self->blend_q16) >> 16);
}

static void adapt(phase_t *self, const quiesce_params_t *params, const view_t *view) {
    adapt_step(&self->adapt, &(adapt_in_t){
                                 .may_try = params->adapt == QUIESCE_ADAPT_ON && view->may_learn &&
                                            self->blend_q16 == WHOLE_q16,
                                 .freq_mHz = self->freq_mHz,
                                 .half = view->tone.half,
                             });
}

// Where it is displacement that counts, the constant current that is best for it is so in any band.
static int32_t unlocked_mA(const quiesce_params_t *params, const view_t *view) {
    const bool is_narrow = view->tone.is_narrow && !view->is_at_rest &&
                           params->phase_setting == QUIESCE_PHASE_SETTING_BALANCED;
    return is_narrow ? params->narrow_current_mA : law_unlock_mA(params, view);
}

static int32_t request_mA(phase_t *self, const law_setup_t *setup, const view_t *view) {
    const quiesce_params_t *params = &setup->params;
    const view_tone_t *tone = &view->tone;
    if ((view->valid & VIEW_LOCK) == 0 || !view->is_output_on) {
        let_go(self, (view->valid & VIEW_LOCK) != 0);
        return unlocked_mA(params, view);
    }
    if (self->is_stale) {
        refresh(self, setup, tone->step_turn);
    }
    self->is_stale = tone->half != NULL;
    adapt(self, params, view);
    // What is requested now acts during the next tick. Half turns: the current repeats twice a
    // cycle.
    const uint32_t start_turn = (tone->phase_turn + tone->step_turn) << 1;
    const int32_t pulse_mA = phase_pulse_current_mA(&self->pulse, start_turn, tone->step_turn << 1);
    return blended(self, unlocked_mA(params, view), pulse_mA);
}

static bool step(void *state, const law_setup_t *setup, const view_t *view, law_demand_t *out) {
    law_demand_all(out, request_mA(state, setup, view));
    return true;
}

static adapt_owner_t owner_of(const law_setup_t *setup) {
    return (adapt_owner_t){table_of(setup)->crc, (uint32_t)setup->params.phase_setting};
}

static uint32_t save(const void *state, const law_setup_t *setup, uint32_t *words) {
    adapt_store(&((const phase_t *)state)->adapt, owner_of(setup), words);
    return ADAPT_STORE_WORDS;
}

static bool load(void *state, const law_setup_t *setup, const uint32_t *words, uint32_t count) {
    phase_t *self = state;
    self->is_stale = true;
    if (count == 0) {
        adapt_clear(&self->adapt);
        return true;
    }
    return count == ADAPT_STORE_WORDS && adapt_restore(&self->adapt, owner_of(setup), words);
}

// Half turns Q16 in thousandths of a degree.
static int32_t half_turn_mdeg(int32_t half_turn_q16) {
    return half_turn_q16 * 5625 / 2048;
}

static void report(const void *state, const law_setup_t *setup, int32_t *word) {
    (void)setup;
    const phase_t *self = state;
    const int16_t *trim = self->trim.value;
    word[0] = (int32_t)self->adapt.state;
    word[1] = (int32_t)self->adapt.trials;
    word[2] = (int32_t)self->adapt.gains;
    word[3] = half_turn_mdeg(trim[ADAPT_ON_EDGE]);
    word[4] = half_turn_mdeg(trim[ADAPT_OFF_EDGE]);
    word[5] = 32768 + trim[ADAPT_LEVEL];
    word[6] = trim[ADAPT_WHOLE] != 0 ? 1 : 0;
}

extern const law_t law_phase;
const law_t law_phase = {
    .name = "phase",
    .needs = VIEW_RMS,
    .kind = &pulses,
    .lock = &dominant_lock,
    .reports = reports,
    .init = init,
    .step = step,
    .report = report,
    .save = save,
    .load = load,
};
