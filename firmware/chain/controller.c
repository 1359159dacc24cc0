// The one file that knows the order of the chain; signal_chain.c wires its sensing half.
#include "quiesce.h"

#include <stddef.h>

#include "current_monitor.h"
#include "fuzzy.h"
#include "guard.h"
#include "law_phase.h"
#include "law_state.h"
#include "plant_pulses.h"
#include "plant_rules.h"
#include "signal_chain.h"
#include "supervisor.h"

// Frequency in uHz, RMS acceleration in um/s2; one output, mA.
#define RULE_INPUTS 2u
#define RULE_UNITS 1u
// Whatever a loaded table says, a request stays a current that arithmetic can hold.
#define RULES_MAX_mA 1000000

// The rule base in use, and what it said last: its inputs change every few ticks only.
typedef struct {
    const fuzzy_table_t *table;
    int32_t input[RULE_INPUTS];
    int32_t current_mA;
    uint32_t fired;
} rules_t;

// Lives in the caller's opaque words; the library is built with -fno-strict-aliasing for that.
typedef struct {
    quiesce_params_t params;
    signal_chain_t signal;
    rules_t rules;
    const fuzzy_table_t *rules_next; ///< from the next tick on
    const law_t *law;
    law_state_t law_state;
    uint32_t hold_ticks; ///< that laws go on with a frequency that is no longer valid
    supervisor_t supervisor;
    current_monitor_t monitor;
    guard_t guard;
    int32_t last_command_mA;
    uint32_t last_tick;
    uint32_t bad_sample_count;
    bool has_ticked;
} controller_t;

_Static_assert(sizeof(controller_t) <= QUIESCE_STATE_BYTES, "QUIESCE_STATE_BYTES is too small");
_Static_assert(sizeof(quiesce_telemetry_t) % sizeof(uint32_t) == 0, "telemetry is words only");
_Static_assert(QUIESCE_PEAKS == ESTIMATOR_TONES, "telemetry holds the estimator's components");

static const fuzzy_table_t *shipped_rules(void) {
    return (const fuzzy_table_t *)(const void *)plant_rules_table;
}

static void init_output(controller_t *self, const quiesce_params_t *p, bool is_accepted) {
    const uint32_t rate_Hz = is_accepted ? (uint32_t)p->tick_rate_Hz : 1000u;
    guard_init(&self->guard, &(guard_cfg_t){
                                 .max_mA = p->max_current_mA,
                                 .safe_mA = quiesce_params_safe_current_mA(p),
                                 .slew_mA_s = p->slew_mA_s,
                                 .tick_rate_Hz = rate_Hz,
                             });
    self->last_command_mA = self->guard.cfg.safe_mA;
    const current_monitor_cfg_t monitor = {
        .is_on = is_accepted && p->current_check == QUIESCE_CURRENT_CHECK_ON,
        .tick_rate_Hz = rate_Hz,
        .error_mA = p->current_error_mA,
        .lag_ms = is_accepted ? p->current_lag_ms : 0,
        .fault_ticks = (uint32_t)p->current_fault_ticks,
    };
    current_monitor_init(&self->monitor, &monitor, self->last_command_mA);
    supervisor_init(&self->supervisor, is_accepted ? QUIESCE_FAULT_NONE : QUIESCE_FAULT_PARAMETER);
}

bool quiesce_init(quiesce_t *self, const quiesce_params_t *params) {
    controller_t *c = (controller_t *)(void *)self->opaque;
    const bool is_accepted = quiesce_params_check(params, NULL);
    *c = (controller_t){.params = *params};
    if (!is_accepted) {
        // The chain still runs, on defaults; the supervisor lets nothing of it out.
        quiesce_params_default(&c->params);
    }
    signal_chain_init(&c->signal, &c->params);
    c->rules_next = shipped_rules();
    c->law = law_find(c->params.law);
    law_state_init(&c->law_state, &c->params, plant_pulses_table);
    c->hold_ticks = ticks_in_ms(c->params.track_hold_ms, c->params.tick_rate_Hz);
    init_output(c, params, is_accepted);
    return is_accepted;
}

