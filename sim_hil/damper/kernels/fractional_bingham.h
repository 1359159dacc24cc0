/// Fractional-derivative Bingham model (Li et al. 2015):
///
///   F = fc tanh(D / eps) + c D + f0,   D = d^phi x / dt^phi,   0 <= phi <= 1
///
/// D is the integral of order 1 - phi of v from rest, a positive sum of first-order lags of v
/// (diffusive representation), here nine with rates of 0.4 .. 4000 rad/s and one for all slower
/// ones; the faster ones answer at once. On a sinusoid it is within 1 % of X w^phi with the
/// phase phi pi/2 in 0.2 .. 100 Hz, within 7 % in 0.05 .. 500 Hz. All weights are positive, which
/// keeps the model dissipative.
///
/// With phi = 0 D is x from where the motion starts, with phi = 1 it is v. Before the motion there
/// is rest: where a recording starts at x0 in full motion, about x0 t^-phi is missing at first. D
/// has the unit m/s^phi, c has N s^phi/m.
#ifndef QUIESCE_FRACTIONAL_BINGHAM_H
#define QUIESCE_FRACTIONAL_BINGHAM_H

#include <cmath>

#include "elementary.h"
#include "kernel.h"

namespace quiesce {

struct FractionalBingham {
    static constexpr const char *kName = "fractional_bingham";
    static constexpr const char *kTitle = "fractional-derivative Bingham";
    static constexpr const char *kSource = "Li et al. 2015";
    static constexpr std::array<ParameterInfo, 5> kParameters{{
        {"fc_N", "N", 0.0, kUnbounded, 0.0, 1.5, kForceScale, true, true, "friction"},
        {"c_N_sphi_m", "N s^phi/m", -kUnbounded, kUnbounded, -0.5, 4.0, kDampingScale, true, true,
         "damping"},
        {"phi", "-", 0.0, 1.0, 0.3, 1.0, kNoScale, false, true, "order of the derivative"},
        {"f0_N", "N", -kUnbounded, kUnbounded, -0.5, 0.5, kForceScale, true, true,
         "offset (gas, preload)"},
        {"eps_m_sphi", "m/s^phi", 1e-6, 10.0, 0.002, 0.5, kSpeedScale, false, true,
         "derivative over which the friction changes sign"},
    }};
    static constexpr int kStates = 10;
    static constexpr bool kUsesAccel = false;

    enum { kFc, kC, kPhi, kF0, kEps };
    static constexpr double kSlowest_rad_s = 0.4;
    static constexpr double kLogRatio = 1.1512925464970229; ///< ln of sqrt(10), rate to rate
    static constexpr double kRatio = 3.1622776601683793;
    static constexpr double kFastest_rad_s = 4000.0;
    static constexpr double kLogSlowest = -0.9162907318741551;
    static constexpr double kLogFastest = 8.2940496401020276;

    template <class T>
    static T force_N(const T *p, const Motion<T> &m, const T *z, T *rates) {
        const T derivative = fractional_derivative(p[kPhi], m.v, z, rates);
        return p[kFc] * hyperbolic_tangent(derivative / p[kEps]) + p[kC] * derivative + p[kF0];
    }

    /// Trapezoidal rule in the logarithm of the rate; beyond its ends the geometric series of what
    /// would follow: below by one lag with the series' mean rate, above at once. States: z' = v -
    /// rate z.
    template <class T>
    static T fractional_derivative(const T &order, const T &v, const T *z, T *rates) {
        const T phi = clipped(order, T(1e-6), T(1.0 - 1e-6));
        const T step = exponential(T(kLogRatio) * phi);
        const T slow = exponential(T(kLogSlowest) * phi);
        const T slow_rate = T(kSlowest_rad_s) * (step - T(1.0)) / (step * T(kRatio) - T(1.0));
        rates[0] = v - slow_rate * z[0];
        T sum = slow / (step - T(1.0)) * z[0];
        T weight = slow;
        double rate_1_s = kSlowest_rad_s;
        for (int k = 1; k < kStates; ++k) {
            rates[k] = v - T(rate_1_s) * z[k];
            sum = sum + weight * z[k];
            weight = weight * step;
            rate_1_s *= kRatio;
        }
        const T left = T(1.0) - phi;
        const T fast =
            exponential(T(-kLogFastest) * left) / (exponential(T(kLogRatio) * left) - T(1.0));
        const T scale =
            T(kLogRatio / 3.14159265358979323846) * sine(T(3.14159265358979323846) * phi);
        return scale * (sum + fast * v);
    }

    template <class T>
    static T fastest_rate_1_s(const T * /*p*/, const T & /*speed_m_s*/) {
        return T(kFastest_rad_s);
    }
    /// The derivative's answer to a jump of the speed, which is that of the fastest lags.
    static double stiffest_N_s_m(const double *p) {
        return (std::abs(p[kC]) + p[kFc] / p[kEps]) * at_once(p[kPhi]);
    }
    static double stiffest_N_m(const double *p) {
        return (std::abs(p[kC]) + p[kFc] / p[kEps]) * std::pow(kFastest_rad_s, p[kPhi]);
    }
    static bool is_passive(const double *p) { return p[kFc] >= 0.0 && p[kC] >= 0.0; }

  private:
    /// Part of v that the derivative shows without a lag.
    static double at_once(double phi) {
        double z[kStates] = {};
        double rates[kStates] = {};
        return fractional_derivative(phi, 1.0, z, rates);
    }
};

} // namespace quiesce

#endif
