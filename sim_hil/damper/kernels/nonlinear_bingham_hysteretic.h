/// Nonlinear Bingham hysteretic model (Zhang 2013), a spring in series with a slider beside a
/// cubic dashpot:
///
///   F  = fy s + (c1 + c2 |v| + c3 v^2) v + f0,   |s| <= 1
///   s' = rho v while it unloads, else rho v (1 - u^2),   u = (|s| - 0.8) / 0.2 in 0 .. 1
///
/// The printed spring k and its deflection x1 are rho = k / fy and s = k x1 / fy: then the force
/// is linear in all but rho. How x1 evolves is not printed: it is taken as a spring that slides at
/// fy. The slider gives way over the last fifth of the force rather than at once, so that an
/// integration step does not overshoot.
#ifndef QUIESCE_NONLINEAR_BINGHAM_HYSTERETIC_H
#define QUIESCE_NONLINEAR_BINGHAM_HYSTERETIC_H

#include <algorithm>
#include <cmath>

#include "elementary.h"
#include "kernel.h"

namespace quiesce {

struct NonlinearBinghamHysteretic {
    static constexpr const char *kName = "nonlinear_bingham_hysteretic";
    static constexpr const char *kTitle = "nonlinear Bingham, hysteretic";
    static constexpr const char *kSource = "Zhang et al. 2013";
    static constexpr std::array<ParameterInfo, 6> kParameters{{
        {"fy_N", "N", 0.0, kUnbounded, 0.0, 1.5, kForceScale, true, true, "force of the slider"},
        {"rho_1_m", "1/m", 0.0, kUnbounded, 1.0, 100.0, kPerLengthScale, false, true,
         "inverse travel to yield"},
        {"c1_N_s_m", "N s/m", -kUnbounded, kUnbounded, -1.0, 2.0, kDampingScale, true, true,
         "viscous damping"},
        {"c2_N_s2_m2", "N s2/m2", -kUnbounded, kUnbounded, -1.0, 1.0, Scale{1, 0, -2}, true, true,
         "quadratic damping"},
        {"c3_N_s3_m3", "N s3/m3", -kUnbounded, kUnbounded, -1.0, 1.0, Scale{1, 0, -3}, true, true,
         "cubic damping"},
        {"f0_N", "N", -kUnbounded, kUnbounded, -0.5, 0.5, kForceScale, true, true,
         "offset (gas, preload)"},
    }};
    static constexpr int kStates = 1;
    static constexpr bool kUsesAccel = false;

    enum { kFy, kRho, kC1, kC2, kC3, kF0 };
    static constexpr double kKnee = 0.2; ///< part of the force over which the slider gives way

    template <class T>
    static T force_N(const T *p, const Motion<T> &m, const T *z, T *rates) {
        const T s = z[0];
        const T u = clipped((absolute(s) - T(1.0 - kKnee)) / T(kKnee), T(0.0), T(2.0));
        rates[0] = p[kRho] * m.v * select(m.v * s < T(0.0), T(1.0), T(1.0) - u * u);
        const T speed = absolute(m.v);
        return p[kFy] * clipped(s, T(-1.0), T(1.0)) +
               (p[kC1] + speed * (p[kC2] + speed * p[kC3])) * m.v + p[kF0];
    }

    template <class T>
    static T fastest_rate_1_s(const T *p, const T &speed_m_s) {
        return p[kRho] * speed_m_s * T(2.0) / T(kKnee);
    }
    /// At rest.
    static double stiffest_N_s_m(const double *p) { return std::abs(p[kC1]); }
    static double stiffest_N_m(const double *p) { return p[kFy] * p[kRho]; }
    static bool is_passive(const double *p) {
        return p[kFy] >= 0.0 && std::min({p[kC1], p[kC2], p[kC3]}) >= 0.0;
    }
};

} // namespace quiesce

#endif
