/// The hysteretic state that several kernels share, in its printed form:
///
///   z' = A v - gamma |v| z |z|^(n-1) - beta v |z|^n
///
/// |z| stays below (A / (beta + gamma))^(1/n) =: z_max; the pre-yield travel is z_max / A. Of A,
/// beta, gamma and the factor of z in the force one is redundant; kernels/normalised_bouc_wen.h is
/// the form without it. Dissipative for gamma >= |beta|.
#ifndef QUIESCE_BOUC_WEN_STATE_H
#define QUIESCE_BOUC_WEN_STATE_H

#include <algorithm>
#include <cmath>

#include "elementary.h"

namespace quiesce {

/// A >= 0, gamma >= 0, n >= 1.
template <class T>
struct BoucWenShape {
    T a;
    T beta;
    T gamma;
    T n;
};

/// beta no lower than -0.99 gamma: below -gamma the state runs away. Unloading is then at most 200
/// times as steep as first loading.
template <class T>
T bounded_beta(const T &beta, const T &gamma) {
    return larger(beta, T(-0.99) * gamma);
}

template <class T>
T bouc_wen_rate(const BoucWenShape<T> &p, const T &v, const T &z) {
    const T size = power(absolute(z), p.n);
    const T loading = p.a - (p.beta + p.gamma) * size;
    // Below 0 only above z_max, where a changing current may leave z: it must come back.
    const T unloading = larger(p.a - (p.beta - p.gamma) * size, T(0.0));
    return v * select(v * z < T(0.0), unloading, loading);
}

/// Largest |d z' / d z| for |z| <= z_max.
template <class T>
T bouc_wen_fastest_1_s(const BoucWenShape<T> &p, const T &speed_m_s) {
    const T sum = p.beta + p.gamma;
    const T rate = p.n * larger(sum, absolute(p.gamma - p.beta)) *
                   power(p.a / larger(sum, T(1e-300)), (p.n - T(1.0)) / p.n) * speed_m_s;
    return select(smaller(p.a, sum) > T(0.0), rate, T(0.0));
}

/// Largest dz/dx for |z| <= z_max.
inline double bouc_wen_steepest(const BoucWenShape<double> &p) {
    const double sum = p.beta + p.gamma;
    return p.a * (sum > 0.0 ? std::max(1.0, 2.0 * p.gamma / sum) : 1.0);
}

/// The state gives out no more energy than was put in.
inline bool is_dissipative(const BoucWenShape<double> &p) {
    return p.a >= 0.0 && p.gamma >= std::abs(p.beta);
}

} // namespace quiesce

#endif
