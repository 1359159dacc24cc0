/// Bouc-Wen model in its normalised form, without the redundant parameter (Ikhouane, Rodellar):
///
///   F  = c v + k x + kw w + f0
///   w' = rho (v - sigma |v| |w|^(n-1) w + (sigma - 1) v |w|^n),   |w| <= 1
///
/// From z' = A v - gamma |v| z |z|^(n-1) - beta v |z|^n with force alpha z: z0 = (A/(beta +
/// gamma))^(1/n), rho = A/z0, sigma = gamma/(beta + gamma), kw = alpha z0. 1/rho is the pre-yield
/// travel. Dissipative for sigma >= 1/2.
#ifndef QUIESCE_NORMALISED_BOUC_WEN_H
#define QUIESCE_NORMALISED_BOUC_WEN_H

#include <cmath>

#include "elementary.h"
#include "kernel.h"

namespace quiesce {

struct NormalisedBoucWen {
    static constexpr const char *kName = "normalised_bouc_wen";
    static constexpr const char *kTitle = "normalised Bouc-Wen";
    static constexpr const char *kSource = "Ikhouane and Rodellar 2005";
    static constexpr std::array<ParameterInfo, 7> kParameters{{
        {"c_N_s_m", "N s/m", 0.0, kUnbounded, 0.0, 2.0, kDampingScale, true, true,
         "viscous damping"},
        {"k_N_m", "N/m", -kUnbounded, kUnbounded, -0.5, 1.0, kStiffnessScale, true, true,
         "stiffness"},
        {"kw_N", "N", 0.0, kUnbounded, 0.0, 1.5, kForceScale, true, true,
         "largest hysteretic force"},
        {"rho_1_m", "1/m", 0.0, kUnbounded, 1.0, 100.0, kPerLengthScale, false, true,
         "inverse pre-yield travel"},
        {"sigma", "-", 0.5, 100.0, 0.5, 3.0, kNoScale, false, true, "shape of unloading"},
        {"n", "-", 1.0, 20.0, 1.0, 4.0, kNoScale, false, true, "sharpness of yielding"},
        {"f0_N", "N", -kUnbounded, kUnbounded, -0.5, 0.5, kForceScale, true, true,
         "offset (gas, preload)"},
    }};
    static constexpr int kStates = 1;
    static constexpr bool kUsesAccel = false;

    enum { kC, kK, kKw, kRho, kSigma, kN, kF0 };

    template <class T>
    static T force_N(const T *p, const Motion<T> &m, const T *z, T *rates) {
        const T w = z[0];
        const T size = power(absolute(w), p[kN]);
        // |v| |w|^(n-1) w = v |w|^n where v and w have one sign, else its negative.
        const T loading = select(m.v * w < T(0.0), T(1.0) - T(2.0) * p[kSigma], T(1.0));
        rates[0] = p[kRho] * m.v * (T(1.0) - loading * size);
        return p[kC] * m.v + p[kK] * m.x + p[kKw] * w + p[kF0];
    }

    template <class T>
    static T fastest_rate_1_s(const T *p, const T &speed_m_s) {
        return p[kRho] * p[kN] * speed_m_s * larger(T(1.0), T(2.0) * p[kSigma] - T(1.0));
    }
    static double stiffest_N_s_m(const double *p) { return std::abs(p[kC]); }
    static double stiffest_N_m(const double *p) {
        return std::abs(p[kK]) + 2.0 * p[kSigma] * std::abs(p[kKw]) * p[kRho];
    }
    static bool is_passive(const double *p) {
        return p[kC] >= 0.0 && p[kK] >= 0.0 && p[kKw] >= 0.0 && p[kSigma] >= 0.5;
    }
};

} // namespace quiesce

#endif
