/// What a damper sees, as its equations want it.
#ifndef QUIESCE_MOTION_OF_H
#define QUIESCE_MOTION_OF_H

#include "damper.h"
#include "kernel.h"

namespace quiesce {

inline Motion<double> motion_of(const DamperInput &input) {
    return {input.position_m, input.velocity_m_s, input.accel_m_s2, input.current_A};
}

} // namespace quiesce

#endif
