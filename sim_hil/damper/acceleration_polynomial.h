/// Force as a polynomial in the velocity, one for rising and one for falling velocity: what two
/// kernels share. Beyond the speed of the fit a polynomial explodes, so the velocity is limited.
#ifndef QUIESCE_ACCELERATION_POLYNOMIAL_H
#define QUIESCE_ACCELERATION_POLYNOMIAL_H

#include <algorithm>
#include <cmath>

#include "elementary.h"
#include "kernel.h"

namespace quiesce {

/// Factor of v^power in N (s/m)^power.
constexpr ParameterInfo polynomial_coefficient(const char *name, const char *unit, int power,
                                               const char *text) {
    return {name, unit, -kUnbounded, kUnbounded, -3.0, 3.0, {1, 0, -power}, true, true, text};
}

constexpr ParameterInfo kSpeedLimit{
    "v_max_m_s", "m/s",     1e-9,  1e3,   1.0,
    1.0,         {0, 0, 1}, false, false, "largest speed of the fit: faster counts as this"};

/// p: kOrder + 1 coefficients for a > 0, as many for a < 0, ascending, then the speed limit. At
/// a = 0 the mean of both.
template <int kOrder>
struct AccelerationPolynomial {
    static constexpr int kTerms = kOrder + 1;

    template <class T>
    static T force_N(const T *p, const Motion<T> &m) {
        const T limit = p[2 * kTerms];
        const T v = clipped(m.v, -limit, limit);
        T up = p[kOrder];
        T down = p[kTerms + kOrder];
        for (int k = kOrder - 1; k >= 0; --k) {
            up = up * v + p[k];
            down = down * v + p[kTerms + k];
        }
        const T part = T(0.5) + T(0.5) * sign(m.a);
        return part * up + (T(1.0) - part) * down;
    }

    static double stiffest_N_s_m(const double *p) {
        double steepest = 0.0;
        for (const double *side : {p, p + kTerms}) {
            double sum = 0.0;
            for (int k = 1; k < kTerms; ++k) {
                sum += k * std::abs(side[k]) * std::pow(p[2 * kTerms], k - 1);
            }
            steepest = std::max(steepest, sum);
        }
        return steepest;
    }

    /// Both polynomials odd with no coefficient below 0: the force opposes every velocity.
    static bool is_passive(const double *p) {
        for (int k = 0; k < 2 * kTerms; ++k) {
            const bool is_odd = k % kTerms % 2 == 1;
            if (is_odd ? p[k] < 0.0 : p[k] != 0.0) {
                return false;
            }
        }
        return true;
    }
};

} // namespace quiesce

#endif
