/// Hyperbolic tangent model with a sign of the displacement (Kwok 2006):
///
///   F = c v + k x + alpha tanh(beta v + delta tanh(x / x_s)) + f0
///
/// The printed sgn(x) (x from mid-stroke) is tanh(x / x_s) here; x_s = 0 is the sign itself.
/// Static.
#ifndef QUIESCE_KWOK_TANH_H
#define QUIESCE_KWOK_TANH_H

#include <cmath>

#include "elementary.h"
#include "kernel.h"

namespace quiesce {

struct KwokTanh {
    static constexpr const char *kName = "kwok_tanh";
    static constexpr const char *kTitle = "hyperbolic tangent (Kwok)";
    static constexpr const char *kSource = "Kwok et al. 2006";
    static constexpr std::array<ParameterInfo, 7> kParameters{{
        {"c_N_s_m", "N s/m", -kUnbounded, kUnbounded, -1.0, 2.0, kDampingScale, true, true,
         "viscous damping"},
        {"k_N_m", "N/m", -kUnbounded, kUnbounded, -1.0, 1.0, kStiffnessScale, true, true,
         "stiffness"},
        {"alpha_N", "N", -kUnbounded, kUnbounded, 0.0, 1.5, kForceScale, true, true,
         "size of the hysteresis"},
        {"beta_s_m", "s/m", 0.0, kUnbounded, 0.5, 50.0, kPerSpeedScale, false, true,
         "slope of the hysteresis against velocity"},
        {"delta", "-", -100.0, 100.0, -3.0, 3.0, kNoScale, false, true, "width of the hysteresis"},
        {"f0_N", "N", -kUnbounded, kUnbounded, -0.5, 0.5, kForceScale, true, true,
         "offset (gas, preload)"},
        {"x_s_m", "m", 0.0, 1.0, 0.0, 0.0, kLengthScale, false, false,
         "displacement over which its sign changes (0: at once)"},
    }};
    static constexpr int kStates = 0;
    static constexpr bool kUsesAccel = false;

    enum { kC, kK, kAlpha, kBeta, kDelta, kF0, kXs };

    template <class T>
    static T force_N(const T *p, const Motion<T> &m, const T * /*z*/, T * /*rates*/) {
        const T side =
            select(p[kXs] > T(0.0), hyperbolic_tangent(m.x / larger(p[kXs], T(1e-12))), sign(m.x));
        return p[kC] * m.v + p[kK] * m.x +
               p[kAlpha] * hyperbolic_tangent(p[kBeta] * m.v + p[kDelta] * side) + p[kF0];
    }

    template <class T>
    static T fastest_rate_1_s(const T * /*p*/, const T & /*speed_m_s*/) {
        return T(0.0);
    }
    static double stiffest_N_s_m(const double *p) {
        return std::abs(p[kC]) + std::abs(p[kAlpha] * p[kBeta]);
    }
    static double stiffest_N_m(const double *p) {
        const double side = p[kXs] > 0.0 ? std::abs(p[kAlpha] * p[kDelta]) / p[kXs] : 0.0;
        return std::abs(p[kK]) + side;
    }

    /// From rest at mid-stroke: the force rises with v, and at v = 0 it is the slope of a
    /// potential.
    static bool is_passive(const double *p) {
        return p[kC] >= 0.0 && p[kK] >= 0.0 && p[kAlpha] >= 0.0 && p[kDelta] >= 0.0;
    }
};

} // namespace quiesce

#endif
