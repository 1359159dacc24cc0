/// Viscous Dahl model (Ikhouane) with the asymmetry of Garcia-Banos as an option:
///
///   F  = kv (1 + ev sgn v) v + kw (1 + ew sgn w) w
///   w' = rho (v - |v| w),   |w| <= 1
///
/// Garcia-Banos let viscous and dry friction depend on the direction, in a form that is not printed
/// where we could read it. Here dry friction takes the sign of w, which follows that of v within
/// the pre-yield travel 1/rho: so the force stays continuous, and passive for every |ev|, |ew|
/// <= 1. 0 and 0: the model of Ikhouane, where a search leaves it.
#ifndef QUIESCE_VISCOUS_DAHL_H
#define QUIESCE_VISCOUS_DAHL_H

#include <cmath>

#include "elementary.h"
#include "kernel.h"

namespace quiesce {

struct ViscousDahl {
    static constexpr const char *kName = "viscous_dahl";
    static constexpr const char *kTitle = "viscous Dahl";
    static constexpr const char *kSource = "Ikhouane; asymmetry: Garcia-Banos";
    static constexpr std::array<ParameterInfo, 5> kParameters{{
        {"kv_N_s_m", "N s/m", 0.0, kUnbounded, 0.0, 2.0, kDampingScale, true, true,
         "viscous friction"},
        {"kw_N", "N", 0.0, kUnbounded, 0.0, 1.5, kForceScale, true, true, "largest dry friction"},
        {"rho_1_m", "1/m", 0.0, kUnbounded, 1.0, 100.0, kPerLengthScale, false, true,
         "inverse pre-yield travel"},
        {"ev", "-", -1.0, 1.0, 0.0, 0.0, kNoScale, false, true,
         "asymmetry of viscous friction (0: none)"},
        {"ew", "-", -1.0, 1.0, 0.0, 0.0, kNoScale, false, true,
         "asymmetry of dry friction (0: none)"},
    }};
    static constexpr int kStates = 1;
    static constexpr bool kUsesAccel = false;

    enum { kKv, kKw, kRho, kEv, kEw };

    template <class T>
    static T force_N(const T *p, const Motion<T> &m, const T *z, T *rates) {
        const T w = z[0];
        const T speed = absolute(m.v);
        rates[0] = p[kRho] * (m.v - speed * w);
        return p[kKv] * (m.v + p[kEv] * speed) + p[kKw] * (w + p[kEw] * absolute(w));
    }

    template <class T>
    static T fastest_rate_1_s(const T *p, const T &speed_m_s) {
        return p[kRho] * speed_m_s;
    }
    static double stiffest_N_s_m(const double *p) { return p[kKv] * (1.0 + std::abs(p[kEv])); }
    static double stiffest_N_m(const double *p) {
        return 2.0 * p[kKw] * (1.0 + std::abs(p[kEw])) * p[kRho];
    }
    static bool is_passive(const double *p) { return p[kKv] >= 0.0 && p[kKw] >= 0.0; }
};

} // namespace quiesce

#endif
