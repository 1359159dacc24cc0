/// Any damper along a prescribed motion, as on a test rig.
#ifndef QUIESCE_DAMPER_OVER_MOTION_H
#define QUIESCE_DAMPER_OVER_MOTION_H

#include "damper.h"
#include "motion_grid.h"

namespace quiesce {

/// Forces in N at the motion's samples. The motion's command is the coil current, without lag. The
/// integration is that of the kernels: classical Runge-Kutta over the grid's steps.
void damper_over_motion(const Damper &damper, const MotionGrid &motion, double *force_N);

} // namespace quiesce

#endif
