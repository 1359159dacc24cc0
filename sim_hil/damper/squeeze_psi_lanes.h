/// Psi (squeeze_psi.h) for many gammas at once: the same steps in every lane, no table. Within 1e-9
/// relative of the quadrature for chi >= 0 and 1e-12 <= gamma <= 1.
#ifndef QUIESCE_SQUEEZE_PSI_LANES_H
#define QUIESCE_SQUEEZE_PSI_LANES_H

#include "elementary.h"
#include "squeeze_psi_terms.h"

namespace quiesce {

/// Steps of Newton's method that take every start to its last digits.
constexpr int kWallNewtonSteps = 6;

/// G - 1 at excess = S - gamma/3 >= 0. Newton from above, as squeeze_wall_excess.
template <class T>
T squeeze_wall_excess_of(const T &excess, const T &gamma) {
    const T far = T(3.0) * excess + T(0.5) * (T(1.0) - gamma);
    const T near = smaller(far, T(2.2) * square_root(excess));
    T x = select(excess < T(0.2), near, far);
    for (int i = 0; i < kWallNewtonSteps; ++i) {
        const T g = T(1.0) + x;
        const T above =
            g * x * (x * (T(2.0) * x + T(3.0)) + gamma * (T(2.0) + x)) - T(6.0) * cube(g) * excess;
        const T slope = T(2.0) * (x * (T(3.0) + x * (T(3.0) + x)) + gamma);
        x = larger(x - above / slope, T(0.0));
    }
    return x;
}

/// Integral of S^2 G dS over G = 1 .. 1 + x by Gauss' rule of 10 points; for x <= 1 to 1e-11.
template <class T>
T squeeze_gauss_part(const T &x, const T &gamma) {
    constexpr int kHalf = 5;
    constexpr double kNode[kHalf] = {0.148874338981631211, 0.433395394129247191,
                                     0.679409568299024406, 0.865063366688984511,
                                     0.973906528517171720};
    constexpr double kWeight[kHalf] = {0.295524224714752870, 0.269266719309996355,
                                       0.219086362515982044, 0.149451349150580593,
                                       0.0666713443086881376};
    T sum = T(0.0);
    for (int i = 0; i < kHalf; ++i) {
        const T low = x * T(0.5 - 0.5 * kNode[i]);
        const T high = x * T(0.5 + 0.5 * kNode[i]);
        sum =
            sum + T(kWeight[i]) * (squeeze_integrand(low, gamma) + squeeze_integrand(high, gamma));
    }
    return T(0.5) * x * sum;
}

/// Psi; chi = 0 gives 0.
template <class T>
T squeeze_psi_of(const T &chi, const T &gamma) {
    const T yield_chi = gamma / T(3.0);
    const T x = squeeze_wall_excess_of(larger(chi - yield_chi, T(0.0)), gamma);
    const T k = T(1.0) - gamma;
    const T g = T(1.0) + x;
    const T closed =
        squeeze_antiderivative(g, logarithm(g), k) - squeeze_antiderivative(T(1.0), T(0.0), k);
    const T integral = select(x < T(1.0), squeeze_gauss_part(x, gamma), closed);
    const T yielded = (squeeze_unyielded_part(gamma) + integral) / cube(chi);
    return select(chi > yield_chi, yielded, T(0.75) * chi / gamma);
}

} // namespace quiesce

#endif
