/// Quasi-static magic formula (Bui 2021), the tyre formula of a shifted speed:
///
///   F = (fy + c |p|) sin(C arctan(B (1 - E) p + E arctan(B p))),   p = v + S x
///   S = (S_a + S_b) / 2 + (S_a - S_b) / 2 tanh(a / a_s)
///
/// Print: A is the shape C, gamma the stiffness B, beta (named B where it occurs again) the
/// curvature E. The force of the quasi-static design is yield plus viscous; its viscous part is
/// taken at the shifted speed, which keeps the model dissipative. The printed switch from S_a (a
/// >= 0) to S_b is blended over a_s. Odd only with S_a = S_b. Static;
/// looks at the acceleration.
#ifndef QUIESCE_MAGIC_FORMULA_H
#define QUIESCE_MAGIC_FORMULA_H

#include <algorithm>
#include <cmath>

#include "elementary.h"
#include "kernel.h"

namespace quiesce {

struct MagicFormula {
    static constexpr const char *kName = "magic_formula";
    static constexpr const char *kTitle = "quasi-static magic formula";
    static constexpr const char *kSource = "Bui et al. 2021";
    static constexpr std::array<ParameterInfo, 8> kParameters{{
        {"fy_N", "N", -kUnbounded, kUnbounded, 0.0, 1.5, kForceScale, true, true, "yield force"},
        {"c_N_s_m", "N s/m", -kUnbounded, kUnbounded, -0.5, 2.0, kDampingScale, true, true,
         "viscous damping"},
        {"shape", "-", 0.0, 2.0, 0.5, 1.5, kNoScale, false, true, "shape C"},
        {"b_s_m", "s/m", 0.0, kUnbounded, 0.5, 50.0, kPerSpeedScale, false, true, "stiffness B"},
        {"curvature", "-", -100.0, 1.0, -3.0, 1.0, kNoScale, false, true, "curvature E"},
        {"s_a_1_s", "1/s", -1e4, 1e4, -1.0, 3.0, kRateScale, false, true,
         "share of the displacement in the shifted speed, velocity rising"},
        {"s_b_1_s", "1/s", -1e4, 1e4, -1.0, 3.0, kRateScale, false, true,
         "the same, velocity falling"},
        {"a_s_m_s2", "m/s2", 1e-6, 1e4, 0.02, 1.0, Scale{0, -1, 2}, false, false,
         "acceleration over which the shares are blended"},
    }};
    static constexpr int kStates = 0;
    static constexpr bool kUsesAccel = true;

    enum { kFy, kC, kShape, kB, kCurvature, kSa, kSb, kAs };

    template <class T>
    static T force_N(const T *p, const Motion<T> &m, const T * /*z*/, T * /*rates*/) {
        const T side = hyperbolic_tangent(m.a / p[kAs]);
        const T share = T(0.5) * ((p[kSa] + p[kSb]) + side * (p[kSa] - p[kSb]));
        const T shifted = m.v + share * m.x;
        const T slope = p[kB] * shifted;
        const T bent = (T(1.0) - p[kCurvature]) * slope + p[kCurvature] * arctangent(slope);
        return (p[kFy] + p[kC] * absolute(shifted)) * sine(p[kShape] * arctangent(bent));
    }

    template <class T>
    static T fastest_rate_1_s(const T * /*p*/, const T & /*speed_m_s*/) {
        return T(0.0);
    }
    /// At rest.
    static double stiffest_N_s_m(const double *p) {
        return std::abs(p[kC]) + std::abs(p[kFy]) * p[kShape] * p[kB];
    }
    static double stiffest_N_m(const double *p) {
        return stiffest_N_s_m(p) * std::max(std::abs(p[kSa]), std::abs(p[kSb]));
    }
    /// With C <= 1 the force rises with the shifted speed.
    static bool is_passive(const double *p) {
        return p[kFy] >= 0.0 && p[kC] >= 0.0 && p[kShape] <= 1.0 && p[kSa] == p[kSb] &&
               p[kSa] >= 0.0;
    }
};

} // namespace quiesce

#endif
