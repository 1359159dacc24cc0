#include "dominant_lock.h"

#include <stddef.h>

#include "law.h"
#include "trig.h"

enum {
    ELSEWHERE_DIVISOR = 32, // a lock 3 % off the dominant component is on something else
    OWN_DIVISOR = 8,        // of the frequency: so near to an odd multiple it is a harmonic
    STEP_SHIFT = 14,        // of frequencies to compare: 1.5 % of 1 Hz at the fastest tick
    LASTING_HALVES = 16,    // half cycles after which a lock is as good as trusted
    ALIKE_ANEW = 1,         // half cycles that resemble those before, to lock on after such a lock
    ALIKE_FACTOR = 2,       // times as many after each lock that half cycles made
    ALIKE_MOST = 128,
};

static uint32_t step_turn_of(int32_t freq_mHz, uint32_t rate_Hz) {
    return (uint32_t)(((uint64_t)(uint32_t)freq_mHz << 32) / (1000u * rate_Hz));
}

static void init(dominant_lock_state_t *self, const dominant_lock_cfg_t *cfg) {
    const uint32_t rate_Hz = cfg->tick_rate_Hz;
    const uint64_t latency = (uint64_t)(uint32_t)cfg->latency_us * rate_Hz * 256u;
    *self = (dominant_lock_state_t){
        .least_alike = DOMINANT_LOCK_FIRST,
        .lowest_step_turn = step_turn_of(cfg->band_low_mHz, rate_Hz),
        .highest_step_turn = step_turn_of(cfg->band_high_mHz, rate_Hz),
        .min_accel_um_s2 = cfg->min_accel_um_s2,
        .latency_q8 = (uint32_t)((latency + 500000u) / 1000000u), // to nearest
        .corner_step_turn = step_turn_of(cfg->corner_mHz, rate_Hz),
    };
    lock_in_init(&self->in);
    half_cycles_reset(&self->half_cycles);
}

static bool is_elsewhere(const lock_in_t *lock, uint32_t step_turn) {
    return !lock->is_locked || gap_u32(lock->step_turn, step_turn) > step_turn / ELSEWHERE_DIVISOR;
}

// The lock's component and its odd harmonics, which a sticking damper adds, are its own.
static bool is_own(uint32_t own, uint32_t step_turn) {
    const uint32_t times = (step_turn + own / 2u) / own;
    return times % 2u == 1u && gap_u32(step_turn, times * own) <= own / OWN_DIVISOR;
}

static void note_others(dominant_lock_state_t *self, const predictor_t *known) {
    self->others = 0;
    for (uint32_t i = 0; i < known->tones && self->in.is_locked; i++) {
        self->others |=
            (uint8_t)(is_own(self->in.step_turn, known->tone[i].step_turn) ? 0 : 1u << i);
    }
}

// Whether a displaces more than so many eighths of b, at most 10: amplitude / frequency^2, without
// a division. Steps are below 2^29, amplitudes below 2^30.
static bool displaces_more(const predictor_tone_t *a, const predictor_tone_t *b, uint32_t eighths) {
    const uint64_t fa = a->step_turn >> STEP_SHIFT;
    const uint64_t fb = b->step_turn >> STEP_SHIFT;
    return 8u * (uint64_t)(uint32_t)a->amp_um_s2 * (fb * fb) >
           eighths * (uint64_t)(uint32_t)b->amp_um_s2 * (fa * fa);
}

static bool is_outside(const dominant_lock_state_t *self, uint32_t step_turn) {
    return step_turn < self->lowest_step_turn - self->lowest_step_turn / 16u ||
           step_turn > self->highest_step_turn + self->highest_step_turn / 16u;
}

// Whether another component than the dominant one and its odd harmonics displaces too much: ten
// eighths of what it does, or nine where that was so before.
static bool is_crowded(const dominant_lock_state_t *self, const predictor_t *known) {
    const predictor_tone_t *tone = &known->tone[0];
    bool is_any = false;
    for (uint32_t i = 1; i < known->tones; i++) {
        is_any = is_any || (!is_own(tone->step_turn, known->tone[i].step_turn) &&
                            displaces_more(&known->tone[i], tone, self->is_crowded ? 9u : 10u));
    }
    return is_any;
}

// What the lock has to follow: the sample without the components that are not its own.
static int32_t own_um_s2(const dominant_lock_state_t *self, const dominant_lock_in_t *in) {
    if (self->others == 0) {
        return in->sample->raw;
    }
    int64_t sum_q25 = 0;
    for (uint32_t i = 0; i < PREDICTOR_TONES && self->others >> i != 0; i++) {
        const predictor_tone_t *tone = &in->known->tone[i];
        sum_q25 += (self->others >> i & 1u) == 0
                       ? 0
                       : (int64_t)tone->amp_um_s2 * cos_linear_q25(tone->phase_turn);
    }
    return (int32_t)clamp_i64(in->sample->raw - (sum_q25 >> 25), 1 - HARMONICS_LARGEST_um_s2,
                              HARMONICS_LARGEST_um_s2 - 1);
}

