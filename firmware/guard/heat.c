#include "heat.h"

#include "at_start.h"
#include "quiesce_board.h"

#define Q20 (INT64_C(1) << 20)
#define LINE_BITS 15u
#define EXCESS_Q20 (3 * Q20)

// mA^2 / 16, down.
static int64_t square_q20(int32_t current_mA) {
    return (int64_t)current_mA * current_mA / 16 * Q20;
}

int64_t heat_budget_q20(const heat_t *self) {
    const int64_t square = square_q20(self->continuous_mA);
    return square > 0 ? square : Q20;
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
    const int64_t tenth_q20 = heat_budget_q20(self) / 10;
    const int64_t line_q20 = slow_q20 > tenth_q20 ? slow_q20 : tenth_q20;
    const uint32_t bits = 64u - leading_zeros_u64((uint64_t)line_q20);
    self->shift = (uint8_t)(bits > LINE_BITS ? bits - LINE_BITS : 0u);
    self->line = (uint16_t)(line_q20 >> self->shift);
}

static int32_t limit_mA(const heat_t *self, int64_t left_q20) {
    if (self->highest_mA <= self->continuous_mA || left_q20 >= (int64_t)self->line << self->shift) {
        return self->highest_mA;
    }
    const int32_t lowest_mA = self->continuous_mA - self->continuous_mA / 64 - 1;
    const uint32_t extra_mA = (uint32_t)(self->highest_mA - lowest_mA);
    const uint32_t left = left_q20 > 0 ? (uint32_t)(left_q20 >> self->shift) : 0u; // below line
    return lowest_mA + (int32_t)(extra_mA * left / self->line);
}

void heat_resume(heat_t *self, int64_t heat_q20) {
    const int64_t budget_q20 = heat_budget_q20(self);
    self->heat_q20 = heat_q20;
    self->limit_mA = (uint16_t)limit_mA(self, budget_q20 - heat_q20);
    self->is_excessive = heat_q20 > budget_q20 + budget_q20 / 16 + EXCESS_Q20;
}

AT_START void heat_init(heat_t *self, const heat_cfg_t *cfg) {
    const int64_t ticks = (int64_t)cfg->time_s * cfg->tick_rate_Hz;
    *self = (heat_t){0};
    self->gain_q32 = (uint32_t)((INT64_C(1) << 32) * HEAT_SLICE_TICKS / ticks);
    self->continuous_mA = (uint16_t)cfg->continuous_mA;
    self->highest_mA = (uint16_t)cfg->highest_mA;
    self->line = 1;
    self->left_ticks = (uint8_t)cfg->first_ticks;
    if (cfg->highest_mA > cfg->continuous_mA) {
        start_line(self, cfg);
    }
    heat_resume(self, heat_budget_q20(self) / 2);
}

static void end_slice(heat_t *self) {
    // Of HEAT_SLICE_TICKS (mA/2)^2. Q2: 35 bits, times 25 bits of gain.
    const int64_t mean_q20 = self->sum * (Q20 / (HEAT_SLICE_TICKS * 4 * 16));
    const int64_t difference_q2 = (mean_q20 - self->heat_q20) >> 18;
    self->sum = 0;
    self->left_ticks = HEAT_SLICE_TICKS;
    heat_resume(self, self->heat_q20 + ((difference_q2 * self->gain_q32 + ((1 << 14) - 1)) >> 14));
}

void heat_step(heat_t *self, int32_t current_mA) {
    const int32_t most_mA = QUIESCE_HIGHEST_CURRENT_mA * 2;
    const int32_t twice_mA = 2 * abs_i32(clamp_i32(current_mA, -most_mA, most_mA)) + 1;
    self->sum += (int64_t)twice_mA * twice_mA;
    self->left_ticks--;
    if (self->left_ticks == 0u) {
        end_slice(self);
    }
}
