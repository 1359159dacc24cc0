/// One damper's current: watched, guarded, commanded.
#ifndef DRIVE_H
#define DRIVE_H

#include "current_monitor.h"
#include "guard.h"
#include "quiesce.h"
#include "quiesce_board.h"
#include "view.h"

typedef struct {
    guard_t guard;
    current_monitor_t monitor;
    int32_t ceiling_mA;
    int32_t last_command_mA; ///< that the driver is expected to make
} drive_t;

/// Starts at the safe current. Parameters that were refused leave its limits within their ranges.
void drive_init(drive_t *self, const quiesce_board_damper_t *damper, const quiesce_params_t *params,
                bool is_accepted);

/// A tick's measurement against the command that was in force. Returns the current in the coil, mA:
/// measured, within VIEW_LIMIT, else as command and lag say.
static inline int32_t drive_watch(drive_t *self, const quiesce_driver_t *driver,
                                  current_verdict_t *verdict) {
    *verdict = current_monitor_step(&self->monitor, self->last_command_mA, driver->current_mA,
                                    driver->is_measured);
    return driver->is_measured ? clamp_i32(driver->current_mA, -VIEW_LIMIT, VIEW_LIMIT)
                               : current_monitor_expected_mA(&self->monitor);
}

/// The command: what is requested, limited, where it is allowed, else the safe current. Whatever
/// the guard's own state, it is between 0 and the board's ceiling.
static inline void drive_command(drive_t *self, int32_t request_mA, bool is_allowed,
                                 bool driver_enable, quiesce_command_t *out) {
    const int32_t guarded_mA = guard_step(&self->guard, request_mA, is_allowed);
    out->current_cmd_mA = clamp_i32(guarded_mA, 0, self->ceiling_mA);
    out->driver_enable = driver_enable;
    // A driver that is switched off is expected to carry nothing.
    self->last_command_mA = driver_enable ? out->current_cmd_mA : 0;
}

/// What it has last commanded, mA.
static inline int32_t drive_current_cmd_mA(const drive_t *self) {
    return clamp_i32(self->guard.last_uA / 1000, 0, self->ceiling_mA);
}

#endif
