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
/// Formats: mA^2 / 16 in Q20, 50 bits; currents up by the half milliampere that a measurement is
/// rounded by, their squares up, the budget down, the lag's step up. Bounded, about 40
/// instructions.
#ifndef HEAT_H
#define HEAT_H

#include "fixq.h"

typedef struct {
    uint32_t tick_rate_Hz;
    int32_t continuous_mA; ///< 1 .. QUIESCE_HIGHEST_CURRENT_mA
    int32_t highest_mA;    ///< that may be commanded, at most ten times the continuous one
    int32_t time_s;        ///< time constant, 5 .. 10000
    uint32_t settle_us;    ///< in which the current follows a lower command, at most 10^8
} heat_cfg_t;

typedef struct {
    int64_t heat_q20;
    int64_t budget_q20;
    uint32_t gain_q32;  ///< share of the difference in a tick
    uint16_t shift;     ///< of the line's heat into 15 bits
    uint16_t line;      ///< heat below the budget that it lies over, shifted; >= 1
    uint16_t lowest_mA; ///< at its end
    uint16_t extra_mA;  ///< at its start, above the lowest; 0: nothing is derated
} heat_t;

/// Starts at half of the budget: what the coil has carried before is not known.
void heat_init(heat_t *self, const heat_cfg_t *cfg);

/// A tick with a current in the coil, either sign.
void heat_step(heat_t *self, int32_t current_mA);

/// What may be commanded now.
int32_t heat_limit_mA(const heat_t *self);

/// Whether that is less than the highest current.
static inline bool heat_is_limiting(const heat_t *self) {
    return self->extra_mA > 0 &&
           self->heat_q20 > self->budget_q20 - ((int64_t)self->line << self->shift);
}

/// Whether the coil is beyond its budget by more than derating and rounding explain: the squares of
/// currents below 17 mA are rounded by more than a sixteenth.
static inline bool heat_is_excessive(const heat_t *self) {
    return self->heat_q20 > self->budget_q20 + self->budget_q20 / 16 + (3 << 20);
}

#endif
