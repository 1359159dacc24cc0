/// Polynomial model (Choi, Lee, Park 2001), n = 6:
///
///   F = sum_k up_k v^k (a > 0),  sum_k down_k v^k (a < 0)
///
/// The printed b_k + c_k I is a coefficient with its current law; the reference prints one set,
/// though its text has two. Static; jumps where the acceleration changes sign unless both agree
/// there; holds for the frequency and amplitude of its test and up to v_max only.
#ifndef QUIESCE_CHOI_POLYNOMIAL_H
#define QUIESCE_CHOI_POLYNOMIAL_H

#include "acceleration_polynomial.h"

namespace quiesce {

struct ChoiPolynomial {
    static constexpr const char *kName = "choi_polynomial";
    static constexpr const char *kTitle = "polynomial of 6th order (Choi)";
    static constexpr const char *kSource = "Choi, Lee and Park 2001";
    static constexpr std::array<ParameterInfo, 15> kParameters{{
        polynomial_coefficient("up0_N", "N", 0, "rising velocity: constant"),
        polynomial_coefficient("up1_N_s_m", "N s/m", 1, "rising velocity: v"),
        polynomial_coefficient("up2_N_s2_m2", "N s2/m2", 2, "rising velocity: v^2"),
        polynomial_coefficient("up3_N_s3_m3", "N s3/m3", 3, "rising velocity: v^3"),
        polynomial_coefficient("up4_N_s4_m4", "N s4/m4", 4, "rising velocity: v^4"),
        polynomial_coefficient("up5_N_s5_m5", "N s5/m5", 5, "rising velocity: v^5"),
        polynomial_coefficient("up6_N_s6_m6", "N s6/m6", 6, "rising velocity: v^6"),
        polynomial_coefficient("down0_N", "N", 0, "falling velocity: constant"),
        polynomial_coefficient("down1_N_s_m", "N s/m", 1, "falling velocity: v"),
        polynomial_coefficient("down2_N_s2_m2", "N s2/m2", 2, "falling velocity: v^2"),
        polynomial_coefficient("down3_N_s3_m3", "N s3/m3", 3, "falling velocity: v^3"),
        polynomial_coefficient("down4_N_s4_m4", "N s4/m4", 4, "falling velocity: v^4"),
        polynomial_coefficient("down5_N_s5_m5", "N s5/m5", 5, "falling velocity: v^5"),
        polynomial_coefficient("down6_N_s6_m6", "N s6/m6", 6, "falling velocity: v^6"),
        kSpeedLimit,
    }};
    static constexpr int kStates = 0;
    static constexpr bool kUsesAccel = true;

    using Polynomial = AccelerationPolynomial<6>;

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
