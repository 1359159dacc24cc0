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
int32_t position_step(position_t *self, int64_t velocity_um_s_q32);

#endif
