#include "drive.h"

#include <stddef.h>

#include "at_start.h"

#define RATE_IF_REFUSED_Hz 1000u
// What alone of the limits changes from tick to tick.
#define LAST_WORD (offsetof(drive_limits_t, guard.last_uA) / sizeof(uint32_t))

// Of a deviation; beyond half of what the damper may get nothing would be one.
static int32_t error_mA(const guard_t *guard, const quiesce_params_t *p) {
    const int32_t half_mA = guard->max_mA / 2;
    return clamp_i32(p->current_error_mA, 1, half_mA > 1 ? half_mA : 1);
}

static uint32_t at_least_one(uint32_t ticks) {
    return ticks > 0u ? ticks : 1u;
}

static void start_guard(guard_t *self, const quiesce_board_damper_t *damper,
                        const quiesce_params_t *p, uint32_t rate_Hz) {
    const bool is_lower = p->max_current_mA < damper->ceiling_mA;
    guard_init(self, &(guard_cfg_t){
                         .max_mA = is_lower ? p->max_current_mA : damper->ceiling_mA,
                         .safe_mA = damper->safe_mA,
                         .slew_mA_s = p->slew_mA_s,
                         .tick_rate_Hz = rate_Hz,
                     });
}

static void start_monitor(drive_t *self, const quiesce_board_damper_t *damper,
                          const quiesce_params_t *p, uint32_t rate_Hz, current_check_t check) {
    const current_monitor_cfg_t monitor = {
        .check = check,
        .tick_rate_Hz = rate_Hz,
        .error_mA = error_mA(&self->limits.guard, p),
        .lag_us = damper->coil_lag_us,
        .fault_ticks = (uint32_t)p->current_fault_ticks,
        .trip_mA = damper->trip_mA,
        .trip_ticks = at_least_one(ticks_in_us(damper->trip_us, rate_Hz)),
    };
    current_monitor_init(&self->monitor, &monitor);
}

// A lower limit takes a slice and two ticks until it counts; then the command falls by its slew,
// and the current by the coil's lag behind it.
static void start_heat(drive_t *self, uint32_t number, const quiesce_board_damper_t *damper,
                       const quiesce_params_t *p, uint32_t rate_Hz) {
    const int32_t highest_mA = self->limits.guard.max_mA;
    const int32_t slew_mA_s = p->slew_mA_s > 1000 ? p->slew_mA_s : 1000; // as accepted ones are
    const int64_t ramp_us = (int64_t)highest_mA * 1000000 / slew_mA_s;
    heat_init(&self->heat, &(heat_cfg_t){
                               .tick_rate_Hz = rate_Hz,
                               .continuous_mA = damper->continuous_mA,
                               .highest_mA = highest_mA,
                               .time_s = damper->heat_s,
                               .settle_us = (uint32_t)ramp_us + (uint32_t)damper->coil_lag_us +
                                            (HEAT_SLICE_TICKS + 2u) * 1000000u / rate_Hz,
                               .first_ticks = 1u + number * HEAT_SLICE_TICKS / QUIESCE_DAMPERS,
                           });
}

AT_START void drive_init(drive_t *self, uint32_t number, const quiesce_board_damper_t *damper,
                         const quiesce_params_t *p, bool is_accepted) {
    const uint32_t rate_Hz = is_accepted ? (uint32_t)p->tick_rate_Hz : RATE_IF_REFUSED_Hz;
    self->limits.ceiling_mA = damper->ceiling_mA;
    start_guard(&self->limits.guard, damper, p, rate_Hz);
    start_monitor(self, damper, p, rate_Hz,
                  is_accepted ? (current_check_t)damper->measures_current : CURRENT_CHECK_NEVER);
    if (DRIVE_SEES_COIL) {
        coil_init(&self->coil, damper->coil_mohm, self->monitor.error_mA,
                  self->monitor.fault_ticks);
        energy_init(&self->energy, rate_Hz);
    }
    start_heat(self, number, damper, p, rate_Hz);
    self->last_command_mA = 0; // the driver is off until the first tick
    twin_make(&self->limits, WORDS_OF(drive_limits_t), self->twin);
}