static quiesce_fault_t sensor_fault(const condition_out_t *sample) {
    static const uint8_t fault_of[] = {
        [CONDITION_GOOD] = QUIESCE_FAULT_NONE,
        [CONDITION_LOST] = QUIESCE_FAULT_SENSOR_LOST,
        [CONDITION_SATURATED] = QUIESCE_FAULT_SENSOR_SATURATED,
        [CONDITION_STUCK] = QUIESCE_FAULT_SENSOR_STUCK,
        [CONDITION_RANGE] = QUIESCE_FAULT_SENSOR_RANGE,
        [CONDITION_QUIET] = QUIESCE_FAULT_SENSOR_QUIET,
    };
    return sample->is_fault ? (quiesce_fault_t)fault_of[sample->flag] : QUIESCE_FAULT_NONE;
}

static quiesce_fault_t latched_fault(const quiesce_in_t *in, current_verdict_t verdict) {
    static const uint8_t fault_of[] = {
        [CURRENT_OK] = QUIESCE_FAULT_NONE,
        [CURRENT_NOT_FOLLOWING] = QUIESCE_FAULT_DRIVER_NOT_FOLLOWING,
        [CURRENT_OPEN_COIL] = QUIESCE_FAULT_COIL_OPEN,
        [CURRENT_MISSING] = QUIESCE_FAULT_CURRENT_LOST,
    };
    if (in->estop) {
        return QUIESCE_FAULT_ESTOP;
    }
    return in->driver_has_failed ? QUIESCE_FAULT_DRIVER_FAILED : (quiesce_fault_t)fault_of[verdict];
}

static bool is_tick_lost(controller_t *self, uint32_t tick) {
    const bool is_lost = self->has_ticked && tick != self->last_tick + 1u;
    self->has_ticked = true;
    self->last_tick = tick;
    return is_lost;
}

// The shipped rules run as straight-line C, the same numbers in half the time.
static int32_t rules_current_mA(const fuzzy_table_t *rules, const int32_t input[RULE_INPUTS]) {
    int32_t current_mA = 0;
    (void)(rules == shipped_rules() ? plant_rules(input, &current_mA)
                                    : fuzzy_evaluate(rules, input, &current_mA));
    return clamp_i32(current_mA, 0, RULES_MAX_mA);
}

static uint32_t rules_fired(const fuzzy_table_t *rules, const int32_t input[RULE_INPUTS]) {
    uint64_t fired = 0;
    (void)fuzzy_fired(rules, input, &fired);
    return (uint32_t)fired;
}

static void rules_step(rules_t *self, const fuzzy_table_t *table, int32_t freq_uHz,
                       int32_t rms_um_s2) {
    if (self->table == table && self->input[0] == freq_uHz && self->input[1] == rms_um_s2) {
        return;
    }
    self->table = table;
    self->input[0] = freq_uHz;
    self->input[1] = rms_um_s2;
    self->current_mA = rules_current_mA(table, self->input);
    self->fired = rules_fired(table, self->input);
}

static void supervise(controller_t *self, const quiesce_in_t *in, const condition_out_t *sample,
                      bool has_gap) {
    const current_verdict_t verdict = current_monitor_step(
        &self->monitor, self->last_command_mA, in->current_meas_mA, in->current_is_measured);
    const quiesce_fault_t lost = has_gap ? QUIESCE_FAULT_TICK_LOST : QUIESCE_FAULT_NONE;
    const quiesce_fault_t sensor = sensor_fault(sample);
    const supervisor_in_t events = {
        .clearing_fault = sensor != QUIESCE_FAULT_NONE ? sensor : lost,
        .latched_fault = latched_fault(in, verdict),
        .is_ready = sample->good_ticks >= (uint32_t)self->params.sensor_recover_ticks,
        .enable = in->enable,
        .fault_reset = in->fault_reset,
    };
    if (supervisor_step(&self->supervisor, &events)) {
        current_monitor_reset(&self->monitor);
    }
}

