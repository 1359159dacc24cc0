/// Polynomial model of second order (Arias-Montiel 2015):
///
///   F = up_2 v^2 + up_1 v + up_0 (a > 0),  down_2 v^2 + down_1 v + down_0 (a < 0)
///
/// The printed b_k + c_k I is a coefficient with its current law; "a" is the acceleration. Static;
/// jumps where the acceleration changes sign unless both agree there; holds up to v_max only.
#ifndef QUIESCE_SECOND_ORDER_POLYNOMIAL_H
#define QUIESCE_SECOND_ORDER_POLYNOMIAL_H

#include "acceleration_polynomial.h"

namespace quiesce {

struct SecondOrderPolynomial {
    static constexpr const char *kName = "second_order_polynomial";
    static constexpr const char *kTitle = "polynomial of 2nd order";
    static constexpr const char *kSource = "Arias-Montiel et al. 2015";
    static constexpr std::array<ParameterInfo, 7> kParameters{{
        polynomial_coefficient("up0_N", "N", 0, "rising velocity: constant"),
        polynomial_coefficient("up1_N_s_m", "N s/m", 1, "rising velocity: v"),
        polynomial_coefficient("up2_N_s2_m2", "N s2/m2", 2, "rising velocity: v^2"),
        polynomial_coefficient("down0_N", "N", 0, "falling velocity: constant"),
        polynomial_coefficient("down1_N_s_m", "N s/m", 1, "falling velocity: v"),
        polynomial_coefficient("down2_N_s2_m2", "N s2/m2", 2, "falling velocity: v^2"),
        kSpeedLimit,
    }};
    static constexpr int kStates = 0;
    static constexpr bool kUsesAccel = true;

    using Polynomial = AccelerationPolynomial<2>;

    template <class T>
    static T force_N(const T *p, const Motion<T> &m, const T * /*z*/, T * /*rates*/) {
        return Polynomial::force_N(p, m);
    }

    template <class T>
    static T fastest_rate_1_s(const T * /*p*/, const T & /*speed_m_s*/) {
        return T(0.0);
    }
    static double stiffest_N_s_m(const double *p) { return Polynomial::stiffest_N_s_m(p); }
    static double stiffest_N_m(const double * /*p*/) { return 0.0; }
    static bool is_passive(const double *p) { return Polynomial::is_passive(p); }
};

} // namespace quiesce

#endif
