/// Nonlinear biviscous model (Snyder 2001):
///
///   F = c_post v + clip((c_pre - c_post) v, -fy, fy)
///
/// which is c_pre v below the yield speed vy and c_post v +- fy beyond. Continuity ties the four
/// printed parameters by fy = (c_pre - c_post) vy; here c_pre follows from the other three, and
/// the force is linear in c = c_post and fy. Static.
#ifndef QUIESCE_NONLINEAR_BIVISCOUS_H
#define QUIESCE_NONLINEAR_BIVISCOUS_H

#include <cmath>

#include "elementary.h"
#include "kernel.h"

namespace quiesce {

struct NonlinearBiviscous {
    static constexpr const char *kName = "nonlinear_biviscous";
    static constexpr const char *kTitle = "nonlinear biviscous";
    static constexpr const char *kSource = "Snyder et al. 2001";
    static constexpr std::array<ParameterInfo, 3> kParameters{{
        {"c_N_s_m", "N s/m", -kUnbounded, kUnbounded, -0.5, 2.0, kDampingScale, true, true,
         "damping after yield"},
        {"fy_N", "N", 0.0, kUnbounded, 0.0, 1.5, kForceScale, true, true, "yield force"},
        {"vy_m_s", "m/s", 1e-6, 100.0, 0.005, 0.8, kSpeedScale, false, true, "yield speed"},
    }};
    static constexpr int kStates = 0;
    static constexpr bool kUsesAccel = false;

    enum { kC, kFy, kVy };

    template <class T>
    static T force_N(const T *p, const Motion<T> &m, const T * /*z*/, T * /*rates*/) {
        return p[kC] * m.v + p[kFy] * clipped(m.v / p[kVy], T(-1.0), T(1.0));
    }

    template <class T>
    static T fastest_rate_1_s(const T * /*p*/, const T & /*speed_m_s*/) {
        return T(0.0);
    }
    static double stiffest_N_s_m(const double *p) { return std::abs(p[kC]) + p[kFy] / p[kVy]; }
    static double stiffest_N_m(const double * /*p*/) { return 0.0; }
    static bool is_passive(const double *p) { return p[kC] >= 0.0 && p[kFy] >= 0.0; }
};

} // namespace quiesce

#endif
