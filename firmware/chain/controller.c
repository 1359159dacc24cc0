// The one file that knows the order of the chain; signal_chain.c wires its sensing half.
#include "quiesce.h"

#include <stddef.h>

#include "control.h"
#include "current_monitor.h"
#include "guard.h"
#include "signal_chain.h"
#include "supervisor.h"

// Lives in the caller's opaque words; the library is built with -fno-strict-aliasing for that.
typedef struct {
    signal_chain_t signal;
    view_t view;
    control_t control;
    uint32_t recover_ticks; ///< of good samples before the output may be enabled
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
    *c = (controller_t){.view.may_learn = true};
    // Where they are refused the chain still runs, on defaults; the supervisor lets nothing of it
    // out.
    quiesce_params_t used = *params;
    if (!is_accepted) {
        quiesce_params_default(&used);
    }
    signal_chain_init(&c->signal, &used);
    control_init(&c->control, &used);
    c->recover_ticks = (uint32_t)used.sensor_recover_ticks;
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
    return in->driver[0].has_failed ? QUIESCE_FAULT_DRIVER_FAILED
                                    : (quiesce_fault_t)fault_of[verdict];
}

static bool is_tick_lost(controller_t *self, uint32_t tick) {
    const bool is_lost = self->has_ticked && tick != self->last_tick + 1u;
    self->has_ticked = true;
    self->last_tick = tick;
    return is_lost;
}

static void supervise(controller_t *self, const quiesce_in_t *in, const condition_out_t *sample,
                      bool has_gap) {
    const current_verdict_t verdict = current_monitor_step(
        &self->monitor, self->last_command_mA, in->driver[0].current_mA, in->driver[0].is_measured);
    const quiesce_fault_t lost = has_gap ? QUIESCE_FAULT_TICK_LOST : QUIESCE_FAULT_NONE;
    const quiesce_fault_t sensor = sensor_fault(sample);
    const supervisor_in_t events = {
        .clearing_fault = sensor != QUIESCE_FAULT_NONE ? sensor : lost,
        .latched_fault = latched_fault(in, verdict),
        .is_ready = sample->good_ticks >= self->recover_ticks,
        .enable = in->enable,
        .fault_reset = in->fault_reset,
    };
    if (supervisor_step(&self->supervisor, &events)) {
        current_monitor_reset(&self->monitor);
    }
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
}

void quiesce_step(quiesce_t *self, const quiesce_in_t *in, quiesce_out_t *out) {
    controller_t *c = (controller_t *)(void *)self->opaque;
    quiesce_telemetry_t *t = &out->telemetry;

    const signal_chain_in_t signal_in = {
        .accel_counts = in->sensor[0].counts,
        .is_fresh = in->sensor[0].is_fresh,
        .has_gap = is_tick_lost(c, in->tick),
        .wants_lock = c->control.law->wants_lock,
    };
    signal_chain_out_t signal;
    signal_chain_step(&c->signal, &signal_in, &c->view, &signal);
    if (signal.sample.flag != CONDITION_GOOD) {
        c->bad_sample_count = increment_sat_u32(c->bad_sample_count);
    }

    law_demand_t request;
    c->view.is_output_on = supervisor_allows_output(&c->supervisor);
    control_step(&c->control, &c->view, &request);

    supervise(c, in, &signal.sample, signal_in.has_gap);
    out->damper[0].current_cmd_mA =
        guard_step(&c->guard, request.value[0], supervisor_allows_output(&c->supervisor));
    out->damper[0].driver_enable = supervisor_allows_driver(&c->supervisor);
    // A driver that is switched off is expected to carry nothing.
    c->last_command_mA = out->damper[0].driver_enable ? out->damper[0].current_cmd_mA : 0;

    report(c, t);
    t->tick = in->tick;
    t->accel_um_s2 = signal.sample.value;
    t->displacement_nm = signal.displacement_nm;
    t->velocity_um_s = motion_velocity_um_s(signal.velocity_um_s_q32);
    t->rms_um_s2 = signal.rms_um_s2;
    t->current_law_mA = request.value[0];
    t->current_cmd_mA = out->damper[0].current_cmd_mA;
}

static control_t *control_of(quiesce_t *self) {
    return &((controller_t *)(void *)self->opaque)->control;
}

static const control_t *known_of(const quiesce_t *self) {
    return &((const controller_t *)(const void *)self->opaque)->control;
}

quiesce_table_verdict_t quiesce_table_use(quiesce_t *self, const uint32_t *words, uint32_t count) {
    return control_use(control_of(self), words, count);
}

bool quiesce_learnt_save(const quiesce_t *self, quiesce_learnt_t *out) {
    return control_save(known_of(self), out);
}

bool quiesce_learnt_load(quiesce_t *self, const quiesce_learnt_t *in) {
    return control_load(control_of(self), in);
}

void quiesce_learnt_freeze(quiesce_t *self, bool is_frozen) {
    ((controller_t *)(void *)self->opaque)->view.may_learn = !is_frozen;
}

const quiesce_word_t *quiesce_report_words(int32_t index) {
    static const quiesce_word_t none[QUIESCE_REPORT_WORDS] = {{NULL, NULL}};
    const law_t *law = law_find(index);
    if (law == NULL) {
        return NULL;
    }
    return law->reports != NULL ? law->reports : none;
}

void quiesce_report(const quiesce_t *self, int32_t word[QUIESCE_REPORT_WORDS]) {
    control_report(known_of(self), word);
}
