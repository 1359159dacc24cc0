#include "heat.h"

#include "quiesce_board.h"

#define TENTH_BITS 15u

static int64_t square_q20(int32_t current_mA, int32_t round_up) {
    const int32_t value_mA =
        clamp_i32(current_mA, -QUIESCE_HIGHEST_CURRENT_mA * 2, QUIESCE_HIGHEST_CURRENT_mA * 2);
    return ((int64_t)value_mA * value_mA + round_up) / 16 * (1 << 20);
}

void heat_init(heat_t *self, const heat_cfg_t *cfg) {
    const int64_t square = square_q20(cfg->continuous_mA, 0);
    const int64_t budget = square > 0 ? square : 1 << 20;
    const int64_t tenth = budget / 10;
    const uint32_t bits = 64u - leading_zeros_u64((uint64_t)tenth);
    *self = (heat_t){
        .heat_q20 = budget / 2,
        .budget_q20 = budget,
        .gain_q32 = (uint32_t)((INT64_C(1) << 32) / ((int64_t)cfg->time_s * cfg->tick_rate_Hz)),
        .shift = bits > TENTH_BITS ? bits - TENTH_BITS : 0u,
        .continuous_mA = cfg->continuous_mA,
    };
    self->tenth = (uint32_t)(tenth >> self->shift);
}

void heat_step(heat_t *self, int32_t current_mA) {
    // Q2: 35 bits, times 24 bits of gain.
    const int64_t difference_q2 = (square_q20(current_mA, 15) - self->heat_q20) >> 18;
    self->heat_q20 += (difference_q2 * self->gain_q32 + ((1 << 14) - 1)) >> 14;
}

int32_t heat_limit_mA(const heat_t *self, int32_t ceiling_mA) {
    const int64_t left_q20 = self->budget_q20 - self->heat_q20;
    if (!heat_is_near_budget(self)) {
        return ceiling_mA;
    }
    if (left_q20 <= 0) {
        return self->continuous_mA;
    }
    const uint32_t left = (uint32_t)(left_q20 >> self->shift); // at most self->tenth + 1
    const uint32_t extra_mA = (uint32_t)(ceiling_mA - self->continuous_mA);
    return self->continuous_mA + (int32_t)(extra_mA * left / self->tenth);
}
