/// Bingham model (Stanway, Sproston and Stevens 1987):
///
///   F = fc tanh(v / eps) + c v + f0
///
/// The printed sgn(v) is set-valued at rest; tanh with eps of 1 to 5 mm/s stands for it. Static.
#ifndef QUIESCE_BINGHAM_H
#define QUIESCE_BINGHAM_H

#include <cmath>

#include "elementary.h"
#include "kernel.h"

namespace quiesce {

struct Bingham {
    static constexpr const char *kName = "bingham";
    static constexpr const char *kTitle = "Bingham";
    static constexpr const char *kSource = "Stanway et al. 1987";
    static constexpr std::array<ParameterInfo, 4> kParameters{{
        {"fc_N", "N", 0.0, kUnbounded, 0.0, 1.5, kForceScale, true, true, "friction"},
        {"c_N_s_m", "N s/m", -kUnbounded, kUnbounded, -0.5, 2.0, kDampingScale, true, true,
         "viscous damping"},
        {"f0_N", "N", -kUnbounded, kUnbounded, -0.5, 0.5, kForceScale, true, true,
         "offset (gas, preload)"},
        {"eps_m_s", "m/s", 1e-6, 10.0, 0.005, 0.5, kSpeedScale, false, true,
         "speed over which the friction changes sign"},
    }};
    static constexpr int kStates = 0;
    static constexpr bool kUsesAccel = false;

    enum { kFc, kC, kF0, kEps };

    template <class T>
    static T force_N(const T *p, const Motion<T> &m, const T * /*z*/, T * /*rates*/) {
        return p[kFc] * hyperbolic_tangent(m.v / p[kEps]) + p[kC] * m.v + p[kF0];
    }

    template <class T>
    static T fastest_rate_1_s(const T * /*p*/, const T & /*speed_m_s*/) {
        return T(0.0);
    }
    static double stiffest_N_s_m(const double *p) { return std::abs(p[kC]) + p[kFc] / p[kEps]; }
    static double stiffest_N_m(const double * /*p*/) { return 0.0; }
    static bool is_passive(const double *p) { return p[kC] >= 0.0 && p[kFc] >= 0.0; }
};

} // namespace quiesce

#endif
