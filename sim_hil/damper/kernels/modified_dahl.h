/// Modified Dahl model (Zhou 2002):
///
///   F  = k x + c0 v + fd z + f0
///   z' = sigma v (1 - z sgn v),   |z| <= 1
///
/// A review prints "+ c0" without v, and -f0. 1/sigma is the pre-yield travel; this is the
/// normalised Bouc-Wen model with n = 1 and its sigma 1.
#ifndef QUIESCE_MODIFIED_DAHL_H
#define QUIESCE_MODIFIED_DAHL_H

#include <cmath>

#include "elementary.h"
#include "kernel.h"

namespace quiesce {

struct ModifiedDahl {
    static constexpr const char *kName = "modified_dahl";
    static constexpr const char *kTitle = "modified Dahl";
    static constexpr const char *kSource = "Zhou 2002";
    static constexpr std::array<ParameterInfo, 5> kParameters{{
        {"k_N_m", "N/m", -kUnbounded, kUnbounded, -0.5, 1.0, kStiffnessScale, true, true,
         "stiffness"},
        {"c0_N_s_m", "N s/m", 0.0, kUnbounded, 0.0, 2.0, kDampingScale, true, true,
         "viscous damping"},
        {"fd_N", "N", 0.0, kUnbounded, 0.0, 1.5, kForceScale, true, true, "largest friction"},
        {"sigma_1_m", "1/m", 0.0, kUnbounded, 1.0, 100.0, kPerLengthScale, false, true,
         "inverse pre-yield travel"},
        {"f0_N", "N", -kUnbounded, kUnbounded, -0.5, 0.5, kForceScale, true, true,
         "offset (gas, preload)"},
    }};
    static constexpr int kStates = 1;
    static constexpr bool kUsesAccel = false;

    enum { kK, kC0, kFd, kSigma, kF0 };

    template <class T>
    static T force_N(const T *p, const Motion<T> &m, const T *z, T *rates) {
        rates[0] = p[kSigma] * (m.v - absolute(m.v) * z[0]);
        return p[kK] * m.x + p[kC0] * m.v + p[kFd] * z[0] + p[kF0];
    }

    template <class T>
    static T fastest_rate_1_s(const T *p, const T &speed_m_s) {
        return p[kSigma] * speed_m_s;
    }
    static double stiffest_N_s_m(const double *p) { return std::abs(p[kC0]); }
    static double stiffest_N_m(const double *p) {
        return std::abs(p[kK]) + 2.0 * p[kFd] * p[kSigma];
    }
    static bool is_passive(const double *p) {
        return p[kK] >= 0.0 && p[kC0] >= 0.0 && p[kFd] >= 0.0;
    }
};

} // namespace quiesce

#endif
