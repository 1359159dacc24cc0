/// Generalised hysteretic biviscous model (Zhao 2018): one three-part line of force against
/// velocity for a rising velocity, one for a falling velocity.
///
///   line(v) = c1 v - l1 below low, c3 v + l2 above high, straight between
///   rising: low = v_rise - h_rise, high = v_rise + h_rise; falling: v_fall, h_fall
///   F = (1 + s) / 2 rising + (1 - s) / 2 falling,   s = tanh(a / a_s)
///
/// Continuity ties the printed parameters of the steep parts to the knots v1 .. v4: here the knots
/// are given, as middle and half width, and the force is linear in c1, l1, c3, l2. Printed: Cpre2
/// = (line(v3) - line(v1)) / (v3 - v1), v01 = v1 - line(v1) / Cpre2, likewise Cpre4, v02 from v4
/// and v2. The printed switch by the sign of the acceleration is blended over a_s, for the lines
/// differ between the knots. Static; looks at the acceleration.
#ifndef QUIESCE_HYSTERETIC_BIVISCOUS_H
#define QUIESCE_HYSTERETIC_BIVISCOUS_H

#include <algorithm>
#include <cmath>

#include "elementary.h"
#include "kernel.h"

namespace quiesce {

struct HystereticBiviscous {
    static constexpr const char *kName = "hysteretic_biviscous";
    static constexpr const char *kTitle = "generalised hysteretic biviscous";
    static constexpr const char *kSource = "Zhao et al. 2018";
    static constexpr std::array<ParameterInfo, 9> kParameters{{
        {"c1_N_s_m", "N s/m", -kUnbounded, kUnbounded, -0.5, 2.0, kDampingScale, true, true,
         "damping after yield, negative velocity"},
        {"l1_N", "N", -kUnbounded, kUnbounded, 0.0, 1.5, kForceScale, true, true,
         "intercept, negative velocity"},
        {"c3_N_s_m", "N s/m", -kUnbounded, kUnbounded, -0.5, 2.0, kDampingScale, true, true,
         "damping after yield, positive velocity"},
        {"l2_N", "N", -kUnbounded, kUnbounded, 0.0, 1.5, kForceScale, true, true,
         "intercept, positive velocity"},
        {"v_rise_m_s", "m/s", -100.0, 100.0, 0.0, 0.6, kSpeedScale, false, true,
         "middle of the steep part, rising velocity"},
        {"h_rise_m_s", "m/s", 1e-6, 100.0, 0.01, 0.8, kSpeedScale, false, true,
         "half width of the steep part, rising velocity"},
        {"v_fall_m_s", "m/s", -100.0, 100.0, -0.6, 0.0, kSpeedScale, false, true,
         "middle of the steep part, falling velocity"},
        {"h_fall_m_s", "m/s", 1e-6, 100.0, 0.01, 0.8, kSpeedScale, false, true,
         "half width of the steep part, falling velocity"},
        {"a_s_m_s2", "m/s2", 1e-6, 1e4, 0.02, 1.0, Scale{0, -1, 2}, false, false,
         "acceleration over which the lines are blended"},
    }};
    static constexpr int kStates = 0;
    static constexpr bool kUsesAccel = true;

    enum { kC1, kL1, kC3, kL2, kVRise, kHRise, kVFall, kHFall, kAs };

    template <class T>
    static T force_N(const T *p, const Motion<T> &m, const T * /*z*/, T * /*rates*/) {
        const T rising = line_N(p, m.v, p[kVRise], p[kHRise]);
        const T falling = line_N(p, m.v, p[kVFall], p[kHFall]);
        const T side = hyperbolic_tangent(m.a / p[kAs]);
        return T(0.5) * ((rising + falling) + side * (rising - falling));
    }

    template <class T>
    static T fastest_rate_1_s(const T * /*p*/, const T & /*speed_m_s*/) {
        return T(0.0);
    }
    static double stiffest_N_s_m(const double *p) {
        return std::max({std::abs(p[kC1]), std::abs(p[kC3]), steepest(p, p[kVRise], p[kHRise]),
                         steepest(p, p[kVFall], p[kHFall])});
    }
    static double stiffest_N_m(const double * /*p*/) { return 0.0; }
    /// Only without hysteresis and with equal sides: slow one way and fast the other it gives out
    /// energy.
    static bool is_passive(const double *p) {
        return p[kVRise] == 0.0 && p[kVFall] == 0.0 && p[kC1] == p[kC3] && p[kL1] == p[kL2] &&
               p[kC1] >= 0.0 && p[kL1] >= 0.0;
    }

  private:
    template <class T>
    static T line_N(const T *p, const T &v, const T &middle, const T &half) {
        const T low = middle - half;
        const T high = middle + half;
        const T part = clipped((v - low) / (T(2.0) * half), T(0.0), T(1.0));
        const T below = p[kC1] * smaller(v, low) - p[kL1];
        const T above = p[kC3] * larger(v, high) + p[kL2];
        return below + part * (above - below);
    }

    static double steepest(const double *p, double middle, double half) {
        const double below = p[kC1] * (middle - half) - p[kL1];
        const double above = p[kC3] * (middle + half) + p[kL2];
        return std::abs(above - below) / (2.0 * half);
    }
};

} // namespace quiesce

#endif
