/// Bouc-Wen model as it is printed (Wen 1976), for published parameter sets:
///
///   F  = c v + k x + alpha z + f0
///   z' = A v - gamma |v| z |z|^(n-1) - beta v |z|^n
///
/// z in m. Printed k (x - x0) is k x + f0 with f0 = -k x0. One of alpha, A, beta and gamma is
/// redundant, so that a search keeps A = 1; normalised_bouc_wen.h is better to identify. In the
/// h-form (h = alpha z) A' = alpha A, beta' = beta alpha^(1-n), gamma' = gamma alpha^(1-n). Some
/// papers call A, beta and gamma by each other's names.
///
/// Parameter sets with beta > gamma >= 0 are admitted, but not passive.
#ifndef QUIESCE_BOUC_WEN_H
#define QUIESCE_BOUC_WEN_H

#include "bouc_wen_state.h"
#include "kernel.h"

namespace quiesce {

struct BoucWen {
    static constexpr const char *kName = "bouc_wen";
    static constexpr const char *kTitle = "Bouc-Wen";
    static constexpr const char *kSource = "Wen 1976";
    static constexpr std::array<ParameterInfo, 8> kParameters{{
        {"c_N_s_m", "N s/m", 0.0, kUnbounded, 0.0, 2.0, kDampingScale, true, true,
         "viscous damping"},
        {"k_N_m", "N/m", -kUnbounded, kUnbounded, -0.5, 1.0, kStiffnessScale, true, true,
         "stiffness"},
        {"alpha_N_m", "N/m", 0.0, kUnbounded, 0.5, 50.0, kStiffnessScale, true, true,
         "force of the hysteretic state"},
        {"A", "-", 0.0, kUnbounded, 1.0, 1.0, kNoScale, false, true,
         "slope of first loading (redundant: kept at 1 by a search)"},
        {"beta_1_mn",
         "1/m^n",
         -kUnbounded,
         kUnbounded,
         -500.0,
         1000.0,
         {0, -2, 0},
         false,
         true,
         "factor of v |z|^n, no lower than -0.99 gamma"},
        {"gamma_1_mn",
         "1/m^n",
         0.0,
         kUnbounded,
         1.0,
         2000.0,
         {0, -2, 0},
         false,
         true,
         "factor of |v| z |z|^(n-1)"},
        {"n", "-", 1.0, 20.0, 1.0, 3.0, kNoScale, false, true, "sharpness of yielding"},
        {"f0_N", "N", -kUnbounded, kUnbounded, -0.5, 0.5, kForceScale, true, true,
         "offset (gas, preload)"},
    }};
    static constexpr int kStates = 1;
    static constexpr bool kUsesAccel = false;

    enum { kC, kK, kAlpha, kA, kBeta, kGamma, kN, kF0 };

    template <class T>
    static T force_N(const T *p, const Motion<T> &m, const T *z, T *rates) {
        rates[0] = bouc_wen_rate(shape(p), m.v, z[0]);
        return p[kC] * m.v + p[kK] * m.x + p[kAlpha] * z[0] + p[kF0];
    }

    template <class T>
    static T fastest_rate_1_s(const T *p, const T &speed_m_s) {
        return bouc_wen_fastest_1_s(shape(p), speed_m_s);
    }
    static double stiffest_N_s_m(const double *p) { return std::abs(p[kC]); }
    static double stiffest_N_m(const double *p) {
        return std::abs(p[kK]) + p[kAlpha] * bouc_wen_steepest(shape(p));
    }
    static bool is_passive(const double *p) {
        return p[kC] >= 0.0 && p[kK] >= 0.0 && p[kAlpha] >= 0.0 && is_dissipative(shape(p));
    }

  private:
    template <class T>
    static BoucWenShape<T> shape(const T *p) {
        return {p[kA], bounded_beta(p[kBeta], p[kGamma]), p[kGamma], p[kN]};
    }
};

} // namespace quiesce

#endif
