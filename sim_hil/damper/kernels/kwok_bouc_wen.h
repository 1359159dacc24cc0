/// Asymmetric Bouc-Wen model (Kwok 2007):
///
///   F  = c (v - mu sgn z) + k x + alpha z + f0
///   z' = {delta - [gamma sgn(z v) + beta] |z|^n} v
///
/// z without unit, alpha in N, delta, beta and gamma in 1/m. The set printed for the RD-1005-3 has
/// mu in mm/s: in m/s the area of its loop is negative. A review prints mu sgn(x) instead. One
/// of alpha, delta, beta and gamma is redundant, so that a search keeps delta: z scaled by s > 0
/// has alpha / s, s delta, s^(1-n) beta, s^(1-n) gamma and the same force.
///
/// With mu > 0 the force can push for as long as alpha |z| < c mu: passive is only mu = 0.
#ifndef QUIESCE_KWOK_BOUC_WEN_H
#define QUIESCE_KWOK_BOUC_WEN_H

#include "bouc_wen_state.h"
#include "kernel.h"

namespace quiesce {

struct KwokBoucWen {
    static constexpr const char *kName = "kwok_bouc_wen";
    static constexpr const char *kTitle = "asymmetric Bouc-Wen (Kwok)";
    static constexpr const char *kSource = "Kwok et al. 2007";
    static constexpr std::array<ParameterInfo, 9> kParameters{{
        {"c_N_s_m", "N s/m", 0.0, kUnbounded, 0.0, 2.0, kDampingScale, true, true,
         "viscous damping"},
        {"mu_m_s", "m/s", -100.0, 100.0, 0.0, 0.2, kSpeedScale, false, true,
         "shift of the velocity by the sign of z"},
        {"k_N_m", "N/m", -kUnbounded, kUnbounded, -0.5, 1.0, kStiffnessScale, true, true,
         "stiffness"},
        {"alpha_N", "N", 0.0, kUnbounded, 0.5, 50.0, kForceScale, true, true,
         "force of the hysteretic state"},
        {"delta_1_m", "1/m", 0.0, kUnbounded, 1.0, 1.0, kPerLengthScale, false, true,
         "slope of first loading (redundant: kept by a search)"},
        {"beta_1_m", "1/m", -kUnbounded, kUnbounded, -500.0, 1000.0, kPerLengthScale, false, true,
         "factor of v |z|^n, no lower than -0.99 gamma"},
        {"gamma_1_m", "1/m", 0.0, kUnbounded, 1.0, 2000.0, kPerLengthScale, false, true,
         "factor of v |z|^n sgn(z v)"},
        {"n", "-", 1.0, 20.0, 1.0, 3.0, kNoScale, false, true, "sharpness of yielding"},
        {"f0_N", "N", -kUnbounded, kUnbounded, -0.5, 0.5, kForceScale, true, true,
         "offset (gas, preload)"},
    }};
    static constexpr int kStates = 1;
    static constexpr bool kUsesAccel = false;

    enum { kC, kMu, kK, kAlpha, kDelta, kBeta, kGamma, kN, kF0 };

    template <class T>
    static T force_N(const T *p, const Motion<T> &m, const T *z, T *rates) {
        rates[0] = bouc_wen_rate(shape(p), m.v, z[0]);
        return p[kC] * (m.v - p[kMu] * sign(z[0])) + p[kK] * m.x + p[kAlpha] * z[0] + p[kF0];
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
        return p[kC] >= 0.0 && p[kMu] == 0.0 && p[kK] >= 0.0 && p[kAlpha] >= 0.0 &&
               is_dissipative(shape(p));
    }

  private:
    template <class T>
    static BoucWenShape<T> shape(const T *p) {
        return {p[kDelta], bounded_beta(p[kBeta], p[kGamma]), p[kGamma], p[kN]};
    }
};

} // namespace quiesce

#endif
