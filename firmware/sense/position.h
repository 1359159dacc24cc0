/// Displacement from velocity by a leaky integrator, x' = v - w x.
///
/// Behind the velocity of motion.h against the true displacement it leads by twice atan(cutoff / f)
/// and half a tick, with gain 1/(1 + (cutoff/f)^2): a slow displacement is not seen. Velocities are
/// taken in Q6, floor, and saturate at 16.8 m/s; state in nm, Q30, saturated at +-1.07 m: its
/// offset is a few nm. Bounded, about 30 instructions.
#ifndef POSITION_H
#define POSITION_H

#include "fixq.h"

/// Where a velocity saturates, um/s.
#define POSITION_VELOCITY_LIMIT_um_s (1 << 24)

/// Where the displacement saturates, nm.
#define POSITION_LIMIT_nm 1073741823

typedef struct {
    int64_t nm_q30;
    int32_t step_q24; ///< nm of 1 um/s over a tick
    int32_t leak_q30; ///< w times a tick
} position_t;

/// tick_rate_Hz: 500 .. 4000; cutoff_mHz: 50 .. 5000.
void position_init(position_t *self, uint32_t tick_rate_Hz, int32_t cutoff_mHz);

/// Back to rest.
void position_reset(position_t *self);

/// One tick; velocity in um/s, Q32. Returns the displacement in nm, floor, |x| < 2^30.
static inline int32_t position_step(position_t *self, int64_t velocity_um_s_q32) {
    const int32_t limit_q6 = POSITION_VELOCITY_LIMIT_um_s * 64 - 1;
    // The high word alone tells whether it fits.
    const int32_t whole_um_s = (int32_t)(velocity_um_s_q32 >> 32);
    const int32_t fitting_q6 = (int32_t)(velocity_um_s_q32 >> 26);
    const int32_t velocity_q6 = whole_um_s >= POSITION_VELOCITY_LIMIT_um_s   ? limit_q6
                                : whole_um_s < -POSITION_VELOCITY_LIMIT_um_s ? -limit_q6
                                                                             : fitting_q6;
    const int32_t last_nm = (int32_t)(self->nm_q30 >> 30);
    // At most 2^30 x 2^25 more than 2^60.
    self->nm_q30 += (int64_t)velocity_q6 * self->step_q24 - (int64_t)last_nm * self->leak_q30;
    const int32_t nm = (int32_t)(self->nm_q30 >> 30);
    if (nm > POSITION_LIMIT_nm || nm < -POSITION_LIMIT_nm) {
        self->nm_q30 = (nm > 0 ? INT64_C(1) : INT64_C(-1)) * POSITION_LIMIT_nm * (INT64_C(1) << 30);
        return nm > 0 ? POSITION_LIMIT_nm : -POSITION_LIMIT_nm;
    }
    return nm;
}

#endif
