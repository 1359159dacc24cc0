/// One group of candidates run over a motion: the contract between the evaluator and the code that
/// is compiled for every instruction set.
#ifndef QUIESCE_GROUP_H
#define QUIESCE_GROUP_H

#include <cstddef>

#include "motion_grid.h"

namespace quiesce {

/// Around the model, each 0 where absent: lag of coil and driver (time constants of a rising and a
/// falling current), mass of fixture and piston, time by which the force channel lags the motion,
/// force at rest and its change, the field law (field_law.h).
enum RigParameter : std::size_t {
    kRigRise,
    kRigFall,
    kRigInertia,
    kRigSkew,
    kRigOffset,
    kRigDrift,
    kRigFieldExponent,
    kRigFieldSaturation,
    kRigFieldReference,
    kRigCount
};

/// Coefficients of a parameter against the current: constant, linear, quadratic.
constexpr std::size_t kMaxCoefficients = 3;

/// lanes candidates side by side: lane l of value k stands at [k * lanes + l].
struct GroupJob {
    const MotionGrid *motion;
    const double *coefficients; ///< [parameters * kMaxCoefficients][lanes]; unused ones are 0
    const double *rig;          ///< [kRigCount][lanes]
    bool has_current_law;       ///< some coefficient beyond the constants is in use
    bool has_field_law;         ///< some candidate has a field exponent
    double *force_N;            ///< out: [samples][lanes]
};

using GroupFunction = void (*)(const GroupJob &job);

/// One function a kernel, in the order of kernels.h. Null where the build has no such set.
struct GroupTable {
    const GroupFunction *functions;
    std::size_t lanes;
    const char *name;
};

} // namespace quiesce

#endif
