/// Heat of a coil (I2t): the square of its current through a first-order lag, against the square
/// of the current that it carries for ever.
///
/// Above nine tenths of that budget the current that may be commanded falls in a straight line,
/// from the ceiling to the continuous current at the whole budget; there the coil gets no hotter.
/// More than a sixteenth above it, which only a driver that gives more than its command can cause,
/// is told as too hot. Where the ceiling is the continuous current nothing is ever derated.
/// Formats: mA^2 / 16 in Q20, 50 bits; currents rounded up, the budget down, the lag's step up.
/// Bounded, about 40 instructions.
#ifndef HEAT_H
#define HEAT_H

#include "fixq.h"

typedef struct {
    uint32_t tick_rate_Hz;
    int32_t continuous_mA; ///< 1 .. QUIESCE_HIGHEST_CURRENT_mA
    int32_t time_s;        ///< time constant, 5 .. 10000
} heat_cfg_t;

typedef struct {
    int64_t heat_q20;
    int64_t budget_q20;
    uint32_t gain_q32; ///< share of the difference in a tick
    uint32_t shift;    ///< of a tenth of the budget into 15 bits
    uint32_t tenth;    ///< of the budget, shifted; >= 1
    int32_t continuous_mA;
} heat_t;

/// Starts at half of the budget: what the coil has carried before is not known.
void heat_init(heat_t *self, const heat_cfg_t *cfg);

/// A tick with a current in the coil, either sign.
void heat_step(heat_t *self, int32_t current_mA);

/// Whether it is within a tenth of the budget.
static inline bool heat_is_near_budget(const heat_t *self) {
    return self->heat_q20 > self->budget_q20 - ((int64_t)self->tenth << self->shift);
}

/// What may be commanded now, continuous_mA .. ceiling_mA, of which the former is at least a tenth.
int32_t heat_limit_mA(const heat_t *self, int32_t ceiling_mA);

/// Whether less than the ceiling may be commanded.
static inline bool heat_is_limiting(const heat_t *self, int32_t ceiling_mA) {
    return self->continuous_mA < ceiling_mA && heat_is_near_budget(self);
}

/// Whether the coil is beyond its budget by more than derating explains.
static inline bool heat_is_excessive(const heat_t *self) {
    return self->heat_q20 > self->budget_q20 + self->budget_q20 / 16;
}

#endif
