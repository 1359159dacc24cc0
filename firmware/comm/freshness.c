#include "freshness.h"

#include "e2e.h"
#include "fixq.h"

static int32_t add_sat(int32_t a, int32_t b) {
    return (int32_t)clamp_i64((int64_t)a + b, INT32_MIN, INT32_MAX);
}

void freshness_use(freshness_t *self, int32_t cycle_us, int32_t timeout_us) {
    const int32_t usual_us = cycle_us / 4 * 3;
    self->cycle_us = cycle_us;
    self->timeout_us = timeout_us;
    self->tolerance_us = usual_us > FRESHNESS_JITTER_US ? usual_us : FRESHNESS_JITTER_US;
    self->drift_us = cycle_us / 8;
}

bool freshness_is_known(const freshness_t *self) {
    return self->trial == FRESHNESS_TRIAL;
}

// A frame of the row: it is due when it comes, as far as clocks may differ.
static void follow(freshness_t *self, uint8_t alive, uint32_t content, int32_t late_us) {
    self->since_due_us = late_us - clamp_i32(late_us, -self->drift_us, self->drift_us);
    self->alive = alive;
    self->content = content;
}

static int32_t least(int32_t a, int32_t b) {
    return a < b ? a : b;
}

// How long a frame holds. After a gap: until the next one would be late, and no more than a cycle
// longer than before.
static int32_t hold_us(const freshness_t *self, uint32_t step, int32_t late_us) {
    const int32_t passed_us = late_us > 0 ? late_us : 0;
    if (step == 1u) {
        return self->timeout_us - passed_us;
    }
    const int32_t next_us = self->cycle_us + self->drift_us + self->tolerance_us - passed_us;
    return least(next_us > self->left_us ? next_us : self->left_us, self->left_us + self->cycle_us);
}

// After a gap a frame must not come before its time: what is missing may only be late.
static bool is_early(const freshness_t *self, uint32_t step, int32_t late_us) {
    const int32_t most_us = step == 1u ? self->tolerance_us : self->tolerance_us / 4;
    return late_us < -(most_us + self->drift_us);
}

// One counter that is ahead of its time may be somebody else's, two are a sender that jumped.
static freshness_verdict_t refuse_early(freshness_t *self) {
    self->trial = self->has_jumped ? 0u : FRESHNESS_TRIAL;
    self->has_jumped = true;
    return FRESHNESS_REFUSED;
}

static freshness_verdict_t judge_known(freshness_t *self, uint8_t alive, uint32_t content,
                                       uint32_t step) {
    if (step == 0u) {
        self->trial = content == self->content ? FRESHNESS_TRIAL : 0u;
        return FRESHNESS_REFUSED;
    }
    const int32_t late_us = self->since_due_us - (int32_t)step * self->cycle_us;
    if (is_early(self, step, late_us)) {
        return refuse_early(self);
    }
    if (late_us > self->tolerance_us + self->drift_us) {
        return FRESHNESS_REFUSED;
    }
    self->left_us = hold_us(self, step, late_us);
    self->has_jumped = false;
    follow(self, alive, content, late_us);
    return FRESHNESS_COUNTS;
}

static freshness_verdict_t begin(freshness_t *self, uint8_t alive, uint32_t content) {
    const bool is_first = self->trial == 0u;
    follow(self, alive, content, 0);
    self->trial = 1;
    self->spaced_us = 0;
    return is_first ? FRESHNESS_BEGINS : FRESHNESS_REFUSED;
}

// Frames of a burst count once: they are early, and then the earliest row is the right one. Late
// ones may still be caught up with.
static freshness_verdict_t judge_trial(freshness_t *self, uint8_t alive, uint32_t content,
                                       uint32_t step) {
    const int32_t late_us = self->since_due_us - self->cycle_us;
    const int32_t most_us = self->tolerance_us + self->drift_us;
    if (self->trial == 0u || step != 1u || late_us < -most_us) {
        return begin(self, alive, content);
    }
    follow(self, alive, content, late_us);
    if (late_us > most_us || self->spaced_us < self->cycle_us / 2) {
        return FRESHNESS_ON_TRIAL;
    }
    self->spaced_us = 0;
    self->trial++;
    if (self->trial < FRESHNESS_TRIAL) {
        return FRESHNESS_ON_TRIAL;
    }
    self->left_us = hold_us(self, 1, late_us);
    self->has_jumped = false;
    return FRESHNESS_COUNTS;
}

freshness_verdict_t freshness_judge(freshness_t *self, uint8_t alive, uint32_t content) {
    const uint32_t step = ((uint32_t)alive - self->alive) & (E2E_ALIVE_PERIOD - 1u);
    return freshness_is_known(self) ? judge_known(self, alive, content, step)
                                    : judge_trial(self, alive, content, step);
}

void freshness_pass(freshness_t *self, int32_t passed_us) {
    self->since_due_us = add_sat(self->since_due_us, passed_us);
    self->spaced_us = add_sat(self->spaced_us, passed_us);
    const bool is_over = freshness_is_known(self) ? self->left_us < passed_us
                                                  : self->since_due_us > self->timeout_us;
    self->left_us -= passed_us < self->left_us ? passed_us : self->left_us;
    if (is_over) {
        self->trial = 0;
    }
}
