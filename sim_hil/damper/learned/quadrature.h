/// Envelope, instantaneous frequency and phase of a displacement, from its past only.
///
/// The published features are those of the analytic signal x + j H[x], whose Hilbert transform H
/// needs the whole record, the future included. In place of H[x] stands what it is for a swing of
/// one frequency, -v / w, with w from running means over a window:
///
///   w = sqrt(mean(v^2) / mean(x^2)),  d = sqrt(x^2 + (v/w)^2),  x = d cos p,  -v/w = d sin p
///
/// Both means start at 0 and share their window, so that their ratio holds from the first sample.
/// The phase is a pair, cos p and sin p: p itself jumps. Source: review of MR damper models, eq 34.
#ifndef QUIESCE_QUADRATURE_H
#define QUIESCE_QUADRATURE_H

#include <array>
#include <cstddef>

namespace quiesce {

/// d, w (both scaled from -1 at the least to 1 at the most), cos p, sin p.
constexpr std::size_t kQuadratureFeatures = 4;
/// Running means of x^2 and v^2.
constexpr std::size_t kQuadratureStates = 2;
using QuadratureFeatures = std::array<double, kQuadratureFeatures>;

struct QuadratureParams {
    double window_s;      ///< > 0
    double envelope_m;    ///< > 0; largest, cut off there; below a thousandth of it is rest
    double lowest_rad_s;  ///< > 0; w is cut off here
    double highest_rad_s; ///< > lowest_rad_s
};

/// Takes a sample into the means; dt_s: the sample time.
void update_quadrature(const QuadratureParams &params, double position_m, double velocity_m_s,
                       double dt_s, double *means);

/// All 0 at rest.
QuadratureFeatures quadrature_features(const QuadratureParams &params, double position_m,
                                       double velocity_m_s, const double *means);

} // namespace quiesce

#endif
