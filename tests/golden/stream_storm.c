// A storm of faults under an operator's hands: every cause, alone and on top of others, for about
// as long as its limit, so that the controller goes round all of its states many times.
#include "stream_cases.h"

enum { LAWS = 5, CASES = 20, TICKS = 10000, RATES = 4, QUIET_COUNTS = 20 };

typedef enum {
    SENSE_GOOD,
    SENSE_LOST,
    SENSE_FULL,
    SENSE_BEYOND,
    SENSE_STUCK,
    SENSE_PATCHY
} sense_t;
typedef enum { COIL_FOLLOWS, COIL_OPEN, COIL_OFF_BY, COIL_UNKNOWN } coil_t;

typedef struct {
    sense_t sense;
    coil_t coil;
    uint32_t sense_ticks;
    uint32_t coil_ticks;
    uint32_t quiet_ticks;
    uint32_t estop_ticks;
    uint32_t failed_ticks;
    uint32_t idle_ticks;
    uint32_t reset_ticks;
    int32_t coil_mA_q8; ///< current in the coil
    int32_t off_by_mA;
    int32_t least_noise;
    uint32_t calm; ///< how many times rarer than in the worst storm all of it is
} storm_t;

static storm_t storm;

static void draw_case(stream_t *self, uint32_t number) {
    static const int32_t rates_Hz[RATES] = {1000, 500, 2000, 4000};
    quiesce_params_t *p = &self->params;
    do {
        quiesce_params_default(p);
        p->law = (int32_t)(number % LAWS);
        p->tick_rate_Hz = rates_Hz[number / LAWS];
        p->constant_current_mA = draw_between(&self->seed, 0, 5000);
        p->sensor_max_age_ticks = draw_between(&self->seed, 1, 20);
        p->sensor_stuck_ticks = 12 * draw_between(&self->seed, 0, 3);
        p->sensor_recover_ticks = draw_between(&self->seed, 1, 60);
        p->sensor_min_noise_counts = number % 3 == 0 ? QUIET_COUNTS : 0;
        p->accel_polarity = number % 2 == 0 ? 1 : -1;
        p->max_current_mA = draw_between(&self->seed, 2500, 5000);
        p->safe_current_mA = number % 4 == 1 ? draw_between(&self->seed, 1, 2500) : 0;
        p->unlock_current_mA = draw_between(&self->seed, 0, 5000);
        p->slew_mA_s = draw_between(&self->seed, 20000, 5000000);
        p->current_check = number % 5 == 3 ? 0 : 1;
        p->current_error_mA = draw_between(&self->seed, 100, 800);
        p->current_lag_ms = draw_between(&self->seed, 0, 10);
        p->current_fault_ticks = draw_between(&self->seed, 1, 40);
        if (number % (2 * LAWS) == 6) { // just at the limit of an open coil
            p->current_lag_ms = 0;
            p->constant_current_mA = 2 * p->current_error_mA;
        }
        p->track_hold_ms = draw_between(&self->seed, 0, 1200);
    } while (!quiesce_params_check(p, NULL));
}

// How long something lasts that starts now and then; 0: it does not.
static void draw_spell(stream_t *self, uint32_t *left_ticks, uint32_t one_in, uint32_t longest) {
    if (*left_ticks > 0) {
        (*left_ticks)--;
    } else if (draw_one_in(&self->seed, one_in)) {
        *left_ticks = 1u + draw_below(&self->seed, longest);
    }
}

// Silence of some seconds, or as much noise as just passes for a live sensor.
static void draw_quiet(stream_t *self, storm_t *s) {
    const bool is_new = s->quiet_ticks == 0;
    draw_spell(self, &s->quiet_ticks, 3000, 4u * (uint32_t)self->params.tick_rate_Hz);
    if (is_new) {
        s->least_noise = draw_one_in(&self->seed, 2) ? QUIET_COUNTS : 0;
    }
}

