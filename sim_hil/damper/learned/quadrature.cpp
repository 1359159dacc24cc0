#include "quadrature.h"

#include <algorithm>
#include <cmath>

namespace quiesce {

namespace {

/// Of the largest envelope: less is rest, which has neither frequency nor phase.
constexpr double kRest = 1e-3;

double scaled(double value, double low, double high) {
    return 2.0 * (std::clamp(value, low, high) - low) / (high - low) - 1.0;
}

} // namespace

void update_quadrature(const QuadratureParams &params, double position_m, double velocity_m_s,
                       double dt_s, double *means) {
    const double part = dt_s / (params.window_s + dt_s);
    means[0] += part * (position_m * position_m - means[0]);
    means[1] += part * (velocity_m_s * velocity_m_s - means[1]);
}

QuadratureFeatures quadrature_features(const QuadratureParams &params, double position_m,
                                       double velocity_m_s, const double *means) {
    const double rest_m = kRest * params.envelope_m;
    const double raw_rad_s = std::sqrt(means[1] / std::max(means[0], rest_m * rest_m));
    const double frequency_rad_s = std::clamp(raw_rad_s, params.lowest_rad_s, params.highest_rad_s);
    const double quadrature_m = -velocity_m_s / frequency_rad_s;
    const double envelope_m = std::hypot(position_m, quadrature_m);
    if (envelope_m < rest_m) {
        return {};
    }
    return {scaled(envelope_m, 0.0, params.envelope_m),
            scaled(frequency_rad_s, params.lowest_rad_s, params.highest_rad_s),
            position_m / envelope_m, quadrature_m / envelope_m};
}

} // namespace quiesce