static void lock_on(dominant_lock_state_t *self, const condition_out_t *sample, uint32_t phase_turn,
                    uint32_t step_turn) {
    lock_in_acquire(&self->in, phase_turn, step_turn, sample->raw - sample->value);
}

// Until the estimator knows more: a few half cycles that are alike.
static void look_for_lock(dominant_lock_state_t *self, const dominant_lock_in_t *in) {
    half_cycles_tone_t tone;
    if (!half_cycles_step(&self->half_cycles, in->velocity_um_s, &tone) ||
        tone.alike < self->least_alike || self->in.is_locked || self->is_crowded) {
        return;
    }
    const uint32_t step_turn = half_cycles_step_turn(&tone);
    if (step_turn >= self->lowest_step_turn && step_turn <= self->highest_step_turn &&
        in->rms_um_s2 >= self->min_accel_um_s2) {
        lock_on(self, in->sample, half_cycles_phase_turn(&tone, step_turn), step_turn);
        note_others(self, in->known);
        self->least_alike =
            (uint8_t)(self->least_alike < ALIKE_MOST ? self->least_alike * ALIKE_FACTOR
                                                     : ALIKE_MOST);
    }
}

// The lock turns on through a few lost ticks.
static void bridge(dominant_lock_state_t *self, bool is_fault, uint32_t lost_ticks) {
    if (is_fault) {
        lock_in_release(&self->in);
    } else {
        lock_in_skip(&self->in, lost_ticks);
    }
    if (is_fault || lost_ticks > LOCK_IN_MOST_SKIPPED) {
        half_cycles_reset(&self->half_cycles);
    } else {
        half_cycles_skip(&self->half_cycles, lost_ticks);
    }
}

// The estimator's dominant component is where the lock belongs.
static void follow(dominant_lock_state_t *self, const dominant_lock_in_t *in) {
    const predictor_tone_t *tone = &in->known->tone[0];
    if (in->is_valid) {
        self->is_crowded = is_crowded(self, in->known);
        if (self->is_crowded) {
            lock_in_release(&self->in);
        } else if (is_elsewhere(&self->in, tone->step_turn)) {
            lock_on(self, in->sample, tone->phase_turn, tone->step_turn);
        }
        self->least_alike = ALIKE_ANEW;
    }
    note_others(self, in->known);
}

static void step(dominant_lock_state_t *self, const dominant_lock_in_t *in) {
    const condition_out_t *sample = in->sample;
    if (sample->is_fault || in->lost_ticks > 0) {
        bridge(self, sample->is_fault, in->lost_ticks);
    }
    if (!in->known->is_armed) { // they are not known any more
        self->others = 0;
        self->is_crowded = false;
    }
    lock_in_step(&self->in, own_um_s2(self, in), sample->flag == CONDITION_GOOD,
                 !in->is_busy && !self->has_news);
    if (self->in.is_locked && is_outside(self, self->in.step_turn)) {
        lock_in_release(&self->in);
    }
    if (self->in.is_locked && self->in.halves >= LASTING_HALVES) {
        self->least_alike = ALIKE_ANEW;
    }
    look_for_lock(self, in);
    if (self->has_news) {
        follow(self, in);
    }
    self->has_news = in->has_published;
}

// From the phase that the sensor shows to that of the structure when this tick's command reaches
// its driver: on by the latencies, back by what a first-order high-pass leads, atan(corner / f).
// The coil's lag is the table's.
static uint32_t turned(const dominant_lock_state_t *self) {
    const uint32_t step_turn = self->in.step_turn;
    const int32_t corner_step_turn = (int32_t)self->corner_step_turn;
    const uint32_t on_turn = (uint32_t)((uint64_t)step_turn * self->latency_q8 >> 8);
    const uint32_t back_turn =
        corner_step_turn == 0 ? 0 : atan2_turn(corner_step_turn, (int32_t)step_turn);
    return self->in.phase_turn + on_turn - back_turn;
}

static void show(const dominant_lock_state_t *self, view_t *view) {
    view->valid |= self->in.is_locked ? VIEW_LOCK : 0;
    view->tone.phase_turn = turned(self);
    view->tone.step_turn = self->in.step_turn;
    view->tone.half = self->in.has_half ? &self->in.last : NULL;
}

const dominant_lock_t dominant_lock = {init, step, show};