static void draw_events(stream_t *self, storm_t *s) {
    uint32_t *seed = &self->seed;
    if (s->quiet_ticks == 0) {
        draw_spell(self, &s->sense_ticks, 300 * s->calm, 40);
    }
    draw_spell(self, &s->coil_ticks, 400 * s->calm, 60);
    draw_quiet(self, s);
    draw_spell(self, &s->estop_ticks, 700 * s->calm, 30);
    draw_spell(self, &s->failed_ticks, 900 * s->calm, 30);
    draw_spell(self, &s->idle_ticks, 500 * s->calm, 80);
    draw_spell(self, &s->reset_ticks, 60, 20);
    if (s->sense_ticks == 0) {
        s->sense = SENSE_GOOD;
    } else if (s->sense == SENSE_GOOD) {
        s->sense = (sense_t)(1u + draw_below(seed, 5));
    }
    if (s->coil_ticks == 0) {
        s->coil = COIL_FOLLOWS;
    } else if (s->coil == COIL_FOLLOWS) {
        s->coil = (coil_t)(1u + draw_below(seed, 3));
        // At the limit to the last mA, or anywhere.
        const int32_t error_mA = self->params.current_error_mA + draw_between(seed, -2, 2);
        s->off_by_mA = draw_one_in(seed, 3)   ? draw_between(seed, -4000, 4000)
                       : draw_one_in(seed, 2) ? error_mA
                                              : -error_mA;
    }
}

// Up and down again: each sample bends by the same amount.
static int32_t quiet_sample(stream_t *self, const storm_t *s) {
    return s->least_noise > 0 ? (int32_t)(self->tick % 2u) * s->least_noise
                              : draw_between(&self->seed, 0, 3);
}

// A current within, at or beyond half the error that is allowed.
static int32_t open_coil_mA(stream_t *self) {
    const int32_t half_mA = self->params.current_error_mA / 2;
    return draw_one_in(&self->seed, 2) ? half_mA - draw_between(&self->seed, 0, 1)
                                       : draw_between(&self->seed, -30, 30);
}

static void sense(stream_t *self, const storm_t *s) {
    uint32_t *seed = &self->seed;
    const int32_t full_scale = self->params.accel_full_scale_counts;
    const int32_t side = draw_one_in(seed, 2) ? 1 : -1;
    quiesce_in_t *in = &self->in;
    const int32_t counts = draw_sample(seed, &self->vibration);
    in->sensor[0].is_fresh = true;
    switch (s->sense) {
    case SENSE_LOST:
        in->sensor[0].is_fresh = false;
        break;
    case SENSE_FULL:
        in->sensor[0].counts = side * (full_scale - draw_between(seed, 0, 7) / 7);
        break;
    case SENSE_BEYOND:
        // One count below the negative end is still the end.
        in->sensor[0].counts =
            draw_one_in(seed, 2) ? -full_scale - 1 : side * (full_scale + draw_between(seed, 0, 3));
        break;
    case SENSE_STUCK: // keeps what it was
        break;
    case SENSE_PATCHY:
        in->sensor[0].is_fresh = !draw_one_in(seed, 4);
        in->sensor[0].counts = counts;
        break;
    default:
        in->sensor[0].counts = s->quiet_ticks > 0 ? quiet_sample(self, s) : counts;
        break;
    }
}

// The coil follows what was commanded a tick ago.
static void measure(stream_t *self, storm_t *s) {
    const int32_t command_mA =
        self->out.damper[0].driver_enable ? self->out.damper[0].current_cmd_mA : 0;
    const int32_t lag_ticks = self->params.current_lag_ms * self->params.tick_rate_Hz / 1000;
    s->coil_mA_q8 += (command_mA * 256 - s->coil_mA_q8) / (1 + lag_ticks);
    const int32_t coil_mA = s->coil_mA_q8 / 256;
    self->in.driver[0].is_measured = s->coil != COIL_UNKNOWN;
    self->in.driver[0].current_mA = s->coil == COIL_OPEN     ? open_coil_mA(self)
                                    : s->coil == COIL_OFF_BY ? coil_mA + s->off_by_mA
                                                             : coil_mA;
}

static void draw_input(stream_t *self, storm_t *s) {
    if (self->vibration.left_ticks == 0) {
        draw_steady(&self->seed, self->params.tick_rate_Hz, &self->vibration);
    }
    draw_events(self, s);
    sense(self, s);
    measure(self, s);
    self->in.enable = s->idle_ticks == 0;
    self->in.estop = s->estop_ticks > 0;
    self->in.driver[0].has_failed = s->failed_ticks > 0;
    self->in.fault_reset = s->reset_ticks > 0;
    if (draw_one_in(&self->seed, 800)) {
        self->in.tick += (uint32_t)draw_between(&self->seed, -2, 9); // lost, repeated, or neither
    }
}

void stream_storm_cases(stream_t *self) {
    for (uint32_t number = 0; number < CASES; number++) {
        storm = (storm_t){.calm = number / 5 % 2 == 0 ? 1 : 8};
        stream_open(self, "storm", number);
        draw_case(self, number);
        stream_start(self);
        while (self->tick < TICKS) {
            draw_input(self, &storm);
            stream_step(self);
        }
        stream_close(self);
    }
}
