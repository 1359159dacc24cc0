/// Whether force and stroke of a damper are measured with the same sense. A damper takes energy out
/// of its motion, whatever its current: in the long run force times velocity must not be negative.
///
/// Averages over a second of force times velocity, and of its magnitude. A sensor whose polarity is
/// wrong makes them opposite; noise, elastic and constant forces leave the first one near 0. It is
/// negative once it has been below minus half of the other for four seconds. Powers in
/// mN um/s / 2^10, rounded down, 51 bits; averages move for more than some microwatts. Bounded,
/// about 35 instructions, 5 without signals.
#ifndef ENERGY_H
#define ENERGY_H

#include "fixq.h"

typedef struct {
    int64_t taken;  ///< average
    int64_t moved;  ///< average of the magnitude
    uint32_t ticks; ///< for which it has been negative, saturating
    uint32_t shift; ///< 2^shift ticks are a second, rounded up
} energy_t;

void energy_init(energy_t *self, uint32_t tick_rate_Hz);

/// Begins anew.
void energy_forget(energy_t *self);

/// A tick: force > 0 resists a stroke that grows; magnitudes below 2^30. Returns true iff energy
/// comes out of the damper.
bool energy_is_negative(energy_t *self, int32_t force_mN, int32_t velocity_um_s, bool are_valid);

#endif
