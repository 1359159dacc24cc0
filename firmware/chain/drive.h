/// One damper's current: watched, guarded, commanded.
#ifndef DRIVE_H
#define DRIVE_H

#include "coil.h"
#include "current_monitor.h"
#include "energy.h"
#include "guard.h"
#include "heat.h"
#include "quiesce.h"
#include "quiesce_board.h"
#include "twin.h"
#include "view.h"

/// Voltage and force may be measured: one sensor alone is the accelerometer.
#define DRIVE_SEES_COIL (QUIESCE_SENSORS > 1)

/// What no flipped bit may change unseen. Words only.
typedef struct {
    guard_t guard;
    int32_t ceiling_mA;
} drive_limits_t;

typedef struct {
    drive_limits_t limits;
    uint32_t twin[TWIN_WORDS(WORDS_OF(drive_limits_t))];
    uint16_t last_command_mA; ///< that the driver is expected to make
    current_monitor_t monitor;
    coil_t coil;
    energy_t energy;
    heat_t heat;
} drive_t;

/// Starts at the safe current. Parameters that were refused leave its limits within their ranges.
/// number: of the damper.
void drive_init(drive_t *self, uint32_t number, const quiesce_board_damper_t *damper,
                const quiesce_params_t *params, bool is_accepted);

/// A tick's measurement against the command that was in force; voltage_mV: across the coil, NULL
/// where it is not known. Returns the current in the coil, mA: measured, within VIEW_LIMIT, else as
/// command and lag say. It heats the coil.
int32_t drive_watch(drive_t *self, const quiesce_driver_t *driver, const int32_t *voltage_mV,
                    current_verdict_t *verdict);

/// Forgets what was wrong (a latched fault has been acknowledged).
void drive_forget(drive_t *self);

/// Whether the limits still are what they were at the end of the last tick.
static inline bool drive_is_intact(const drive_t *self) {
    return twin_holds(&self->limits, WORDS_OF(drive_limits_t), self->twin);
}

/// Whether heat keeps its current below the highest one.
static inline bool drive_is_limited(const drive_t *self) {
    return heat_is_limiting(&self->heat);
}

/// The command: what is requested, limited by guard and heat, where it is allowed, else the safe
/// current. Whatever the guard's own state, it is between 0 and the board's ceiling.
void drive_command(drive_t *self, int32_t request_mA, bool is_allowed, bool driver_enable,
                   quiesce_command_t *out);

/// The driver is kept off, whatever is commanded; driver: what was measured in this tick.
void drive_hold(drive_t *self, const quiesce_driver_t *driver, quiesce_command_t *out);

/// Nothing that the limits say is believed any more: no current, driver off.
void drive_shut(drive_t *self, quiesce_command_t *out);

/// What it has last commanded, mA.
static inline int32_t drive_current_cmd_mA(const drive_t *self) {
    return clamp_i32(self->limits.guard.last_uA / 1000, 0, self->limits.ceiling_mA);
}

#endif
