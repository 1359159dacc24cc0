/// Modified Bingham model (Gamota and Filisko 1991): friction fc and dashpot c0 side by side, in
/// series with spring k1 and dashpot c1 side by side, in series with spring k2. With e the
/// compression of k2 and d that of k1:
///
///   F  = k2 (e + f0 / k2)
///   e' = v - (e - clip(e, -e_y, e_y)) / t0 - d'
///   d' = (e - r d) / t1
///
/// yield_m is e_y = fc / k2, t0 = c0 / k2, t1 = c1 / k2 and r = k1 / k2: then the force is linear
/// in k2 and f0. The friction gives way on the force without its offset (printed: with it).
/// Compressions rather than the printed positions, so that any motion starts unloaded.
#ifndef QUIESCE_GAMOTA_FILISKO_H
#define QUIESCE_GAMOTA_FILISKO_H

#include "elementary.h"
#include "kernel.h"

namespace quiesce {

struct GamotaFilisko {
    static constexpr const char *kName = "gamota_filisko";
    static constexpr const char *kTitle = "modified Bingham (Gamota-Filisko)";
    static constexpr const char *kSource = "Gamota and Filisko 1991";
    static constexpr Scale kTimeScale{0, 1, -1};
    static constexpr std::array<ParameterInfo, 6> kParameters{{
        {"k2_N_m", "N/m", 0.0, kUnbounded, 1.0, 100.0, kStiffnessScale, true, true,
         "series stiffness"},
        {"yield_m", "m", 0.0, 1.0, 0.0, 0.5, kLengthScale, false, true,
         "friction over series stiffness"},
        {"t0_s", "s", 1e-5, 1e3, 0.001, 1.0, kTimeScale, false, true,
         "damping after yield over series stiffness"},
        {"t1_s", "s", 1e-5, 1e3, 0.01, 10.0, kTimeScale, false, true,
         "damping before yield over series stiffness"},
        {"r", "-", 0.0, 1e3, 0.0, 2.0, kNoScale, false, true,
         "stiffness before yield over series stiffness"},
        {"f0_N", "N", -kUnbounded, kUnbounded, -0.5, 0.5, kForceScale, true, true,
         "offset (gas, preload)"},
    }};
    static constexpr int kStates = 2;
    static constexpr bool kUsesAccel = false;

    enum { kK2, kYield, kT0, kT1, kR, kF0 };

    template <class T>
    static T force_N(const T *p, const Motion<T> &m, const T *z, T *rates) {
        const T e = z[0];
        const T slides = (e - clipped(e, -p[kYield], p[kYield])) / p[kT0];
        rates[1] = (e - p[kR] * z[1]) / p[kT1];
        rates[0] = m.v - slides - rates[1];
        return p[kK2] * e + p[kF0];
    }

    template <class T>
    static T fastest_rate_1_s(const T *p, const T & /*speed_m_s*/) {
        return T(1.0) / p[kT0] + (T(1.0) + p[kR]) / p[kT1];
    }
    static double stiffest_N_s_m(const double * /*p*/) { return 0.0; }
    static double stiffest_N_m(const double *p) { return p[kK2]; }
    static bool is_passive(const double *p) { return p[kK2] >= 0.0; }
};

} // namespace quiesce

#endif
