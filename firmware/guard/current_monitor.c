#include "current_monitor.h"

void current_monitor_init(current_monitor_t *self, const current_monitor_cfg_t *cfg,
                          int32_t initial_mA) {
    // Backward Euler of the lag: 1 / (1 + lag in ticks).
    const int64_t lag_milliticks = (int64_t)cfg->lag_us * cfg->tick_rate_Hz / 1000;
    *self = (current_monitor_t){
        .cfg = *cfg,
        .lag_gain_q16 = (int32_t)(INT64_C(65536000) / (1000 + lag_milliticks)),
        .expected_mA_q16 = (int64_t)initial_mA * 65536,
    };
}

void current_monitor_reset(current_monitor_t *self) {
    self->wrong_ticks = 0;
    self->missing_ticks = 0;
}

static current_verdict_t judge(const current_monitor_t *self, int32_t expected_mA,
                               int32_t measured_mA) {
    if (self->missing_ticks >= self->cfg.fault_ticks) {
        return CURRENT_MISSING;
    }
    if (self->wrong_ticks < self->cfg.fault_ticks) {
        return CURRENT_OK;
    }
    const bool is_open =
        expected_mA >= 2 * self->cfg.error_mA && abs_i32(measured_mA) < self->cfg.error_mA / 2;
    return is_open ? CURRENT_OPEN_COIL : CURRENT_NOT_FOLLOWING;
}

current_verdict_t current_monitor_step(current_monitor_t *self, int32_t command_mA,
                                       int32_t measured_mA, bool is_measured) {
    const int64_t step_q16 = (int64_t)command_mA * 65536 - self->expected_mA_q16;
    self->expected_mA_q16 += step_q16 * self->lag_gain_q16 >> 16;
    if (!self->cfg.is_on) {
        return CURRENT_OK;
    }
    const int32_t expected_mA = (int32_t)(self->expected_mA_q16 >> 16);
    self->missing_ticks = is_measured ? 0 : increment_sat_u32(self->missing_ticks);
    if (is_measured) {
        const int64_t error_mA = (int64_t)measured_mA - expected_mA;
        const bool is_wrong = error_mA > self->cfg.error_mA || -error_mA > self->cfg.error_mA;
        self->wrong_ticks = is_wrong ? increment_sat_u32(self->wrong_ticks) : 0;
    }
    return judge(self, expected_mA, measured_mA);
}
