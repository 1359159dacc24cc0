#include "dominant_lock.h"

#include <stddef.h>

#include "law.h"

enum {
    ELSEWHERE_DIVISOR = 32, // a lock 3 % off the dominant component is on something else
    LASTING_HALVES = 16,    // half cycles after which a lock is as good as trusted
    ALIKE_ANEW = 1,         // half cycles that resemble those before, to lock on after such a lock
    ALIKE_FACTOR = 2,       // times as many after each lock that half cycles made
    ALIKE_MOST = 128,
};

static bool is_elsewhere(const lock_in_t *lock, uint32_t step_turn) {
    return !lock->is_locked || gap_u32(lock->step_turn, step_turn) > step_turn / ELSEWHERE_DIVISOR;
}

static void lock_on(dominant_lock_state_t *self, const condition_out_t *sample, uint32_t phase_turn,
                    uint32_t step_turn) {
    lock_in_acquire(&self->in, phase_turn, step_turn, sample->raw - sample->value);
}

// Until the estimator knows more: a few half cycles that are alike.
static void look_for_lock(dominant_lock_state_t *self, const dominant_lock_in_t *in) {
    half_cycles_tone_t tone;
    if (half_cycles_step(&self->half_cycles, in->velocity_um_s, &tone) &&
        tone.alike >= self->least_alike && !self->in.is_locked &&
        tone.step_turn >= self->lowest_step_turn && tone.step_turn <= self->highest_step_turn &&
        in->rms_um_s2 >= self->min_accel_um_s2) {
        lock_on(self, in->sample, tone.phase_turn, tone.step_turn);
        self->least_alike =
            (uint8_t)(self->least_alike < ALIKE_MOST ? self->least_alike * ALIKE_FACTOR
                                                     : ALIKE_MOST);
    }
}

// A component that has left the band, by more than a sixteenth of its edge, is none of the laws'.
static bool has_left_band(const dominant_lock_state_t *self) {
    const uint32_t step_turn = self->in.step_turn;
    return step_turn < self->lowest_step_turn - self->lowest_step_turn / 16u ||
           step_turn > self->highest_step_turn + self->highest_step_turn / 16u;
}

// The lock turns on through a few lost ticks; what half cycles there were is not known any more.
static void bridge(dominant_lock_state_t *self, bool is_fault, uint32_t lost_ticks) {
    if (is_fault) {
        lock_in_release(&self->in);
    } else {
        lock_in_skip(&self->in, lost_ticks);
    }
    half_cycles_reset(&self->half_cycles);
}

static void step(dominant_lock_state_t *self, const dominant_lock_in_t *in) {
    const condition_out_t *sample = in->sample;
    if (sample->is_fault || in->lost_ticks > 0) {
        bridge(self, sample->is_fault, in->lost_ticks);
    }
    lock_in_step(&self->in, sample->raw, sample->flag == CONDITION_GOOD);
    if (self->in.is_locked && has_left_band(self)) {
        lock_in_release(&self->in);
    }
    if (self->in.is_locked && self->in.halves >= LASTING_HALVES) {
        self->least_alike = ALIKE_ANEW;
    }
    look_for_lock(self, in);
    if (in->tone == NULL) {
        return;
    }
    if (is_elsewhere(&self->in, in->tone->step_turn)) {
        lock_on(self, sample, in->tone->phase_turn, in->tone->step_turn);
    }
    self->least_alike = ALIKE_ANEW;
}

const dominant_lock_t dominant_lock = {step};
