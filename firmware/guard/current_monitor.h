/// Compares the measured coil current with what the command should have produced, and with the
/// level at which the driver has to be opened.
///
/// What should flow follows the command through a first-order lag (the coil). Nobody knows a coil's
/// lag well, and a driver on a bus hears of the command, and is heard, some milliseconds later:
/// what lies between the currents of half the lag at once and of twice the lag CURRENT_DEAD_MS
/// later follows. A deviation from that beyond error_mA is a fault after fault_ticks: an open coil
/// where a current of at least twice error_mA is expected and none flows, else a driver that does
/// not follow. A magnitude above trip_mA is one after trip_ticks. These counts are leaky: a good
/// tick takes back a quarter of a bad one, an eighth where it is the trip's, so that no good sample
/// now and then forgives what lasts. Q14 mA inside, floor. Bounded, about 70 instructions.
#ifndef CURRENT_MONITOR_H
#define CURRENT_MONITOR_H

#include "fixq.h"

/// From a command to the measurement that shows it, at the most: a tick each way, and what the
/// driver itself takes.
#define CURRENT_DEAD_MS 3u
#define CURRENT_DEAD_TICKS 12u ///< room for as long at the highest rate

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

/// What there is of a measurement in a tick. Between two of a slow driver the last one stands, and
/// what was judged of it: the expectation has gone on meanwhile.
typedef enum {
    CURRENT_NONE = 0,
    CURRENT_NEW = 1,
    CURRENT_OLD = 2,
} current_measured_t;

typedef struct {
    current_check_t check;
    uint32_t tick_rate_Hz;
    int32_t error_mA;
    int32_t lag_us;
    uint32_t fault_ticks;
    int32_t trip_mA; ///< 0: no trip
    uint32_t trip_ticks;
} current_monitor_cfg_t;

/// A current behind a command: currents of +-CURRENT_MOST_mA, as a step between any two fits.
#define CURRENT_MOST_mA 65535

typedef struct {
    int32_t mA_q14;
    int32_t gain_q30; ///< share of the step that it takes in a tick
} current_lag_t;

typedef struct {
    int32_t error_mA;
    uint32_t fault_ticks;
    int32_t trip_mA;     ///< INT32_MAX, beyond a limit that is never reached: no trip
    uint32_t over_limit; ///< of `over`
    current_lag_t early;
    current_lag_t late;
    uint16_t before_mA[CURRENT_DEAD_TICKS]; ///< the last commands, a ring
    uint32_t last;                          ///< place in it: one less than there are
    uint32_t oldest;                        ///< counts down
    uint32_t wrong;                         ///< leaky
    uint32_t over;                          ///< leaky
    uint32_t missing_ticks;                 ///< in a row
    bool is_checked;
    bool is_missed; ///< a tick without a measurement counts: checked always, or once seen
    bool was_wrong; ///< the last new measurement
} current_monitor_t;

/// No current has been commanded; current_monitor_follow where one has.
void current_monitor_init(current_monitor_t *self, const current_monitor_cfg_t *cfg);

/// Verdict after this tick's measurement. command_mA is the command that was in force up to now.
current_verdict_t current_monitor_step(current_monitor_t *self, uint16_t command_mA,
                                       int32_t measured_mA, current_measured_t measured);

/// Whether nothing has been wrong for as long as what was is remembered.
static inline bool current_monitor_is_quiet(const current_monitor_t *self) {
    return self->wrong == 0u && self->over == 0u && self->missing_ticks == 0u;
}

/// What should flow now at the earliest, mA.
static inline int32_t current_monitor_expected_mA(const current_monitor_t *self) {
    return self->early.mA_q14 >> 14;
}

/// Forgets runs of deviations (a latched fault has been acknowledged).
void current_monitor_reset(current_monitor_t *self);

/// Of a driver that is kept off: what is measured is what is expected from here on, and nothing was
/// wrong with it. Saturates at CURRENT_MOST_mA.
void current_monitor_follow(current_monitor_t *self, int32_t measured_mA);

#endif
