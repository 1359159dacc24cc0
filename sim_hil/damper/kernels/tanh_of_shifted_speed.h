/// What the hyperbolic tangent models without a sign share: speed shifted by displacement,
///
///   u = v + alpha x,   F = a1 tanh(a2 u) + a3 u
///
/// For alpha >= 0 and a1, a2, a3 >= 0 the force rises with u, thus F v is never below what it is
/// at v = 0, the slope of a potential of x: from rest at mid-stroke no energy can be gained.
#ifndef QUIESCE_TANH_OF_SHIFTED_SPEED_H
#define QUIESCE_TANH_OF_SHIFTED_SPEED_H

#include <cmath>

#include "elementary.h"
#include "kernel.h"

namespace quiesce {

struct TanhOfShiftedSpeed {
    static constexpr ParameterInfo kSize{
        "a1_N", "N",         -kUnbounded, kUnbounded, 0.0,
        1.5,    kForceScale, true,        true,       "size of the hysteresis"};
    static constexpr ParameterInfo kSlope{
        "a2_s_m", "s/m",          0.0,   kUnbounded, 0.5,
        50.0,     kPerSpeedScale, false, true,       "slope of the hysteresis against velocity"};
    static constexpr ParameterInfo kDamping{
        "a3_N_s_m", "N s/m",       -kUnbounded, kUnbounded, -1.0,
        2.0,        kDampingScale, true,        true,       "damping after yield"};
    static constexpr ParameterInfo kShift{
        "alpha_1_s", "1/s",      -1e4,  1e4,  -1.0,
        3.0,         kRateScale, false, true, "share of the displacement in the shifted speed"};

    enum { kA1, kA2, kA3, kAlpha };

    template <class T>
    static T force_N(const T *p, const Motion<T> &m) {
        const T u = m.v + p[kAlpha] * m.x;
        return p[kA1] * hyperbolic_tangent(p[kA2] * u) + p[kA3] * u;
    }

    static double stiffest_N_s_m(const double *p) {
        return std::abs(p[kA1] * p[kA2]) + std::abs(p[kA3]);
    }
    static double stiffest_N_m(const double *p) { return stiffest_N_s_m(p) * std::abs(p[kAlpha]); }
    static bool is_passive(const double *p) {
        return p[kA1] >= 0.0 && p[kA2] >= 0.0 && p[kA3] >= 0.0 && p[kAlpha] >= 0.0;
    }
};

} // namespace quiesce

#endif
