#include "current_monitor.h"

#include "at_start.h"

// What a bad tick adds; a good one takes 1 away.
#define WRONG_ADDS 4u
#define OVER_ADDS 8u

// Backward Euler of the lag: 1 / (1 + lag in ticks).
static int32_t gain_q30(uint32_t milliticks) {
    return (int32_t)((65536000u / (1000u + milliticks)) << 14);
}

// In ticks, rounded up.
static uint32_t dead_ticks(uint32_t tick_rate_Hz) {
    const uint32_t ticks = (CURRENT_DEAD_MS * tick_rate_Hz + 999u) / 1000u;
    return ticks < CURRENT_DEAD_TICKS ? ticks : CURRENT_DEAD_TICKS;
}

AT_START void current_monitor_init(current_monitor_t *self, const current_monitor_cfg_t *cfg) {
    const uint32_t milliticks = (uint32_t)cfg->lag_us * cfg->tick_rate_Hz / 1000u;
    *self = (current_monitor_t){0};
    self->error_mA = cfg->error_mA;
    self->fault_ticks = cfg->fault_ticks;
    self->trip_mA = cfg->trip_mA > 0 ? cfg->trip_mA : INT32_MAX;
    self->over_limit = cfg->trip_mA > 0 ? cfg->trip_ticks * OVER_ADDS : UINT32_MAX;
    self->early.gain_q30 = gain_q30(milliticks / 2u);
    self->late.gain_q30 = gain_q30(milliticks * 2u);
    self->last = dead_ticks(cfg->tick_rate_Hz) - 1u;
    self->is_checked = cfg->check != CURRENT_CHECK_NEVER;
    self->is_missed = cfg->check == CURRENT_CHECK_ALWAYS;
}

void current_monitor_reset(current_monitor_t *self) {
    self->wrong = 0;
    self->was_wrong = false;
    self->missing_ticks = 0;
    self->over = 0;
}

void current_monitor_follow(current_monitor_t *self, int32_t measured_mA) {
    const int32_t settled_mA = clamp_i32(measured_mA, -CURRENT_MOST_mA, CURRENT_MOST_mA);
    self->early.mA_q14 = settled_mA * 16384;
    self->late.mA_q14 = settled_mA * 16384;
    for (uint32_t i = 0; i < CURRENT_DEAD_TICKS; i++) {
        self->before_mA[i] = (uint16_t)clamp_i32(settled_mA, 0, CURRENT_MOST_mA);
    }
    self->wrong = 0;
    self->was_wrong = false;
    self->missing_ticks = 0;
}

// At the most a tick beyond the limit: what was bad for hours is not held against it for hours.
static uint32_t leak(uint32_t count, bool is_bad, uint32_t adds, uint32_t limit) {
    if (!is_bad) {
        return count - (count > 0u ? 1u : 0u);
    }
    return count < limit ? count + adds : count;
}

static current_verdict_t judge(const current_monitor_t *self, int32_t measured_mA) {
    if (self->over >= self->over_limit) {
        return CURRENT_OVER;
    }
    if (self->missing_ticks >= self->fault_ticks) {
        return CURRENT_MISSING;
    }
    if (self->wrong < self->fault_ticks * WRONG_ADDS) {
        return CURRENT_OK;
    }
    const int32_t none_mA = self->error_mA >> 1;
    const bool is_open = current_monitor_expected_mA(self) >= 2 * self->error_mA &&
                         measured_mA < none_mA && measured_mA > -none_mA;
    return is_open ? CURRENT_OPEN_COIL : CURRENT_NOT_FOLLOWING;
}

static void follow(current_lag_t *lag, int32_t command_mA) {
    const int32_t step_q14 = command_mA * 16384 - lag->mA_q14;
    lag->mA_q14 += (int32_t)((int64_t)step_q14 * lag->gain_q30 >> 32) * 4;
}

static void expect(current_monitor_t *self, uint16_t command_mA) {
    follow(&self->late, self->before_mA[self->oldest]);
    follow(&self->early, command_mA);
    self->before_mA[self->oldest] = command_mA;
    self->oldest = self->oldest > 0u ? self->oldest - 1u : self->last;
}

// By more than the error above the highest, or below the lowest of what may flow.
static bool is_wrong(const current_monitor_t *self, int32_t measured_mA) {
    const int32_t early = self->early.mA_q14;
    const int32_t late = self->late.mA_q14;
    const int32_t highest_mA = (early > late ? early : late) >> 14;
    const int32_t lowest_mA = (early > late ? late : early) >> 14;
    return measured_mA > highest_mA + self->error_mA || measured_mA < lowest_mA - self->error_mA;
}

static bool is_over(const current_monitor_t *self, int32_t measured_mA) {
    return measured_mA > self->trip_mA || measured_mA < -self->trip_mA;
}

static void weigh(current_monitor_t *self, int32_t measured_mA, bool is_new) {
    self->is_missed = self->is_checked;
    self->missing_ticks = 0;
    self->over = leak(self->over, is_over(self, measured_mA), OVER_ADDS, self->over_limit);
    if (self->is_checked) {
        const bool is_bad = is_new ? is_wrong(self, measured_mA) : self->was_wrong;
        self->was_wrong = is_bad;
        self->wrong = leak(self->wrong, is_bad, WRONG_ADDS, self->fault_ticks * WRONG_ADDS);
    }
}

current_verdict_t current_monitor_step(current_monitor_t *self, uint16_t command_mA,
                                       int32_t measured_mA, current_measured_t measured) {
    expect(self, command_mA);
    if (measured != CURRENT_NONE) {
        weigh(self, measured_mA, measured == CURRENT_NEW);
    } else if (self->is_missed) {
        self->missing_ticks = increment_sat_u32(self->missing_ticks);
    }
    return judge(self, measured_mA);
}