static law_in_t law_input(const controller_t *self, const signal_chain_out_t *signal,
                          int32_t fuzzy_mA) {
    // A short doubt must not make the command jump: that would itself change the vibration.
    const bool is_known = self->signal.estimator.age_ticks <= self->hold_ticks;
    const lock_in_t *lock = &self->signal.lock;
    return (law_in_t){
        .velocity_um_s_q32 = signal->velocity_um_s_q32,
        .accel_um_s2 = signal->sample.accel_um_s2,
        .freq_uHz = self->signal.estimator.tone[0].freq_uHz,
        .freq_is_valid = is_known,
        .base_mA = is_known ? fuzzy_mA : self->params.unlock_current_mA,
        .lock =
            {
                .is_on = lock->is_locked,
                .phase_turn = lock->phase_turn,
                .step_turn = lock->step_turn,
                .half = lock->has_half ? &lock->last : NULL,
            },
        .is_output_on = supervisor_allows_output(&self->supervisor),
    };
}

// Turns Q32 in thousandths of a degree, -180000 .. 179999.
static int32_t phase_mdeg(uint32_t turn) {
    return (int32_t)(((int64_t)(int32_t)turn * 360000) >> 32);
}

static void report_components(const signal_chain_t *signal, quiesce_telemetry_t *t) {
    const estimator_t *estimator = &signal->estimator;
    const bool is_valid = estimator_is_valid(estimator);
    t->freq_is_valid = is_valid ? 1u : 0u;
    t->freq_age_ticks = estimator->age_ticks;
    t->freq_uHz = estimator->tone[0].freq_uHz;
    t->freq_amp_um_s2 = estimator->tone[0].amp_um_s2;
    t->freq_phase_mdeg = phase_mdeg(estimator_phase_turn(estimator, 0));
    t->freq_sigma_uHz = estimator->sigma_uHz;
    t->freq_window_ms = estimator->window_ms;
    t->displacement_amp_nm = signal->displacement.half_peak_to_peak_nm;
    t->velocity_rms_um_s = estimator->velocity.rms_um_s;
    for (uint32_t i = 0; i < QUIESCE_PEAKS; i++) {
        const estimator_tone_t *tone = &estimator->tone[i];
        t->peaks[i] = estimator->predictor.is_armed && tone->freq_uHz != 0
                          ? (quiesce_peak_t){tone->freq_uHz, tone->amp_um_s2,
                                             phase_mdeg(estimator_phase_turn(estimator, i))}
                          : (quiesce_peak_t){0};
    }
}

static void report(const controller_t *self, quiesce_telemetry_t *t) {
    t->state = (uint32_t)self->supervisor.state;
    t->fault = (uint32_t)self->supervisor.fault;
    t->fault_count = self->supervisor.fault_count;
    t->bad_sample_count = self->bad_sample_count;
    report_components(&self->signal, t);
    t->lock_is_on = self->signal.lock.is_locked ? 1u : 0u;
    law_phase_report(&self->law_state, t);
}

