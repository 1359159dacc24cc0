/// Arctangent model (Meng; no equation is printed in the review, this is the usual form):
///
///   F = (2 / pi) fy arctan(kappa (v + alpha x)) + c v + k x + f0
///
/// Static and smooth.
#ifndef QUIESCE_ARCTANGENT_H
#define QUIESCE_ARCTANGENT_H

#include <cmath>

#include "elementary.h"
#include "kernel.h"

namespace quiesce {

struct Arctangent {
    static constexpr const char *kName = "arctangent";
    static constexpr const char *kTitle = "arctangent";
    static constexpr const char *kSource = "Meng et al., usual form";
    static constexpr std::array<ParameterInfo, 6> kParameters{{
        {"fy_N", "N", -kUnbounded, kUnbounded, 0.0, 1.5, kForceScale, true, true,
         "size of the hysteresis"},
        {"kappa_s_m", "s/m", 0.0, kUnbounded, 0.5, 100.0, kPerSpeedScale, false, true,
         "slope of the hysteresis against velocity"},
        {"alpha_1_s", "1/s", -1e4, 1e4, -1.0, 3.0, kRateScale, false, true,
         "share of the displacement in the shifted speed"},
        {"c_N_s_m", "N s/m", -kUnbounded, kUnbounded, -1.0, 2.0, kDampingScale, true, true,
         "viscous damping"},
        {"k_N_m", "N/m", -kUnbounded, kUnbounded, -1.0, 1.0, kStiffnessScale, true, true,
         "stiffness"},
        {"f0_N", "N", -kUnbounded, kUnbounded, -0.5, 0.5, kForceScale, true, true,
         "offset (gas, preload)"},
    }};
    static constexpr int kStates = 0;
    static constexpr bool kUsesAccel = false;

    enum { kFy, kKappa, kAlpha, kC, kK, kF0 };
    static constexpr double kTwoOverPi = 0.63661977236758134308;

    template <class T>
    static T force_N(const T *p, const Motion<T> &m, const T * /*z*/, T * /*rates*/) {
        const T u = m.v + p[kAlpha] * m.x;
        return p[kFy] * (T(kTwoOverPi) * arctangent(p[kKappa] * u)) + p[kC] * m.v + p[kK] * m.x +
               p[kF0];
    }

    template <class T>
    static T fastest_rate_1_s(const T * /*p*/, const T & /*speed_m_s*/) {
        return T(0.0);
    }
    static double stiffest_N_s_m(const double *p) {
        return std::abs(p[kC]) + kTwoOverPi * std::abs(p[kFy] * p[kKappa]);
    }
    static double stiffest_N_m(const double *p) {
        return std::abs(p[kK]) + kTwoOverPi * std::abs(p[kFy] * p[kKappa] * p[kAlpha]);
    }
    static bool is_passive(const double *p) {
        return p[kFy] >= 0.0 && p[kAlpha] >= 0.0 && p[kC] >= 0.0 && p[kK] >= 0.0;
    }
};

} // namespace quiesce

#endif
