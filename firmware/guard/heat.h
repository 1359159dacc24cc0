/// Heat of a coil (I2t): the square of its current through a first-order lag, against the square
/// of the current that it carries for ever.
///
/// Near that budget the current that may be commanded falls in a straight line, from the highest to
/// a little below the continuous current (a 64th and 1 mA) at the whole budget, so that the coil
/// stays within it. The line lies over the last tenth of the budget, or over more where the current
/// follows slowly: over four times the heat that the highest current leaves behind while it falls.
/// Where the highest current is the continuous one nothing is ever derated. More than a sixteenth
/// above the budget, which only a driver that gives more than its command can cause, is told as too
/// hot.
/// Squares are summed each tick, the lag takes them and the limit follows HEAT_SLICE_TICKS later.
/// Formats: mA^2 / 16 in Q20, 50 bits; currents up by the half milliampere that a measurement is
/// rounded by, the budget down, the lag's step up. Bounded, about 12 instructions, 90 where a slice
/// ends.
#ifndef HEAT_H
#define HEAT_H

#include "fixq.h"

#define HEAT_SLICE_TICKS 16u

typedef struct {
    uint32_t tick_rate_Hz;
    int32_t continuous_mA; ///< 1 .. QUIESCE_HIGHEST_CURRENT_mA
    int32_t highest_mA;    ///< that may be commanded, at most ten times the continuous one
    int32_t time_s;        ///< time constant, 5 .. 10000
    uint32_t settle_us;    ///< in which the current follows a lower limit, at most 10^8
    uint32_t first_ticks;  ///< of the first slice, 1 .. HEAT_SLICE_TICKS: not all coils at once
} heat_cfg_t;

typedef struct {
    int64_t heat_q20;
    int64_t sum;       ///< of the squares of this slice, (mA/2)^2
    uint32_t gain_q32; ///< share of the difference in a slice
    uint16_t continuous_mA;
    uint16_t highest_mA;
    uint16_t limit_mA;
    uint16_t line;      ///< heat below the budget that it lies over, shifted; >= 1
    uint8_t shift;      ///< of the line's heat into 15 bits
    uint8_t left_ticks; ///< of this slice
    bool is_excessive;
} heat_t;

/// Starts at half of the budget: what the coil has carried before is not known.
void heat_init(heat_t *self, const heat_cfg_t *cfg);

/// Goes on with heat that was there before a new start.
void heat_resume(heat_t *self, int64_t heat_q20);

/// A tick with a current in the coil, either sign.
void heat_step(heat_t *self, int32_t current_mA);

/// The whole budget.
int64_t heat_budget_q20(const heat_t *self);

/// What may be commanded now.
static inline int32_t heat_limit_mA(const heat_t *self) {
    return self->limit_mA;
}

/// Whether that is less than the highest current.
static inline bool heat_is_limiting(const heat_t *self) {
    return self->limit_mA < self->highest_mA;
}

/// Whether the coil is beyond its budget by more than derating and rounding explain: a sixteenth,
/// and 3, because the squares of currents below 17 mA are rounded by more than a sixteenth.
static inline bool heat_is_excessive(const heat_t *self) {
    return self->is_excessive;
}

#endif