void quiesce_step(quiesce_t *self, const quiesce_in_t *in, quiesce_out_t *out) {
    controller_t *c = (controller_t *)(void *)self->opaque;
    quiesce_telemetry_t *t = &out->telemetry;

    const signal_chain_in_t signal_in = {
        .accel_counts = in->accel_counts,
        .is_fresh = in->accel_is_fresh,
        .has_gap = is_tick_lost(c, in->tick),
        .wants_lock = c->law->uses_lock,
    };
    signal_chain_out_t signal;
    signal_chain_step(&c->signal, &signal_in, &signal);
    if (signal.sample.flag != CONDITION_GOOD) {
        c->bad_sample_count = increment_sat_u32(c->bad_sample_count);
    }

    if (c->law->uses_rules) {
        rules_step(&c->rules, c->rules_next, c->signal.estimator.tone[0].freq_uHz,
                   signal.rms_um_s2);
    }
    const law_in_t law_in = law_input(c, &signal, c->rules.current_mA);
    const int32_t request_mA = c->law->step(&c->law_state, &c->params, &law_in);

    supervise(c, in, &signal.sample, signal_in.has_gap);
    out->current_cmd_mA =
        guard_step(&c->guard, request_mA, supervisor_allows_output(&c->supervisor));
    out->driver_enable = supervisor_allows_driver(&c->supervisor);
    // A driver that is switched off is expected to carry nothing.
    c->last_command_mA = out->driver_enable ? out->current_cmd_mA : 0;

    report(c, t);
    t->tick = in->tick;
    t->accel_um_s2 = signal.sample.accel_um_s2;
    t->displacement_nm = signal.displacement_nm;
    t->velocity_um_s = motion_velocity_um_s(signal.velocity_um_s_q32);
    t->rms_um_s2 = signal.rms_um_s2;
    t->rules_fired = c->rules.fired;
    t->current_fuzzy_mA = c->rules.current_mA;
    t->current_law_mA = request_mA;
    t->current_cmd_mA = out->current_cmd_mA;
}

// What the rules said last is forgotten last: the same words may hold another table by now.
static void use_rules(controller_t *c, const fuzzy_table_t *table) {
    c->rules_next = table;
    c->rules.table = NULL;
}

quiesce_rules_verdict_t quiesce_rules_use(quiesce_t *self, const uint32_t *words, uint32_t count) {
    controller_t *c = (controller_t *)(void *)self->opaque;
    if (words == NULL) {
        use_rules(c, shipped_rules());
        return QUIESCE_RULES_OK;
    }
    const fuzzy_table_t *table = (const fuzzy_table_t *)(const void *)words;
    const fuzzy_verdict_t verdict = fuzzy_table_check(table, count);
    if (verdict != FUZZY_TABLE_OK) {
        return (quiesce_rules_verdict_t)verdict;
    }
    if (table->inputs != RULE_INPUTS || table->outputs != 1u || table->units != RULE_UNITS) {
        return QUIESCE_RULES_FIT;
    }
    use_rules(c, table);
    return QUIESCE_RULES_OK;
}

quiesce_phase_verdict_t quiesce_phase_table_use(quiesce_t *self, const uint32_t *words,
                                                uint32_t count) {
    controller_t *c = (controller_t *)(void *)self->opaque;
    if (words == NULL) {
        words = plant_pulses_table;
        count = sizeof plant_pulses_table / sizeof plant_pulses_table[0];
    }
    return (quiesce_phase_verdict_t)law_phase_use(&c->law_state, &c->params, words, count);
}

void quiesce_adaptation_save(const quiesce_t *self, quiesce_adaptation_t *out) {
    const controller_t *c = (const controller_t *)(const void *)self->opaque;
    law_phase_save(&c->law_state, &c->params, out->words);
}

bool quiesce_adaptation_load(quiesce_t *self, const quiesce_adaptation_t *in) {
    controller_t *c = (controller_t *)(void *)self->opaque;
    return law_phase_load(&c->law_state, &c->params, in->words);
}

void quiesce_adaptation_reset(quiesce_t *self) {
    controller_t *c = (controller_t *)(void *)self->opaque;
    law_phase_reset(&c->law_state);
}

void quiesce_adaptation_freeze(quiesce_t *self, bool is_frozen) {
    controller_t *c = (controller_t *)(void *)self->opaque;
    law_phase_freeze(&c->law_state, is_frozen);
}

int32_t quiesce_rules_current_mA(int32_t freq_uHz, int32_t rms_um_s2, uint32_t *fired) {
    const int32_t input[] = {freq_uHz, rms_um_s2};
    if (fired != NULL) {
        *fired = rules_fired(shipped_rules(), input);
    }
    return rules_current_mA(shipped_rules(), input);
}
