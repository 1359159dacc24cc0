/// Velocity from acceleration by a leaky integrator, v' = a - w v.
///
/// Phase against the true velocity: a lead of atan(cutoff / f) (5.7 degrees at 5 Hz for 0.5 Hz);
/// gain 1/sqrt(1 + (cutoff/f)^2). Trapezoidal in a, so the sampling itself adds no phase. State in
/// um/s, Q32, saturated at +-1073 m/s. Bounded, about 25 instructions.
#ifndef MOTION_H
#define MOTION_H

#include "fixq.h"

typedef struct {
    int64_t velocity_um_s_q32;
    int64_t half_step_q32; ///< half a tick in seconds, Q32
    int64_t leak_q32;      ///< w times a tick, Q32
    int32_t last_um_s2;
} motion_t;

/// tick_rate_Hz: 500 .. 4000; cutoff_mHz: 50 .. 5000.
void motion_init(motion_t *self, uint32_t tick_rate_Hz, int32_t cutoff_mHz);

/// One sample, |accel_um_s2| <= 5 x 10^8. Returns the velocity in um/s, Q32 (its sign is good to a
/// fraction of a um/s).
int64_t motion_step(motion_t *self, int32_t accel_um_s2);

/// Velocity in um/s, floor.
static inline int32_t motion_velocity_um_s(int64_t velocity_um_s_q32) {
    return (int32_t)(velocity_um_s_q32 >> 32);
}

#endif
