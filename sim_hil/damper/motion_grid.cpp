#include "motion_grid.h"

namespace quiesce {

namespace {

/// Cubic between two samples, part of the way u in 0 .. 1 over width, from values and slopes.
double hermite(double from, double slope_from, double to, double slope_to, double width, double u) {
    const double rise = to - from;
    const double a = slope_from * width - rise;
    const double b = rise - slope_to * width;
    return from + u * rise + u * (1.0 - u) * ((1.0 - u) * a + u * b);
}

double linear(double from, double to, double u) {
    return from + u * (to - from);
}

} // namespace

MotionGrid::MotionGrid(const MotionSamples &samples, int substeps)
    : steps_((samples.count - 1) * static_cast<std::size_t>(substeps)), substeps_(substeps),
      step_s_(samples.step_s / substeps), values_(4 * (2 * steps_ + 1)) {
    const auto halves = 2 * static_cast<std::size_t>(substeps);
    const double *x = samples.disp_m;
    const double *v = samples.velocity_m_s;
    const double *a = samples.accel_m_s2;
    const double *command = samples.command_A;
    for (std::size_t k = 0; k + 1 < samples.count; ++k) {
        for (std::size_t half = 0; half < halves; ++half) {
            const double u = static_cast<double>(half) / static_cast<double>(halves);
            double *out = values_.data() + 4 * (k * halves + half);
            out[0] = hermite(x[k], v[k], x[k + 1], v[k + 1], samples.step_s, u);
            out[1] = hermite(v[k], a[k], v[k + 1], a[k + 1], samples.step_s, u);
            out[2] = linear(a[k], a[k + 1], u);
            out[3] = linear(command[k], command[k + 1], u);
        }
    }
    const std::size_t last = samples.count - 1;
    double *out = values_.data() + 4 * (2 * steps_);
    out[0] = x[last];
    out[1] = v[last];
    out[2] = a[last];
    out[3] = command[last];
}

} // namespace quiesce
