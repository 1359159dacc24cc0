// The one file that knows the order of the chain; signal_chain.c wires its sensing half.
#include "quiesce.h"

#include <stddef.h>

#include "at_start.h"
#include "control.h"
#include "controller_tables.h"
#include "drive.h"
#include "rest.h"
#include "signal_chain.h"
#include "supervisor.h"
#include "sweep.h"
#include "twin.h"

// Lives in the caller's opaque words; the library is built with -fno-strict-aliasing for that.
typedef struct {
    signal_chain_t signal;
    view_t view;
    control_t control;
    uint32_t recover_ticks; ///< of good samples before the output may be enabled
    supervisor_t supervisor;
    uint32_t supervisor_twin[TWIN_WORDS(WORDS_OF(supervisor_t))];
    drive_t drive[QUIESCE_DAMPERS];
    sweep_t sweep;
    rest_t rest;
    law_demand_t request; ///< of the last tick
    uint32_t last_tick;
    uint32_t bad_sample_count;
    bool has_ticked;
} controller_t;

_Static_assert(sizeof(controller_t) <= QUIESCE_STATE_BYTES, "QUIESCE_STATE_BYTES is too small");
_Static_assert(sizeof(quiesce_telemetry_t) % sizeof(uint32_t) == 0, "telemetry is words only");
_Static_assert(QUIESCE_PEAKS == ESTIMATOR_TONES, "telemetry holds the estimator's components");

// Parts of the sweep.
enum { SWEPT_PARAMS, SWEPT_LAW_TABLE, SWEPT_FORCE_TABLE, SWEPT_WATCHES };
_Static_assert(SWEPT_WATCHES + QUIESCE_WATCHES == SWEEP_PARTS, "the caller's parts are the last");

static uint32_t dampers_of(const controller_t *self) {
    return QUIESCE_DAMPERS == 1 ? 1u : self->signal.sensing.places.dampers;
}

// What the parameters say of one accelerometer and one damper.
static void describe_board(const quiesce_params_t *p, quiesce_board_t *board) {
    const int32_t tick_us = 1000000 / p->tick_rate_Hz;
    quiesce_board_default(board);
    quiesce_board_sensor_t *sensor = &board->sensor[0];
    sensor->axis = p->accel_axis;
    sensor->polarity = p->accel_polarity;
    sensor->scale = p->accel_scale_nm_s2;
    sensor->offset_counts = p->accel_offset_counts;
    sensor->full_scale_counts = p->accel_full_scale_counts;
    sensor->max_age_us = p->sensor_max_age_ticks * tick_us;
    sensor->stuck_us = p->sensor_stuck_ticks * tick_us;
    sensor->min_noise_counts = p->sensor_min_noise_counts;
    quiesce_board_damper_t *damper = &board->damper[0];
    damper->ceiling_mA = QUIESCE_HIGHEST_CURRENT_mA;
    damper->continuous_mA = QUIESCE_HIGHEST_CURRENT_mA; // what a coil carries only a board says
    damper->measures_current = p->current_check;
    damper->coil_lag_us = p->current_lag_ms * 1000;
}

static const uint32_t *own_words(const controller_t *self) {
    return (const uint32_t *)(const void *)&self->control.setup.params;
}

static void sweep_params(controller_t *self) {
    sweep_watch(&self->sweep, SWEPT_PARAMS, own_words(self), QUIESCE_PARAM_COUNT, own_words(self));
}

// Their third word is the number of words in all. What was watched already is not read anew, as if
// it were right: only one that has just been checked is.
static void sweep_tables(controller_t *self, const uint32_t *checked) {
    const uint32_t *const table[] = {self->control.setup.table, self->control.forces.table};
    for (uint32_t i = 0; i < 2; i++) {
        const uint32_t part = SWEPT_LAW_TABLE + i;
        if (table[i] != self->sweep.part[part].words || table[i] == checked) {
            sweep_watch(&self->sweep, part, table[i], table[i] != NULL ? table[i][2] : 0,
                        own_words(self));
        }
    }
}

