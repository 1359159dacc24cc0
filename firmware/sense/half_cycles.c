#include "half_cycles.h"

enum {
    TICK_q8 = 256,
    LONGEST_q8 = 1 << 21, // two seconds at the fastest tick
    ALIKE = 8,            // one part in ..
    BEYOND = 8,           // of the last peak
};

void half_cycles_reset(half_cycles_t *self) {
    *self = (half_cycles_t){.last_um_s = self->last_um_s, .is_up = self->last_um_s > 0};
}

static bool are_alike(uint32_t a, uint32_t b) {
    return gap_u32(a, b) < a / ALIKE;
}

// The period is that of the middles: unequal halves, from an offset of the velocity, cancel.
static bool is_steady(const half_cycles_t *self, uint32_t length_q8) {
    const uint32_t first_q8 = self->earlier_q8 + self->before_q8;
    const uint32_t second_q8 = self->before_q8 + length_q8;
    return self->earlier_q8 != 0 && are_alike(first_q8, second_q8) &&
           (length_q8 > self->before_q8 / 2u) && (self->before_q8 > length_q8 / 2u);
}

// The velocity has crossed zero since_q8 ago, after a half cycle of length_q8.
static bool end_half(half_cycles_t *self, uint32_t length_q8, half_cycles_tone_t *tone) {
    const bool is_found = is_steady(self, length_q8);
    self->alike = (uint8_t)(!is_found ? 0 : self->alike < UINT8_MAX ? self->alike + 1u : UINT8_MAX);
    if (is_found) {
        *tone = (half_cycles_tone_t){
            .period_q8 = (self->earlier_q8 + 2u * self->before_q8 + length_q8) / 2u,
            .since_q8 = self->since_q8,
            .is_up = self->is_up,
            .alike = self->alike,
        };
    }
    self->earlier_q8 = self->before_q8;
    self->before_q8 = length_q8;
    self->peak_um_s = 0;
    return is_found;
}

uint32_t half_cycles_step_turn(const half_cycles_tone_t *tone) {
    return (uint32_t)((UINT64_C(1) << 40) / tone->period_q8);
}

uint32_t half_cycles_phase_turn(const half_cycles_tone_t *tone, uint32_t step_turn) {
    return (uint32_t)(((uint64_t)step_turn * tone->since_q8) >> 8) +
           (tone->is_up ? 0u : 0x80000000u);
}

// Ticks since the crossing between the last sample and this one, Q8, 0 .. 256.
static uint32_t crossing_q8(int32_t last, int32_t now) {
    const int64_t span = (int64_t)now - last;
    return span == 0 ? 0 : (uint32_t)(((int64_t)now * TICK_q8) / span);
}

static void pass(half_cycles_t *self, uint32_t ticks) {
    self->since_q8 += self->since_q8 < LONGEST_q8 ? TICK_q8 * ticks : 0;
}

void half_cycles_skip(half_cycles_t *self, uint32_t ticks) {
    pass(self, ticks);
}

bool half_cycles_step(half_cycles_t *self, int32_t velocity_um_s, half_cycles_tone_t *tone) {
    const int32_t last_um_s = self->last_um_s;
    self->last_um_s = velocity_um_s;
    pass(self, 1u);
    const int32_t size_um_s = abs_i32(velocity_um_s);
    if ((velocity_um_s > 0) == self->is_up) {
        self->is_rough = false;
        self->peak_um_s = size_um_s > self->peak_um_s ? size_um_s : self->peak_um_s;
        return false;
    }
    if (!self->is_rough) {
        self->is_rough = true;
        self->rough_q8 = self->since_q8 - crossing_q8(last_um_s, velocity_um_s);
    }
    if (size_um_s < self->peak_um_s / BEYOND) {
        return false;
    }
    const uint32_t length_q8 = self->rough_q8;
    self->since_q8 -= length_q8;
    self->is_up = velocity_um_s > 0;
    self->is_rough = false;
    return end_half(self, length_q8, tone);
}
