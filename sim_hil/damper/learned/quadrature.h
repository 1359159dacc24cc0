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

#include "sampled_network_core.h"

namespace quiesce {

/// d, w (both scaled from -1 at the least to 1 at the most), cos p, sin p.
using QuadratureFeatures = std::array<double, quiesce_quadrature_features>;

/// window_s, envelope_m (largest, cut off there) and lowest_rad_s > 0; w is cut off at it and at
/// highest_rad_s > lowest_rad_s.
using QuadratureParams = quiesce_quadrature;

/// Takes a sample into the means; dt_s: the sample time.
void update_quadrature(const QuadratureParams &params, double position_m, double velocity_m_s,
                       double dt_s, double *means);

/// All 0 at rest.
QuadratureFeatures quadrature_features(const QuadratureParams &params, double position_m,
                                       double velocity_m_s, const double *means);

} // namespace quiesce

#endif
