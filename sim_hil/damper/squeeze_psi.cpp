#include "squeeze_psi.h"

#include <algorithm>
#include <cmath>
#include <cstring>

#include "squeeze_psi_terms.h"

namespace quiesce {

namespace {

/// Nodes and weights of the 16-point Gauss-Legendre rule on [-1, 1], positive half.
constexpr int kHalfNodes = 8;
constexpr double kNode[kHalfNodes] = {
    0.0950125098376374402, 0.281603550779258913, 0.458016777657227386, 0.617876244402643748,
    0.755404408355003034,  0.865631202387831744, 0.944575023073232576, 0.989400934991649933};
constexpr double kWeight[kHalfNodes] = {
    0.189450610455068496, 0.182603415044923589,  0.169156519395002538,  0.149595988816576732,
    0.124628971255533872, 0.0951585116824927848, 0.0622535239386478929, 0.0271524594117540949};

/// Integral of the integrand over [from, to] in x = G - 1.
double panel(double from, double to, double gamma) {
    const double half = 0.5 * (to - from);
    const double middle = from + half;
    double sum = 0.0;
    for (int i = 0; i < kHalfNodes; ++i) {
        const double offset = half * kNode[i];
        sum += kWeight[i] * (squeeze_integrand(middle - offset, gamma) +
                             squeeze_integrand(middle + offset, gamma));
    }
    return half * sum;
}

/// Psi and its first two derivatives by chi.
struct Jet {
    double value;
    double slope;
    double curvature;
};

Jet psi_jet(double excess, double gamma) {
    const double chi = gamma / 3.0 + excess;
    const double x = squeeze_wall_excess(excess, gamma);
    const double psi = squeeze_psi_quadrature(chi, gamma);
    const double slope = (1.0 + x - 3.0 * psi) / chi;
    return {psi, slope, (1.0 / squeeze_shear_slope(x, gamma) - 4.0 * slope) / chi};
}

} // namespace

double squeeze_wall_excess(double excess, double gamma) {
    // S is convex in G, so that Newton from above converges monotonically. Two upper bounds: the
    // asymptote G <= 3 S + 3/2 (1 - gamma), and x^2/2 (1 + ..) <= excess near the yield point.
    const double shear = gamma / 3.0 + excess;
    double x = std::max(3.0 * shear + 1.5 * (1.0 - gamma) - 1.0, 0.0);
    if (excess < 0.01) {
        x = std::min(x, 1.2 * std::sqrt(2.0 * excess));
    }
    for (int i = 0; i < 60; ++i) {
        const double step = (squeeze_excess_at(x, gamma) - excess) / squeeze_shear_slope(x, gamma);
        x = std::max(x - step, 0.0);
        if (std::abs(step) <= 1e-16 * x) {
            break;
        }
    }
    return x;
}

double squeeze_psi_quadrature(double chi, double gamma) {
    if (chi <= gamma / 3.0) {
        return 0.75 * chi / gamma;
    }
    const double end = squeeze_wall_excess(chi - gamma / 3.0, gamma);
    double sum = squeeze_unyielded_part(gamma);
    double from = 0.0;
    while (from < end) {
        // Panels of ratio 2 in G keep the pole at G = 0 away from each.
        const double to = std::min(end, 2.0 * from + 1.0);
        sum += panel(from, to, gamma);
        from = to;
    }
    return sum / cube(chi);
}

double squeeze_psi_closed_form(double chi, double gamma) {
    if (chi <= gamma / 3.0) {
        return 0.75 * chi / gamma;
    }
    const double k = 1.0 - gamma;
    const double g = 1.0 + squeeze_wall_excess(chi - gamma / 3.0, gamma);
    return (squeeze_unyielded_part(gamma) + squeeze_antiderivative(g, std::log(g), k) -
            squeeze_antiderivative(1.0, 0.0, k)) /
           cube(chi);
}

double SqueezePsi::octave_start(std::uint64_t index) {
    const std::uint64_t bits = index << (52 - kMantissaBits);
    double x = 0.0;
    std::memcpy(&x, &bits, sizeof x);
    return x;
}

SqueezePsi::SqueezePsi(double gamma)
    : gamma_(gamma), yield_chi_(gamma / 3.0), yield_slope_(0.75 / gamma) {
    // Past yield Psi leaves its pre-yield line by 13.5 d^3 (1 - gamma)/gamma^4: below 1e-11 of 1/4.
    const double negligible = std::cbrt(1.8e-13 * std::pow(gamma, 4.0));
    first_index_ = octave_index(negligible);
    linear_to_ = octave_start(first_index_);
    const std::uint64_t end_index = octave_index(kAsymptoteFrom);
    for (std::uint64_t index = first_index_; index <= end_index; ++index) {
        pieces_.push_back(fit_piece(octave_start(index), octave_start(index + 1)));
    }
}

SqueezePsi::Piece SqueezePsi::fit_piece(double start, double end) const {
    const double width = end - start;
    const Jet a = psi_jet(start, gamma_);
    const Jet b = psi_jet(end, gamma_);
    const double slope_a = a.slope * width;
    const double bend_a = 0.5 * a.curvature * width * width;
    const double rise = b.value - a.value - slope_a - bend_a;
    const double slope_b = b.slope * width - slope_a - 2.0 * bend_a;
    const double bend_b = 0.5 * (b.curvature * width * width - 2.0 * bend_a);
    return {start,
            1.0 / width,
            {a.value, slope_a, bend_a, 10.0 * rise - 4.0 * slope_b + bend_b,
             -15.0 * rise + 7.0 * slope_b - 2.0 * bend_b, 6.0 * rise - 3.0 * slope_b + bend_b}};
}

double SqueezePsi::asymptote(double chi) const {
    const double k = 1.0 - gamma_;
    return 0.75 * chi + 0.5 * k - k / (18.0 * chi * chi);
}

} // namespace quiesce
