/// Terms of Psi (squeeze_psi.h) over x = G - 1, the film's wall stress beyond yield. Templates: for
/// a double, and for candidates side by side. 0 < gamma <= 1.
#ifndef QUIESCE_SQUEEZE_PSI_TERMS_H
#define QUIESCE_SQUEEZE_PSI_TERMS_H

namespace quiesce {

template <class T>
T cube(const T &x) {
    return x * x * x;
}

/// S - gamma/3 at G = 1 + x.
template <class T>
T squeeze_excess_at(const T &x, const T &gamma) {
    const T g = T(1.0) + x;
    return x * (x * (T(2.0) * x + T(3.0)) + gamma * (T(2.0) + x)) / (T(6.0) * g * g);
}

/// dS/dG at G = 1 + x.
template <class T>
T squeeze_shear_slope(const T &x, const T &gamma) {
    return (x * (T(3.0) + x * (T(3.0) + x)) + gamma) / (T(3.0) * cube(T(1.0) + x));
}

/// S^2 G dS/dG at G = 1 + x.
template <class T>
T squeeze_integrand(const T &x, const T &gamma) {
    const T shear = gamma / T(3.0) + squeeze_excess_at(x, gamma);
    return shear * shear * (T(1.0) + x) * squeeze_shear_slope(x, gamma);
}

/// chi^3 Psi of the film that is just about to yield.
template <class T>
T squeeze_unyielded_part(const T &gamma) {
    return cube(gamma) / T(108.0);
}

/// Antiderivative of S^2 G dS/dG at G = g, k = 1 - gamma. Loses digits where g is near 1.
template <class T>
T squeeze_antiderivative(const T &g, const T &log_g, const T &k) {
    const T g2 = g * g;
    const T g3 = g2 * g;
    return (g2 * g2 / T(36.0) - k * g3 / T(9.0) + k * k * g2 / T(8.0) + k * k / T(6.0) * log_g +
            cube(k) / (T(4.0) * g) + k * k / (T(24.0) * g2) - cube(k) / (T(18.0) * g3) +
            cube(k) / (T(180.0) * g2 * g3)) /
           T(3.0);
}

} // namespace quiesce

#endif
