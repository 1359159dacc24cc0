/// Velocity from acceleration by a leaky integrator, v' = a - w v.
///
/// Against the true velocity it leads by atan(cutoff / f) and half a tick (at 5 Hz, 0.5 Hz and 1
/// kHz: 5.7 + 0.9 degrees); gain 1/sqrt(1 + (cutoff/f)^2). The lead is wanted: a law on sgn(v a)
/// sees its two quarters equally long without it, and then the rounding to ticks decides which way
/// it drifts. State in um/s, Q32, saturated at +-1073 m/s. Bounded, about 20 instructions.
#ifndef MOTION_H
#define MOTION_H

#include "fixq.h"

/// Where the velocity saturates, um/s.
#define MOTION_LIMIT_um_s 1073741823

typedef struct {
    int64_t velocity_um_s_q32;
    int32_t step_q32; ///< a tick in seconds, Q32, below 2^24
    int32_t leak_q32; ///< w times a tick, Q32, below 2^29
} motion_t;

/// tick_rate_Hz: 500 .. 4000; cutoff_mHz: 50 .. 5000.
void motion_init(motion_t *self, uint32_t tick_rate_Hz, int32_t cutoff_mHz);

/// Back to rest.
void motion_reset(motion_t *self);

/// Velocity in um/s, floor.
static inline int32_t motion_velocity_um_s(int64_t velocity_um_s_q32) {
    return (int32_t)(velocity_um_s_q32 >> 32);
}

/// One sample, |accel_um_s2| <= 5 x 10^8. Returns the velocity in um/s, Q32 (its sign is good to a
/// fraction of a um/s).
static inline int64_t motion_step(motion_t *self, int32_t accel_um_s2) {
    const int32_t last_um_s = motion_velocity_um_s(self->velocity_um_s_q32);
    // The two are at most 2^53 and 2^59 beside 2^62.
    int64_t next_q32 = self->velocity_um_s_q32 + (int64_t)accel_um_s2 * self->step_q32 -
                       (int64_t)last_um_s * self->leak_q32;
    // The high word alone tells whether it is near the limit.
    const int32_t next_um_s = motion_velocity_um_s(next_q32);
    if (next_um_s >= MOTION_LIMIT_um_s || next_um_s < -MOTION_LIMIT_um_s) {
        const int64_t limit_q32 = INT64_C(4294967296) * MOTION_LIMIT_um_s;
        next_q32 = clamp_i64(next_q32, -limit_q32, limit_q32);
    }
    self->velocity_um_s_q32 = next_q32;
    return next_q32;
}

#endif