// What current and voltage together say of the coil.
static current_verdict_t judge_coil(drive_t *self, int32_t current_mA, int32_t voltage_mV,
                                    current_verdict_t verdict) {
    const bool is_short = coil_is_short(&self->coil, self->last_command_mA, current_mA, voltage_mV);
    if (verdict == CURRENT_OPEN_COIL &&
        !coil_is_open(&self->coil, current_monitor_expected_mA(&self->monitor), voltage_mV)) {
        return CURRENT_NOT_FOLLOWING;
    }
    return verdict == CURRENT_OK && is_short ? CURRENT_SHORT : verdict;
}

int32_t drive_watch(drive_t *self, const quiesce_driver_t *driver, const int32_t *voltage_mV,
                    current_verdict_t *verdict) {
    const current_measured_t measured = !driver->is_measured ? CURRENT_NONE
                                        : driver->is_old     ? CURRENT_OLD
                                                             : CURRENT_NEW;
    *verdict =
        current_monitor_step(&self->monitor, self->last_command_mA, driver->current_mA, measured);
    if (DRIVE_SEES_COIL && voltage_mV != NULL && driver->is_measured) {
        *verdict = judge_coil(self, driver->current_mA, *voltage_mV, *verdict);
    }
    const int32_t current_mA = driver->is_measured
                                   ? clamp_i32(driver->current_mA, -VIEW_LIMIT, VIEW_LIMIT)
                                   : current_monitor_expected_mA(&self->monitor);
    heat_step(&self->heat, current_mA);
    if (*verdict == CURRENT_OK && heat_is_excessive(&self->heat)) {
        *verdict = CURRENT_HOT;
    }
    return current_mA;
}

void drive_forget(drive_t *self) {
    current_monitor_reset(&self->monitor);
    if (DRIVE_SEES_COIL) {
        self->coil.bad = 0;
        energy_forget(&self->energy);
    }
}

static void take(drive_t *self, int32_t command_mA, bool driver_enable, quiesce_command_t *out) {
    *out = (quiesce_command_t){.current_cmd_mA = command_mA, .driver_enable = driver_enable};
    // A driver that is switched off is expected to carry nothing.
    self->last_command_mA = driver_enable ? (uint16_t)command_mA : 0u; // at most its ceiling
}

void drive_command(drive_t *self, int32_t request_mA, bool is_allowed, bool driver_enable,
                   quiesce_command_t *out) {
    const int32_t cool_mA = heat_limit_mA(&self->heat);
    const int32_t wanted_mA = request_mA < cool_mA ? request_mA : cool_mA;
    const uint32_t before_uA = (uint32_t)self->limits.guard.last_uA;
    const int32_t guarded_mA = guard_step(&self->limits.guard, wanted_mA, is_allowed);
    take(self, clamp_i32(guarded_mA, 0, self->limits.ceiling_mA), driver_enable, out);
    twin_replace(self->twin, WORDS_OF(drive_limits_t), LAST_WORD, before_uA,
                 (uint32_t)self->limits.guard.last_uA);
}

void drive_hold(drive_t *self, const quiesce_driver_t *driver, quiesce_command_t *out) {
    if (!out->driver_enable) {
        return; // nothing flows in it, as ever, or the self-test fails
    }
    out->driver_enable = false;
    self->last_command_mA = 0;
    self->coil.bad = 0;
    current_monitor_follow(
        &self->monitor,
        driver->is_measured ? clamp_i32(driver->current_mA, -VIEW_LIMIT, VIEW_LIMIT) : 0);
}

void drive_shut(drive_t *self, quiesce_command_t *out) {
    take(self, 0, false, out);
}
