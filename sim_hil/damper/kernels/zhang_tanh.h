/// Hyperbolic tangent model of the shifted speed (Zhang):
///
///   F = a1 tanh(a2 (v + alpha x)) + a3 (v + alpha x) + f0
///
/// a2 is the slope before yield, a3 the damping after it. Static and smooth.
#ifndef QUIESCE_ZHANG_TANH_H
#define QUIESCE_ZHANG_TANH_H

#include "kernel.h"
#include "tanh_of_shifted_speed.h"

namespace quiesce {

struct ZhangTanh {
    using Shape = TanhOfShiftedSpeed;
    static constexpr const char *kName = "zhang_tanh";
    static constexpr const char *kTitle = "hyperbolic tangent of the shifted speed (Zhang)";
    static constexpr const char *kSource = "Zhang et al.";
    static constexpr std::array<ParameterInfo, 5> kParameters{
        {Shape::kSize,
         Shape::kSlope,
         Shape::kDamping,
         Shape::kShift,
         {"f0_N", "N", -kUnbounded, kUnbounded, -0.5, 0.5, kForceScale, true, true,
          "offset (gas, preload)"}}};
    static constexpr int kStates = 0;
    static constexpr bool kUsesAccel = false;

    enum { kF0 = 4 };

    template <class T>
    static T force_N(const T *p, const Motion<T> &m, const T * /*z*/, T * /*rates*/) {
        return Shape::force_N(p, m) + p[kF0];
    }

    template <class T>
    static T fastest_rate_1_s(const T * /*p*/, const T & /*speed_m_s*/) {
        return T(0.0);
    }
    static double stiffest_N_s_m(const double *p) { return Shape::stiffest_N_s_m(p); }
    static double stiffest_N_m(const double *p) { return Shape::stiffest_N_m(p); }
    static bool is_passive(const double *p) { return Shape::is_passive(p); }
};

} // namespace quiesce

#endif
