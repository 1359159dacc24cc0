/// Compares the measured coil current with what the command should have produced, and with the
/// level at which the driver has to be opened.
///
/// The expectation follows the command through a first-order lag (the coil); a deviation beyond
/// error_mA is a fault after fault_ticks: an open coil where a current of at least twice error_mA
/// is expected and none flows, else a driver that does not follow. A magnitude above trip_mA is
/// one after trip_ticks. These counts are leaky: a good tick takes back a quarter of a bad one, an
/// eighth where it is the trip's, so that no good sample now and then forgives what lasts. Q16 mA
/// inside, floor. Bounded, about 55 instructions.
#ifndef CURRENT_MONITOR_H
#define CURRENT_MONITOR_H

#include "fixq.h"

typedef enum {
    CURRENT_OK = 0,
    CURRENT_NOT_FOLLOWING = 1,
    CURRENT_OPEN_COIL = 2,
    CURRENT_MISSING = 3, ///< no measurement for fault_ticks
    CURRENT_OVER = 4,    ///< above trip_mA
    CURRENT_HOT = 5,     ///< the coil is beyond its budget of heat (heat.h)
    CURRENT_SHORT = 6,   ///< the coil is short (coil.h)
} current_verdict_t;

/// When missing and wrong measurements are faults. Those above the trip level always are.
typedef enum {
    CURRENT_CHECK_NEVER = 0,
    CURRENT_CHECK_ALWAYS = 1,
    CURRENT_CHECK_ONCE_SEEN = 2, ///< from the first measurement on
} current_check_t;

typedef struct {
    current_check_t check;
    uint32_t tick_rate_Hz;
    int32_t error_mA;
    int32_t lag_us;
    uint32_t fault_ticks;
    int32_t trip_mA; ///< 0: no trip
    uint32_t trip_ticks;
} current_monitor_cfg_t;

typedef struct {
    int32_t error_mA;
    uint32_t fault_ticks;
    int32_t trip_mA;
    uint32_t trip_ticks;
    int32_t lag_gain_q16; ///< share of the step that the coil takes in a tick
    int64_t expected_mA_q16;
    uint32_t wrong;         ///< leaky
    uint32_t over;          ///< leaky
    uint32_t missing_ticks; ///< in a row
    bool is_on;
    bool is_on_once_seen;
} current_monitor_t;

void current_monitor_init(current_monitor_t *self, const current_monitor_cfg_t *cfg,
                          int32_t initial_mA);

/// Verdict after this tick's measurement. command_mA is the command that was in force up to now.
current_verdict_t current_monitor_step(current_monitor_t *self, int32_t command_mA,
                                       int32_t measured_mA, bool is_measured);

/// Whether nothing has been wrong for as long as what was is remembered.
static inline bool current_monitor_is_quiet(const current_monitor_t *self) {
    const bool is_over = self->trip_mA > 0 && self->over > 0u;
    return self->wrong == 0u && !is_over && self->missing_ticks == 0u;
}

/// What should flow now, mA.
static inline int32_t current_monitor_expected_mA(const current_monitor_t *self) {
    return (int32_t)(self->expected_mA_q16 >> 16);
}

/// Forgets runs of deviations (a latched fault has been acknowledged).
void current_monitor_reset(current_monitor_t *self);

/// Of a driver that is kept off: what is measured is what is expected from here on, and nothing was
/// wrong with it. Within 1,000,000,000 mA.
void current_monitor_follow(current_monitor_t *self, int32_t measured_mA);

#endif
