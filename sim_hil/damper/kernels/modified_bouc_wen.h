/// Modified Bouc-Wen model, "phenomenological" (Spencer, Dyke, Sain, Carlson 1997), without the
/// redundant parameter of its hysteresis:
///
///   F  = c1 y' + k1 x + f0
///   y' = [kw w + c0 v + k0 (x - y)] / (c0 + c1),   r = v - y'
///   w' = rho (r - sigma |r| |w|^(n-1) w + (sigma - 1) r |w|^n),   |w| <= 1
///
/// c0, k0: dashpot and spring beside the hysteresis; c1: dashpot in series, which rolls the force
/// off at low speed; k1: accumulator. From the printed alpha z with z' = A r - gamma |r| z
/// |z|^(n-1) - beta r |z|^n and k1 (x - x0): z0 = (A/(beta + gamma))^(1/n), kw = alpha z0, rho =
/// A/z0, sigma = gamma/(beta + gamma), f0 = -k1 x0. States y, w. Where the source has a filtered
/// voltage u, u is the current here and its filter the coil lag, u' = -eta (u - V): rise_s = fall_s
/// = 1/eta. Dissipative for sigma >= 1/2; published sets below that are admitted.
#ifndef QUIESCE_MODIFIED_BOUC_WEN_H
#define QUIESCE_MODIFIED_BOUC_WEN_H

#include <algorithm>
#include <cmath>

#include "elementary.h"
#include "kernel.h"

namespace quiesce {

struct ModifiedBoucWen {
    static constexpr const char *kName = "modified_bouc_wen";
    static constexpr const char *kTitle = "modified Bouc-Wen (Spencer)";
    static constexpr const char *kSource = "Spencer, Dyke, Sain and Carlson 1997";
    static constexpr std::array<ParameterInfo, 9> kParameters{{
        {"c0_N_s_m", "N s/m", 0.0, kUnbounded, 0.0, 2.0, kDampingScale, false, true,
         "viscous damping at high speed"},
        {"k0_N_m", "N/m", 0.0, kUnbounded, 0.0, 1.0, kStiffnessScale, false, true,
         "stiffness at high speed"},
        {"c1_N_s_m", "N s/m", 1e-3, kUnbounded, 1.0, 100.0, kDampingScale, false, true,
         "dashpot in series: force at low speed"},
        {"k1_N_m", "N/m", -kUnbounded, kUnbounded, -0.5, 1.0, kStiffnessScale, true, true,
         "stiffness of the accumulator"},
        {"kw_N", "N", 0.0, kUnbounded, 0.0, 1.5, kForceScale, false, true,
         "largest hysteretic force"},
        {"rho_1_m", "1/m", 0.0, kUnbounded, 1.0, 200.0, kPerLengthScale, false, true,
         "inverse pre-yield travel"},
        {"sigma", "-", 0.0, 100.0, 0.5, 3.0, kNoScale, false, true, "shape of unloading"},
        {"n", "-", 1.0, 20.0, 1.0, 4.0, kNoScale, false, true, "sharpness of yielding"},
        {"f0_N", "N", -kUnbounded, kUnbounded, -0.5, 0.5, kForceScale, true, true,
         "offset (gas, preload)"},
    }};
    static constexpr int kStates = 2;
    static constexpr bool kUsesAccel = false;

    enum { kC0, kK0, kC1, kK1, kKw, kRho, kSigma, kN, kF0 };

    template <class T>
    static T force_N(const T *p, const Motion<T> &m, const T *z, T *rates) {
        const T w = z[1];
        const T y_rate = (p[kKw] * w + p[kC0] * m.v + p[kK0] * (m.x - z[0])) / (p[kC0] + p[kC1]);
        const T r = m.v - y_rate;
        const T size = power(absolute(w), p[kN]);
        const T loading = T(1.0) - size;
        // Below 0 only outside |w| <= 1, which it must not leave for good.
        const T unloading = larger(T(1.0) - (T(1.0) - T(2.0) * p[kSigma]) * size, T(0.0));
        rates[0] = y_rate;
        rates[1] = p[kRho] * r * select(r * w < T(0.0), unloading, loading);
        return p[kC1] * y_rate + p[kK1] * m.x + p[kF0];
    }

    /// Bound of the eigenvalues of d rates / d states. The spring k0 holds at most what the series
    /// dashpot and the hysteresis put into it, so that |r| is at most twice what they cause alone.
    template <class T>
    static T fastest_rate_1_s(const T *p, const T &speed_m_s) {
        const T twice = T(2.0) * p[kSigma];
        const T damping_N_s_m = p[kC0] + p[kC1];
        const T slip_m_s = T(2.0) * (p[kC1] * speed_m_s + p[kKw]) / damping_N_s_m;
        return (p[kK0] + p[kRho] * p[kKw] * larger(T(1.0), twice)) / damping_N_s_m +
               p[kRho] * p[kN] * slip_m_s * larger(T(1.0), absolute(twice - T(1.0)));
    }
    static double stiffest_N_s_m(const double *p) { return p[kC0] * p[kC1] / (p[kC0] + p[kC1]); }
    static double stiffest_N_m(const double *p) {
        return std::abs(p[kK1]) + p[kK0] + p[kKw] * p[kRho] * std::max(1.0, 2.0 * p[kSigma]);
    }
    static bool is_passive(const double *p) { return p[kK1] >= 0.0 && p[kSigma] >= 0.5; }
};

} // namespace quiesce

#endif
