#include "current_monitor.h"

// What a bad tick adds; a good one takes 1 away.
#define WRONG_ADDS 4u
#define OVER_ADDS 8u

void current_monitor_init(current_monitor_t *self, const current_monitor_cfg_t *cfg,
                          int32_t initial_mA) {
    // Backward Euler of the lag: 1 / (1 + lag in ticks).
    const uint32_t lag_milliticks = (uint32_t)cfg->lag_us * cfg->tick_rate_Hz / 1000u;
    *self = (current_monitor_t){
        .error_mA = cfg->error_mA,
        .fault_ticks = cfg->fault_ticks,
        .trip_mA = cfg->trip_mA,
        .trip_ticks = cfg->trip_ticks,
        .lag_gain_q16 = (int32_t)(65536000u / (1000u + lag_milliticks)),
        .expected_mA_q16 = (int64_t)initial_mA * 65536,
        .is_on = cfg->check == CURRENT_CHECK_ALWAYS,
        .is_on_once_seen = cfg->check == CURRENT_CHECK_ONCE_SEEN,
    };
}

void current_monitor_reset(current_monitor_t *self) {
    self->wrong = 0;
    self->missing_ticks = 0;
    self->over = 0;
}

void current_monitor_follow(current_monitor_t *self, int32_t measured_mA) {
    self->expected_mA_q16 = (int64_t)measured_mA * 65536;
    self->wrong = 0;
    self->missing_ticks = 0;
}

// At the most a tick beyond the limit: what was bad for hours is not held against it for hours.
static uint32_t leak(uint32_t count, bool is_bad, uint32_t adds, uint32_t limit) {
    if (!is_bad) {
        return count > 0u ? count - 1u : 0u;
    }
    return count < limit ? count + adds : count;
}

static current_verdict_t judge(const current_monitor_t *self, int32_t expected_mA,
                               int32_t measured_mA) {
    const uint32_t most = self->fault_ticks * WRONG_ADDS;
    if (self->trip_mA > 0 && self->over >= self->trip_ticks * OVER_ADDS) {
        return CURRENT_OVER;
    }
    if (self->missing_ticks >= self->fault_ticks) {
        return CURRENT_MISSING;
    }
    if (self->wrong < most) {
        return CURRENT_OK;
    }
    const bool is_open =
        expected_mA >= 2 * self->error_mA && abs_i32(measured_mA) < self->error_mA / 2;
    return is_open ? CURRENT_OPEN_COIL : CURRENT_NOT_FOLLOWING;
}

static bool is_off_by_more(int32_t a_mA, int32_t b_mA, int32_t error_mA) {
    const int64_t difference_mA = (int64_t)a_mA - b_mA;
    return difference_mA > error_mA || -difference_mA > error_mA;
}

current_verdict_t current_monitor_step(current_monitor_t *self, int32_t command_mA,
                                       int32_t measured_mA, bool is_measured) {
    const int64_t step_q16 = (int64_t)command_mA * 65536 - self->expected_mA_q16;
    self->expected_mA_q16 += step_q16 * self->lag_gain_q16 >> 16;
    const int32_t expected_mA = (int32_t)(self->expected_mA_q16 >> 16);
    const uint32_t most = self->fault_ticks * WRONG_ADDS;
    if (is_measured) {
        self->is_on = self->is_on || self->is_on_once_seen;
        self->over = leak(self->over, is_off_by_more(measured_mA, 0, self->trip_mA), OVER_ADDS,
                          self->trip_ticks * OVER_ADDS);
    }
    if (self->is_on) {
        self->missing_ticks = is_measured ? 0u : increment_sat_u32(self->missing_ticks);
    }
    if (self->is_on && is_measured) {
        self->wrong = leak(self->wrong, is_off_by_more(measured_mA, expected_mA, self->error_mA),
                           WRONG_ADDS, most);
    }
    return judge(self, expected_mA, measured_mA);
}
