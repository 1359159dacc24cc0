/// Extended hyperbolic tangent Bingham model (Guo):
///
///   F = A1 tanh(A3 (v + (V0/X0) x)) + A2 (v + (V0/X0) x)
///
/// Only the ratio of the critical speed V0 and the critical displacement X0 matters: alpha = V0 /
/// X0; further a1 = A1, a2 = A3, a3 = A2. Zhang's model is this one with an offset. Static.
#ifndef QUIESCE_EXTENDED_TANH_BINGHAM_H
#define QUIESCE_EXTENDED_TANH_BINGHAM_H

#include "kernel.h"
#include "tanh_of_shifted_speed.h"

namespace quiesce {

struct ExtendedTanhBingham {
    using Shape = TanhOfShiftedSpeed;
    static constexpr const char *kName = "extended_tanh_bingham";
    static constexpr const char *kTitle = "extended hyperbolic tangent Bingham (Guo)";
    static constexpr const char *kSource = "Guo et al.";
    static constexpr std::array<ParameterInfo, 4> kParameters{
        {Shape::kSize, Shape::kSlope, Shape::kDamping, Shape::kShift}};
    static constexpr int kStates = 0;
    static constexpr bool kUsesAccel = false;

    template <class T>
    static T force_N(const T *p, const Motion<T> &m, const T * /*z*/, T * /*rates*/) {
        return Shape::force_N(p, m);
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