AT_START static void start_all(controller_t *self, const quiesce_board_t *board,
                               const quiesce_params_t *params, const quiesce_params_t *used,
                               bool is_accepted) {
    *self = (controller_t){.view.may_learn = true};
    signal_chain_init(&self->signal, board, used, control_serves(used), law_find(used->law)->lock);
    control_init(&self->control, &self->signal.sensing.places, used);
    self->recover_ticks = (uint32_t)used->sensor_recover_ticks;
    for (uint32_t i = 0; i < dampers_of(self); i++) {
        drive_init(&self->drive[i], i, &board->damper[i], params, is_accepted);
    }
    supervisor_init(&self->supervisor, is_accepted ? QUIESCE_FAULT_NONE : QUIESCE_FAULT_PARAMETER);
    twin_make(&self->supervisor, WORDS_OF(supervisor_t), self->supervisor_twin);
    sweep_init(&self->sweep, (uint32_t)used->tick_rate_Hz);
    sweep_params(self);
    sweep_tables(self, NULL);
}

bool quiesce_init(quiesce_t *self, const quiesce_params_t *params) {
    const bool is_accepted = quiesce_params_check(params, NULL);
    // Where they are refused the chain still runs, on defaults; the supervisor lets nothing of it
    // out.
    quiesce_params_t used = *params;
    if (!is_accepted) {
        quiesce_params_default(&used);
    }
    quiesce_board_t board;
    describe_board(&used, &board);
    board.damper[0].safe_mA = quiesce_params_safe_current_mA(params);
    start_all((controller_t *)(void *)self->opaque, &board, params, &used, is_accepted);
    return is_accepted;
}

bool quiesce_init_board(quiesce_t *self, const quiesce_board_t *board,
                        const quiesce_params_t *params) {
    quiesce_board_t used_board = *board;
    quiesce_params_t used = *params;
    bool is_accepted = quiesce_params_check(params, NULL);
    if (!is_accepted) {
        quiesce_params_default(&used);
    }
    if (!quiesce_board_check(board, NULL)) {
        quiesce_board_default(&used_board);
        is_accepted = false;
    }
    quiesce_signal_t missing;
    is_accepted = is_accepted && !quiesce_missing(&used_board, &used, &missing);
    start_all((controller_t *)(void *)self->opaque, &used_board, &used, &used, is_accepted);
    return is_accepted;
}

AT_START bool quiesce_restart(quiesce_t *self, const quiesce_board_t *board,
                              const quiesce_params_t *params) {
    controller_t *c = (controller_t *)(void *)self->opaque;
    const sweep_t sweep = c->sweep;
    int64_t heat_q20[QUIESCE_DAMPERS];
    for (uint32_t i = 0; i < QUIESCE_DAMPERS; i++) {
        heat_q20[i] = c->drive[i].heat.heat_q20;
    }
    const bool is_accepted =
        board == NULL ? quiesce_init(self, params) : quiesce_init_board(self, board, params);
    for (uint32_t i = 0; i < dampers_of(c); i++) {
        heat_resume(&c->drive[i].heat, heat_q20[i]);
    }
    for (uint32_t i = SWEPT_WATCHES; i < SWEEP_PARTS; i++) {
        sweep_go_on(&c->sweep, i, &sweep.part[i]);
    }
    return is_accepted;
}

