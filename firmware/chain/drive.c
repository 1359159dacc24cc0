#include "drive.h"

#define RATE_IF_REFUSED_Hz 1000u

// Of a deviation; beyond half of what the damper may get nothing would be one.
static int32_t error_mA(const drive_t *self, const quiesce_params_t *p) {
    const int32_t half_mA = self->guard.cfg.max_mA / 2;
    return clamp_i32(p->current_error_mA, 1, half_mA > 1 ? half_mA : 1);
}

void drive_init(drive_t *self, const quiesce_board_damper_t *damper, const quiesce_params_t *p,
                bool is_accepted) {
    const uint32_t rate_Hz = is_accepted ? (uint32_t)p->tick_rate_Hz : RATE_IF_REFUSED_Hz;
    self->ceiling_mA = damper->ceiling_mA;
    guard_init(&self->guard,
               &(guard_cfg_t){
                   .max_mA = p->max_current_mA < damper->ceiling_mA ? p->max_current_mA
                                                                    : damper->ceiling_mA,
                   .safe_mA = damper->safe_mA,
                   .slew_mA_s = p->slew_mA_s,
                   .tick_rate_Hz = rate_Hz,
               });
    self->last_command_mA = self->guard.cfg.safe_mA;
    const current_monitor_cfg_t monitor = {
        .is_on = is_accepted && damper->measures_current != 0,
        .tick_rate_Hz = rate_Hz,
        .error_mA = error_mA(self, p),
        .lag_us = is_accepted ? damper->coil_lag_us : 0,
        .fault_ticks = (uint32_t)p->current_fault_ticks,
    };
    current_monitor_init(&self->monitor, &monitor, self->last_command_mA);
}
