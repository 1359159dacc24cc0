#include "lock_in.h"

enum {
    LOST_ANGLE_TURN = 715827883,        // a sixth of a turn
    LAST_STAGE = HARMONIC_PRODUCTS + 2, // the mean, then all the rest
    SCALED_BITS = 16,
    LARGEST_SCALED = 1 << 20,
};

void lock_in_init(lock_in_t *self, uint32_t tick_rate_Hz) {
    *self = (lock_in_t){.tick_rate_Hz = tick_rate_Hz};
}

// 4 f / rate: one over the ticks of a quarter of a cycle.
static uint32_t quarter_cycle_q16(uint32_t step_turn) {
    return step_turn >> 14;
}

// Scaled so that squares of what is expected stay below 2^32, whatever its size.
static void expect(lock_in_t *self, uint32_t amp_um_s2, const harmonic_parts_t *parts) {
    const uint32_t bits = 32u - (uint32_t)__builtin_clz(amp_um_s2 | 1u);
    self->expected = *parts;
    self->amp_um_s2 = amp_um_s2;
    self->shift = bits > SCALED_BITS ? bits - SCALED_BITS : 0;
    int64_t squares = 0;
    for (uint32_t i = 0; i < HARMONIC_PRODUCTS; i++) {
        squares += (int64_t)parts->um_s2[i] * parts->um_s2[i];
    }
    self->power = squares >> (1u + 2u * self->shift);
}

void lock_in_acquire(lock_in_t *self, uint32_t phase_turn, uint32_t step_turn, int32_t amp_um_s2,
                     int32_t mean_um_s2) {
    *self = (lock_in_t){
        .tick_rate_Hz = self->tick_rate_Hz,
        .is_locked = true,
        .phase_turn = phase_turn,
        .step_turn = step_turn,
        .mean_um_s2 = mean_um_s2,
        .memory_q16 = quarter_cycle_q16(step_turn),
    };
    expect(self, (uint32_t)amp_um_s2, &(harmonic_parts_t){.um_s2 = {amp_um_s2, 0, 0, 0}});
}

void lock_in_release(lock_in_t *self) {
    self->is_locked = false;
    self->has_cycle = false;
}

// Slow differences count: fast ones, from harmonics or a higher mode, say nothing of the phase.
static bool is_contradicted(lock_in_t *self, int32_t difference_um_s2) {
    const int32_t scaled =
        clamp_i32(difference_um_s2 >> self->shift, -LARGEST_SCALED, LARGEST_SCALED);
    const int32_t memory_q16 = (int32_t)self->memory_q16;
    self->slow_q8 += (int32_t)(((int64_t)(scaled * 256 - self->slow_q8) * (2 * memory_q16)) >> 16);
    const int64_t slow = self->slow_q8 >> 8;
    self->unexplained += ((slow * slow - self->unexplained) * memory_q16) >> 16;
    return self->cycles > 0 && self->unexplained > self->power >> 1;
}

static void end_cycle(lock_in_t *self) {
    self->last = self->cycle;
    self->cycle = (harmonic_sums_t){0};
    self->stage = 1;
}

// Corrects phase and frequency; lets go where the cycle does not continue the ones before it.
static void follow(lock_in_t *self) {
    const int32_t *part = self->found.um_s2;
    const uint32_t amp_um_s2 = harmonic_amp_um_s2(part[HARMONIC_COS1], part[HARMONIC_SIN1]);
    const int32_t angle = -(int32_t)harmonic_peak_turn(part[HARMONIC_COS1], part[HARMONIC_SIN1]);
    if (abs_i32(angle) > LOST_ANGLE_TURN || amp_um_s2 < self->amp_um_s2 / 4u) {
        lock_in_release(self);
        return;
    }
    self->phase_turn += (uint32_t)(angle / 2);
    self->step_turn += (uint32_t)(angle / 16 / (int32_t)self->last.ticks);
    self->memory_q16 = quarter_cycle_q16(self->step_turn);
    expect(self, amp_um_s2, &self->found);
    if (self->cycles == 0) {
        self->unexplained = 0; // only now it is known what to expect
    }
    self->cycles = increment_sat_u32(self->cycles);
    self->has_cycle = true;
}

// Works on the last cycle, one part a tick, so that no tick has much of it.
static void work(lock_in_t *self) {
    const uint32_t stage = self->stage;
    self->stage = stage == LAST_STAGE ? 0 : stage + 1u;
    if (stage <= HARMONIC_PRODUCTS) {
        self->found.um_s2[stage - 1u] = harmonic_part_um_s2(&self->last, stage - 1u);
    } else if (stage < LAST_STAGE) {
        self->mean_um_s2 += harmonic_mean_um_s2(&self->last);
    } else {
        follow(self);
    }
}

void lock_in_step(lock_in_t *self, int32_t accel_um_s2, bool is_good) {
    self->has_cycle = false;
    if (!self->is_locked) {
        return;
    }
    self->phase_turn += self->step_turn;
    self->cycle_turn += self->step_turn;
    const harmonic_wave_t one = harmonic_wave(self->phase_turn);
    const harmonic_wave_t three = harmonic_wave(3u * self->phase_turn);
    const int32_t expected = harmonic_at_um_s2(&self->expected, one, three);
    const int32_t accel = is_good ? accel_um_s2 - self->mean_um_s2 : expected;
    harmonic_sums_take(&self->cycle, accel, one, three);
    if (is_contradicted(self, accel - expected)) {
        lock_in_release(self);
    } else if (self->cycle_turn < self->step_turn) {
        end_cycle(self);
    } else if (self->stage != 0) {
        work(self);
    }
}
