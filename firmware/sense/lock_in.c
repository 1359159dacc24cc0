#include "lock_in.h"

enum {
    LOST_ANGLE_TURN = 715827883,        // a sixth of a turn
    LAST_STAGE = HARMONIC_PRODUCTS + 2, // the mean, then all the rest
    CONTRADICTED_SHIFT = 2,             // a quarter of what is expected
    SCALED_BITS = 16,
    LARGEST_SCALED = 1 << 20,
};

// 4 f / rate: one over the ticks of a quarter of a cycle.
static uint32_t quarter_cycle_q16(uint32_t step_turn) {
    return step_turn >> 14;
}

// Running means keep their meaning where the unit changes.
static void rescale(lock_in_t *self, uint32_t shift) {
    if (shift > self->shift) {
        const uint32_t coarser = shift - self->shift;
        self->slow_q8 = self->slow_q8 >> coarser;
        self->unexplained = self->unexplained >> (2u * coarser);
    } else {
        const int64_t finer = INT64_C(1) << (self->shift - shift);
        self->slow_q8 =
            (int32_t)clamp_i64(self->slow_q8 * finer, -LARGEST_SCALED * 256, LARGEST_SCALED * 256);
        self->unexplained *= finer * finer;
    }
    self->shift = shift;
}

// Scaled so that squares of what is expected stay below 2^32, whatever its size.
static void expect(lock_in_t *self, uint32_t amp_um_s2, const harmonic_parts_t *parts) {
    const uint32_t bits = 32u - (uint32_t)__builtin_clz(amp_um_s2 | 1u);
    self->expected = *parts;
    self->amp_um_s2 = amp_um_s2;
    rescale(self, bits > SCALED_BITS ? bits - SCALED_BITS : 0);
    int64_t squares = 0;
    for (uint32_t i = 0; i < HARMONIC_PRODUCTS; i++) {
        squares += (int64_t)parts->um_s2[i] * parts->um_s2[i];
    }
    self->power = squares >> (1u + 2u * self->shift);
}

void lock_in_acquire(lock_in_t *self, uint32_t phase_turn, uint32_t step_turn, int32_t mean_um_s2) {
    *self = (lock_in_t){
        .is_locked = true,
        .phase_turn = phase_turn,
        .step_turn = step_turn,
        .mean_um_s2 = mean_um_s2,
        .memory_q16 = quarter_cycle_q16(step_turn),
    };
}

void lock_in_release(lock_in_t *self) {
    self->is_locked = false;
    self->has_half = false;
}

// Slow differences count: fast ones, from harmonics or a higher mode, say nothing of the phase.
static bool is_contradicted(lock_in_t *self, int32_t difference_um_s2) {
    const int32_t scaled =
        clamp_i32(difference_um_s2 >> self->shift, -LARGEST_SCALED, LARGEST_SCALED);
    const int32_t memory_q16 = (int32_t)self->memory_q16;
    self->slow_q8 += (int32_t)(((int64_t)(scaled * 256 - self->slow_q8) * (2 * memory_q16)) >> 16);
    const int64_t slow = self->slow_q8 >> 8;
    self->unexplained += ((slow * slow - self->unexplained) * memory_q16) >> 16;
    return self->halves > 0 && self->unexplained > self->power >> CONTRADICTED_SHIFT;
}

static void end_half(lock_in_t *self) {
    self->before = self->last;
    self->last = self->half;
    self->half = (harmonic_sums_t){0};
    self->stage = 1;
}

// Corrects phase and frequency; lets go where the half cycle does not continue the one before it.
static void follow(lock_in_t *self) {
    const int32_t *part = self->found.um_s2;
    const uint32_t amp_um_s2 = harmonic_amp_um_s2(part[HARMONIC_COS1], part[HARMONIC_SIN1]);
    const int32_t angle =
        (int32_t)(0u - harmonic_peak_turn(part[HARMONIC_COS1], part[HARMONIC_SIN1]));
    if (abs_i32(angle) > LOST_ANGLE_TURN || amp_um_s2 < self->amp_um_s2 / 4u) {
        lock_in_release(self);
        return;
    }
    self->phase_turn += (uint32_t)(angle / 2);
    self->step_turn += (uint32_t)(angle / 5 / (int32_t)self->last.ticks);
    self->memory_q16 = quarter_cycle_q16(self->step_turn);
    expect(self, amp_um_s2, &self->found);
    if (self->halves == 0) {
        self->slow_q8 = 0; // only now it is known what to expect
        self->unexplained = 0;
    }
    self->halves = increment_sat_u32(self->halves);
    self->has_half = true;
}

// Both one half cycle, or both two (where a half cycle is shorter than the work on it).
static bool are_alike(uint32_t a, uint32_t b) {
    return a != 0 && gap_u32(a, b) <= 1u + b / 8u;
}

// Works on the last half cycle, one part a tick, so that no tick has much of it.
static void work(lock_in_t *self) {
    const uint32_t stage = self->stage;
    self->stage = (uint8_t)(stage == LAST_STAGE ? 0 : stage + 1u);
    if (stage <= HARMONIC_PRODUCTS) {
        self->found.um_s2[stage - 1u] = harmonic_part_um_s2(&self->last, stage - 1u);
    } else if (stage < LAST_STAGE) {
        // Halves of one cycle: what is left of both is not the component's.
        if (are_alike(self->before.ticks, self->last.ticks)) {
            harmonic_sums_add(&self->before, &self->last);
            self->mean_um_s2 += harmonic_mean_um_s2(&self->before) / 2;
        }
    } else {
        follow(self);
    }
}

void lock_in_step(lock_in_t *self, int32_t accel_um_s2, bool is_good, bool may_work) {
    self->has_half = false;
    if (!self->is_locked) {
        return;
    }
    self->phase_turn += self->step_turn;
    self->half_turn += 2u * self->step_turn;
    const harmonic_wave_t one = harmonic_wave(self->phase_turn);
    const harmonic_wave_t three = harmonic_wave(3u * self->phase_turn);
    const int32_t expected = harmonic_at_um_s2(&self->expected, one, three);
    const int32_t accel = is_good ? accel_um_s2 - self->mean_um_s2 : expected;
    harmonic_sums_take(&self->half, accel, one, three);
    if (is_contradicted(self, accel - expected)) {
        lock_in_release(self);
    } else if (self->half_turn < 2u * self->step_turn && self->stage == 0) {
        end_half(self);
    } else if (self->stage != 0 && may_work) {
        work(self);
    }
}

void lock_in_skip(lock_in_t *self, uint32_t ticks) {
    if (ticks > LOCK_IN_MOST_SKIPPED) {
        lock_in_release(self);
        return;
    }
    for (uint32_t i = 0; i < ticks; i++) {
        lock_in_step(self, 0, false, true);
    }
}
