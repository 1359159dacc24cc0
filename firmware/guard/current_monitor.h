/// Compares the measured coil current with what the command should have produced.
///
/// The expectation follows the command through a first-order lag (the coil); a deviation beyond
/// error_mA for fault_ticks in a row is a fault: an open coil where a current of at least twice
/// error_mA is expected and none flows, else a driver that does not follow. Q16 mA inside, floor.
/// Bounded, about 40 instructions.
#ifndef CURRENT_MONITOR_H
#define CURRENT_MONITOR_H

#include "fixq.h"

typedef enum {
    CURRENT_OK = 0,
    CURRENT_NOT_FOLLOWING = 1,
    CURRENT_OPEN_COIL = 2,
    CURRENT_MISSING = 3, ///< no measurement for fault_ticks
} current_verdict_t;

typedef struct {
    bool is_on;
    uint32_t tick_rate_Hz;
    int32_t error_mA;
    int32_t lag_us;
    uint32_t fault_ticks;
} current_monitor_cfg_t;

typedef struct {
    current_monitor_cfg_t cfg;
    int32_t lag_gain_q16; ///< share of the step that the coil takes in a tick
    int64_t expected_mA_q16;
    uint32_t wrong_ticks;
    uint32_t missing_ticks;
} current_monitor_t;

void current_monitor_init(current_monitor_t *self, const current_monitor_cfg_t *cfg,
                          int32_t initial_mA);

/// Verdict after this tick's measurement. command_mA is the command that was in force up to now.
current_verdict_t current_monitor_step(current_monitor_t *self, int32_t command_mA,
                                       int32_t measured_mA, bool is_measured);

/// What should flow now, mA.
static inline int32_t current_monitor_expected_mA(const current_monitor_t *self) {
    return (int32_t)(self->expected_mA_q16 >> 16);
}

/// Forgets runs of deviations (a latched fault has been acknowledged).
void current_monitor_reset(current_monitor_t *self);

#endif