// Everything but pointers is taken: law, tracker and tables have been chosen by the start, and are
// the same ones. Words that are watched stay the caller's own.
bool quiesce_go_on(quiesce_t *self, const quiesce_t *from) {
    controller_t *c = (controller_t *)(void *)self->opaque;
    const controller_t *other = (const controller_t *)(const void *)from->opaque;
    sweep_t sweep = c->sweep;
    if (c->control.setup.params.law != other->control.setup.params.law ||
        c->control.setup.params.tracker != other->control.setup.params.tracker ||
        !sweep_go_on_all(&sweep, &other->sweep, SWEPT_PARAMS)) {
        return false;
    }
    const control_t *own = &c->control;
    const law_t *law = own->law;
    const uint32_t *table = own->setup.table;
    const forces_t forces = own->forces;
    *c = *other;
    c->control.law = law;
    c->control.setup.table = table;
    c->control.forces = forces;
    c->view.tone.half = NULL; // of a tick that is over
    c->sweep = sweep;
    return true;
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

// Energy comes out of a damper, as it cannot: force or stroke has the wrong sense.
static bool is_reversed(controller_t *self, uint32_t i, bool are_valid) {
    const view_damper_t *damper = &self->view.damper[i];
    return energy_is_negative(&self->drive[i].energy, damper->force_mN, damper->velocity_um_s,
                              are_valid);
}

// The first fault of any driver, or of the sensors of its damper.
static quiesce_fault_t watch_drives(controller_t *self, const quiesce_in_t *in) {
    static const uint8_t fault_of[] = {
        [CURRENT_OK] = QUIESCE_FAULT_NONE,
        [CURRENT_NOT_FOLLOWING] = QUIESCE_FAULT_DRIVER_NOT_FOLLOWING,
        [CURRENT_OPEN_COIL] = QUIESCE_FAULT_COIL_OPEN,
        [CURRENT_MISSING] = QUIESCE_FAULT_CURRENT_LOST,
        [CURRENT_OVER] = QUIESCE_FAULT_OVERCURRENT,
        [CURRENT_HOT] = QUIESCE_FAULT_COIL_HOT,
        [CURRENT_SHORT] = QUIESCE_FAULT_COIL_SHORT,
    };
    const uint64_t motion = VIEW_FORCE | VIEW_STROKE_VELOCITY;
    quiesce_fault_t found = QUIESCE_FAULT_NONE;
    uint64_t valid = self->view.valid; // of damper i where the bits of the first one are
    for (uint32_t i = 0; i < dampers_of(self); i++, valid >>= 1) {
        current_verdict_t verdict;
        const bool has_voltage = DRIVE_SEES_COIL && (valid & VIEW_VOLTAGE) != 0;
        const int32_t *voltage_mV = has_voltage ? &self->view.damper[i].voltage_mV : NULL;
        self->view.damper[i].current_mA =
            drive_watch(&self->drive[i], &in->driver[i], voltage_mV, &verdict);
        found = found == QUIESCE_FAULT_NONE ? (quiesce_fault_t)fault_of[verdict] : found;
        if (DRIVE_SEES_COIL && is_reversed(self, i, (valid & motion) == motion) &&
            found == QUIESCE_FAULT_NONE) {
            found = QUIESCE_FAULT_SENSOR_POLARITY;
        }
    }
    return found;
}

static quiesce_fault_t latched_fault(const controller_t *self, const quiesce_in_t *in,
                                     quiesce_fault_t current_fault) {
    if (in->estop) {
        return QUIESCE_FAULT_ESTOP;
    }
    for (uint32_t i = 0; i < dampers_of(self); i++) {
        if (in->driver[i].has_failed) {
            return QUIESCE_FAULT_DRIVER_FAILED;
        }
    }
    return current_fault;
}

// Very many where the tick did not go on, or went back.
static uint32_t lost_ticks(controller_t *self, uint32_t tick) {
    const uint32_t lost = self->has_ticked ? tick - self->last_tick - 1u : 0;
    self->has_ticked = true;
    self->last_tick = tick;
    return lost;
}

typedef struct {
    const condition_out_t *sample;
    quiesce_fault_t current_fault;
    bool has_gap;
    bool is_blind; ///< for longer than the law may be
} findings_t;

static quiesce_fault_t clearing_fault(const findings_t *found) {
    const quiesce_fault_t sensor = sensor_fault(found->sample);
    if (sensor != QUIESCE_FAULT_NONE) {
        return sensor;
    }
    if (found->has_gap) {
        return QUIESCE_FAULT_TICK_LOST;
    }
    return found->is_blind ? QUIESCE_FAULT_LAW_BLIND : QUIESCE_FAULT_NONE;
}

static bool is_limited(const controller_t *self) {
    bool is_limiting = false;
    for (uint32_t i = 0; i < dampers_of(self); i++) {
        is_limiting = is_limiting || drive_is_limited(&self->drive[i]);
    }
    return is_limiting;
}

// While they are off no current has been measured for some time, where currents are measured.
static bool are_quiet(const controller_t *self) {
    bool are_quiet = true;
    for (uint32_t i = 0; i < dampers_of(self); i++) {
        are_quiet = are_quiet && current_monitor_is_quiet(&self->drive[i].monitor);
    }
    return are_quiet;
}

static bool is_ready(const controller_t *self, const findings_t *found) {
    const bool sees =
        supervisor_allows_output(&self->supervisor) || control_sees(&self->control, &self->view);
    return sees && found->sample->good_ticks >= self->recover_ticks &&
           (supervisor_is_tested(&self->supervisor) || are_quiet(self));
}

static void supervise(controller_t *self, const quiesce_in_t *in, const findings_t *found) {
    const supervisor_in_t events = {
        .clearing_fault = clearing_fault(found),
        .latched_fault = latched_fault(self, in, found->current_fault),
        .is_ready = is_ready(self, found),
        .is_limited = is_limited(self),
        .enable = in->enable,
        .fault_reset = in->fault_reset,
    };
    if (supervisor_step(&self->supervisor, &events)) {
        for (uint32_t i = 0; i < dampers_of(self); i++) {
            drive_forget(&self->drive[i]);
        }
    }
    twin_make(&self->supervisor, WORDS_OF(supervisor_t), self->supervisor_twin);
}

// Whether what decides about currents still is what the last tick left, and what it reads what was
// checked. Where not, nothing that it says is believed any more.
static bool is_intact(controller_t *self) {
    bool is_intact = sweep_step(&self->sweep, own_words(self));
    is_intact =
        is_intact && twin_holds(&self->supervisor, WORDS_OF(supervisor_t), self->supervisor_twin);
    for (uint32_t i = 0; i < dampers_of(self); i++) {
        is_intact = drive_is_intact(&self->drive[i]) && is_intact;
    }
    return is_intact;
}

// The twins stay as they are, so that it stays shut.
static void shut(controller_t *self, quiesce_out_t *out) {
    supervisor_init(&self->supervisor, QUIESCE_FAULT_MEMORY);
    for (uint32_t i = 0; i < QUIESCE_DAMPERS; i++) {
        drive_shut(&self->drive[i], &out->damper[i]);
    }
}

static void command(controller_t *self, quiesce_out_t *out) {
    const bool is_allowed = supervisor_allows_output(&self->supervisor);
    const bool driver_enable = supervisor_allows_driver(&self->supervisor);
    for (uint32_t i = 0; i < QUIESCE_DAMPERS; i++) {
        if (i < dampers_of(self)) {
            drive_command(&self->drive[i], self->request.value[i], is_allowed, driver_enable,
                          &out->damper[i]);
        } else {
            out->damper[i] = (quiesce_command_t){0};
        }
    }
}

// Turns Q32 in thousandths of a degree, -180000 .. 179999.
static int32_t phase_mdeg(uint32_t turn) {
    return (int32_t)(((int64_t)(int32_t)turn * 360000) >> 32);
}

static void report_components(const signal_chain_t *signal, quiesce_telemetry_t *t) {
    const estimate_t *estimate = &signal->estimator.known;
    t->freq_is_valid = estimate->is_valid ? 1u : 0u;
    t->freq_age_ticks = estimate->age_ticks;
    t->freq_uHz = estimate->tone[0].freq_uHz;
    t->freq_amp_um_s2 = estimate->tone[0].amp_um_s2;
    t->freq_phase_mdeg = phase_mdeg(estimate_phase_turn(estimate, 0));
    t->freq_sigma_uHz = estimate->sigma_uHz;
    t->freq_window_ms = estimate->window_ms;
    t->displacement_amp_nm = signal->displacement.half_peak_to_peak_nm;
    t->velocity_rms_um_s = estimate->velocity.rms_um_s;
    for (uint32_t i = 0; i < QUIESCE_PEAKS; i++) {
        const estimator_tone_t *tone = &estimate->tone[i];
        t->peaks[i] = estimate->predictor.is_armed && tone->freq_uHz != 0
                          ? (quiesce_peak_t){tone->freq_uHz, tone->amp_um_s2,
                                             phase_mdeg(estimate_phase_turn(estimate, i))}
                          : (quiesce_peak_t){0};
    }
}

static void report(const controller_t *self, quiesce_telemetry_t *t) {
    t->state = (uint32_t)self->supervisor.state;
    t->fault = (uint32_t)self->supervisor.fault;
    t->fault_count = self->supervisor.fault_count;
    t->bad_sample_count = self->bad_sample_count;
    report_components(&self->signal, t);
    t->lock_is_on = self->signal.lock.in.is_locked ? 1u : 0u;
}

void quiesce_step(quiesce_t *self, const quiesce_in_t *in, quiesce_out_t *out) {
    controller_t *c = (controller_t *)(void *)self->opaque;
    quiesce_telemetry_t *t = &out->telemetry;

    const signal_chain_in_t signal_in = {
        .samples = in->sensor,
        .lost_ticks = lost_ticks(c, in->tick),
        .lock = c->control.law->lock,
    };
    signal_chain_out_t signal;
    signal_chain_step(&c->signal, &signal_in, &c->view, &signal);
    if (signal.sample->flag != CONDITION_GOOD) {
        c->bad_sample_count = increment_sat_u32(c->bad_sample_count);
    }

    findings_t found = {.sample = signal.sample, .has_gap = signal_in.lost_ticks > 0};
    found.current_fault = watch_drives(c, in);
    c->view.is_output_on = supervisor_allows_output(&c->supervisor);
    c->view.is_at_rest = rest_step(&c->rest, &c->view, &c->control.setup.params);
    // A law whose tables are not what they were is not asked any more: it could lead anywhere.
    const bool is_believed = c->supervisor.fault != QUIESCE_FAULT_MEMORY;
    found.is_blind = is_believed && !control_step(&c->control, &c->view, &c->request);
    if (is_intact(c)) {
        supervise(c, in, &found);
        command(c, out);
    } else {
        shut(c, out);
    }

    report(c, t);
    t->tick = in->tick;
    t->accel_um_s2 = signal.sample->value;
    t->displacement_nm = signal.displacement_nm;
    t->velocity_um_s = motion_velocity_um_s(signal.velocity_um_s_q32);
    t->rms_um_s2 = signal.rms_um_s2;
    t->current_law_mA = c->request.value[0];
    t->current_cmd_mA = out->damper[0].current_cmd_mA;
}

void quiesce_hold_drivers(quiesce_t *self, const quiesce_in_t *in, quiesce_out_t *out) {
    controller_t *c = (controller_t *)(void *)self->opaque;
    for (uint32_t i = 0; i < dampers_of(c); i++) {
        drive_hold(&c->drive[i], &in->driver[i], &out->damper[i]);
    }
}

static control_t *control_of(quiesce_t *self) {
    return &((controller_t *)(void *)self->opaque)->control;
}

static const control_t *known_of(const quiesce_t *self) {
    return &((const controller_t *)(const void *)self->opaque)->control;
}

quiesce_table_verdict_t controller_check_table(const quiesce_t *self, const uint32_t *words,
                                               uint32_t count, bool is_summed) {
    return control_check(known_of(self), words, count, is_summed);
}

quiesce_table_verdict_t controller_use_table(quiesce_t *self, const uint32_t *words, uint32_t count,
                                             bool is_summed) {
    controller_t *c = (controller_t *)(void *)self->opaque;
    const quiesce_table_verdict_t verdict = control_check(&c->control, words, count, is_summed);
    if (verdict == QUIESCE_TABLE_OK) {
        control_use(&c->control, words);
        sweep_tables(c, words);
    }
    return verdict;
}

quiesce_table_verdict_t quiesce_table_use(quiesce_t *self, const uint32_t *words, uint32_t count) {
    return controller_use_table(self, words, count, false);
}

bool quiesce_table_drop(quiesce_t *self, quiesce_owner_t owner) {
    controller_t *c = (controller_t *)(void *)self->opaque;
    const bool is_dropped = control_drop(&c->control, owner);
    sweep_tables(c, NULL);
    return is_dropped;
}

const uint32_t *quiesce_table_in_use(const quiesce_t *self, quiesce_owner_t owner) {
    return control_table(known_of(self), owner);
}

void quiesce_watch(quiesce_t *self, uint32_t which, const uint32_t *words, uint32_t count) {
    controller_t *c = (controller_t *)(void *)self->opaque;
    if (which < QUIESCE_WATCHES) {
        sweep_watch(&c->sweep, SWEPT_WATCHES + which, words, words != NULL ? count : 0,
                    own_words(c));
    }
}

const char *quiesce_lacks_table(const quiesce_t *self) {
    return control_lacks_table(known_of(self));
}

uint32_t quiesce_table_hash(const quiesce_t *self) {
    return control_table_hash(known_of(self));
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

bool quiesce_params_use(quiesce_t *self, const quiesce_params_t *params) {
    controller_t *c = (controller_t *)(void *)self->opaque;
    quiesce_params_t *used = &c->control.setup.params;
    if (c->supervisor.fault == QUIESCE_FAULT_PARAMETER || !quiesce_params_check(params, NULL) ||
        !quiesce_params_differ_live(used, params, NULL)) {
        return false;
    }
    *used = *params;
    sweep_params(c);
    return true;
}

bool quiesce_is_armed(const quiesce_t *self) {
    return supervisor_is_armed(&((const controller_t *)(const void *)self->opaque)->supervisor);
}

const quiesce_word_t *quiesce_report_words(int32_t law) {
    static const quiesce_word_t none[QUIESCE_REPORT_WORDS] = {{NULL, NULL}};
    const law_t *asked = law_find(law);
    if (asked == NULL) {
        return NULL;
    }
    return asked->reports != NULL ? asked->reports : none;
}

void quiesce_report(const quiesce_t *self, int32_t word[QUIESCE_REPORT_WORDS]) {
    control_report(known_of(self), word);
}

void quiesce_picture(const quiesce_t *self, quiesce_picture_t *out) {
    const controller_t *c = (const controller_t *)(const void *)self->opaque;
    view_t view = c->view;
    sensing_show_strokes(&c->signal.sensing, &view);
    *out = (quiesce_picture_t){
        .valid = {(uint32_t)view.valid, (uint32_t)(view.valid >> 32)},
        .supply_mV = view.supply_mV,
    };
    for (uint32_t i = 0; i < QUIESCE_BODIES; i++) {
        const view_body_t *body = &view.body[i];
        out->body[i].accel_um_s2 = body->accel_um_s2;
        out->body[i].velocity_um_s = body->velocity_um_s;
        out->body[i].displacement_nm = body->displacement_nm;
    }
    for (uint32_t i = 0; i < QUIESCE_DAMPERS; i++) {
        const view_damper_t *damper = &view.damper[i];
        out->damper[i].stroke_nm = damper->stroke_nm;
        out->damper[i].velocity_um_s = damper->velocity_um_s;
        out->damper[i].force_mN = damper->force_mN;
        out->damper[i].current_mA = damper->current_mA;
        out->damper[i].voltage_mV = damper->voltage_mV;
        out->damper[i].temperature_mdegC = damper->temperature_mdegC;
        out->damper[i].current_law_mA = i < dampers_of(c) ? c->request.value[i] : 0;
        out->damper[i].current_cmd_mA = drive_current_cmd_mA(&c->drive[i]);
    }
}
