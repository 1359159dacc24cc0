#include "heat.h"

#include "quiesce_board.h"

#define Q20 (INT64_C(1) << 20)
#define LINE_BITS 15u

// mA^2 / 16, down.
static int64_t square_q20(int32_t current_mA) {
    return (int64_t)current_mA * current_mA / 16 * Q20;
}

// The heat that the highest current leaves behind while it settles at the continuous one is at most
// the difference of their squares for that time. Over four times as much the loop of limit, current
// and heat does not swing: its gain times the current's lag is a quarter or less.
static int64_t slow_line_q20(const heat_cfg_t *cfg) {
    const int64_t difference_q20 = square_q20(cfg->highest_mA) - square_q20(cfg->continuous_mA);
    return 4 * (difference_q20 / 1000000 * cfg->settle_us / cfg->time_s);
}

static void start_line(heat_t *self, const heat_cfg_t *cfg) {
    const int64_t slow_q20 = slow_line_q20(cfg);
    const int64_t tenth_q20 = self->budget_q20 / 10;
    const int64_t line_q20 = slow_q20 > tenth_q20 ? slow_q20 : tenth_q20;
    const uint32_t bits = 64u - leading_zeros_u64((uint64_t)line_q20);
    const int32_t lowest_mA = cfg->continuous_mA - cfg->continuous_mA / 64 - 1;
    self->shift = (uint16_t)(bits > LINE_BITS ? bits - LINE_BITS : 0u);
    self->line = (uint16_t)(line_q20 >> self->shift);
    self->lowest_mA = (uint16_t)lowest_mA;
    self->extra_mA = (uint16_t)(cfg->highest_mA - lowest_mA);
}

void heat_init(heat_t *self, const heat_cfg_t *cfg) {
    const int64_t square = square_q20(cfg->continuous_mA);
    const int64_t budget = square > 0 ? square : Q20;
    *self = (heat_t){
        .heat_q20 = budget / 2,
        .budget_q20 = budget,
        .gain_q32 = (uint32_t)((INT64_C(1) << 32) / ((int64_t)cfg->time_s * cfg->tick_rate_Hz)),
        .line = 1,
        .lowest_mA = (uint16_t)cfg->highest_mA,
    };
    if (cfg->highest_mA > cfg->continuous_mA) {
        start_line(self, cfg);
    }
}

void heat_step(heat_t *self, int32_t current_mA) {
    const int32_t most_mA = QUIESCE_HIGHEST_CURRENT_mA * 2;
    const int64_t twice_mA = 2 * (int64_t)abs_i32(clamp_i32(current_mA, -most_mA, most_mA)) + 1;
    const int64_t square = (twice_mA * twice_mA + 63) / 64 * Q20;
    // Q2: 35 bits, times 24 bits of gain.
    const int64_t difference_q2 = (square - self->heat_q20) >> 18;
    self->heat_q20 += (difference_q2 * self->gain_q32 + ((1 << 14) - 1)) >> 14;
}

int32_t heat_limit_mA(const heat_t *self) {
    if (!heat_is_limiting(self)) {
        return self->lowest_mA + self->extra_mA;
    }
    const int64_t left_q20 = self->budget_q20 - self->heat_q20;
    if (left_q20 <= 0) {
        return self->lowest_mA;
    }
    const uint32_t left = (uint32_t)(left_q20 >> self->shift); // at most self->line + 1
    return self->lowest_mA + (int32_t)(self->extra_mA * left / self->line);
}
