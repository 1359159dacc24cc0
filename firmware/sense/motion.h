/// Velocity from acceleration by a leaky integrator, v' = a - w v.
///
/// Against the true velocity it leads by atan(cutoff / f) and half a tick (at 5 Hz, 0.5 Hz and 1
/// kHz: 5.7 + 0.9 degrees); gain 1/sqrt(1 + (cutoff/f)^2). The lead is wanted: a law on sgn(v a)
/// sees its two quarters equally long without it, and then the rounding to ticks decides which way
/// it drifts. State in um/s, Q32, saturated at +-1073 m/s. Bounded, about 25 instructions.
#ifndef MOTION_H
#define MOTION_H

#include "fixq.h"

typedef struct {
    int64_t velocity_um_s_q32;
    int64_t step_q32; ///< a tick in seconds, Q32
    int64_t leak_q32; ///< w times a tick, Q32
} motion_t;

/// tick_rate_Hz: 500 .. 4000; cutoff_mHz: 50 .. 5000.
void motion_init(motion_t *self, uint32_t tick_rate_Hz, int32_t cutoff_mHz);

/// Back to rest.
void motion_reset(motion_t *self);

/// One sample, |accel_um_s2| <= 5 x 10^8. Returns the velocity in um/s, Q32 (its sign is good to a
/// fraction of a um/s).
int64_t motion_step(motion_t *self, int32_t accel_um_s2);

/// Velocity in um/s, floor.
static inline int32_t motion_velocity_um_s(int64_t velocity_um_s_q32) {
    return (int32_t)(velocity_um_s_q32 >> 32);
}

#endif
