/// From coil current to what the field does to the fluid: parameters that are linear in the
/// effective current may so rise slowly at first and saturate.
///
///   effective = reference r^exponent (1 + saturation) / (1 + saturation r^exponent),
///   r = |current| / reference
///
/// The effective current equals the current at 0 and at the reference. Exponents near 3/2 belong to
/// magnetisable particles in a weak field (Ginder), saturation to the steel and the fluid.
#ifndef QUIESCE_FIELD_LAW_H
#define QUIESCE_FIELD_LAW_H

#include "elementary.h"

namespace quiesce {

template <class T>
struct FieldLaw {
    T exponent;   ///< > 0; 0: the effective current is the current
    T saturation; ///< >= 0
    T reference;  ///< A, > 0 where the exponent is

    T effective(const T &current) const {
        const T part = absolute(current) / larger(reference, T(1e-12));
        const T raised = power(larger(part, T(1e-12)), exponent);
        const T bent = reference * raised * (T(1.0) + saturation) / (T(1.0) + saturation * raised);
        return select(exponent > T(0.0), bent, current);
    }
};

} // namespace quiesce

#endif
