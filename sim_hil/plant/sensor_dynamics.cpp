#include "sensor_dynamics.h"

#include <cmath>

namespace quiesce {

namespace {

constexpr double kTwoPi = 6.28318530717958647692;

/// Keeps the drift from being the samples' noise.
constexpr std::uint64_t kDriftSeed = 0xD1B54A32D192ED03u;

} // namespace

LowPass::LowPass(double corner_Hz, double tick_s)
    : time_constant_s_(corner_Hz > 0.0 ? 1.0 / (kTwoPi * corner_Hz) : 0.0), tick_s_(tick_s),
      kept_(corner_Hz > 0.0 ? std::exp(-tick_s / time_constant_s_) : 0.0) {}

double LowPass::step(double in) {
    const double before = in_.value_or(in);
    out_ = in_ ? out_ : in;
    // Along a line it lags by slope x time constant, and forgets where it was off that.
    const double lag = (in - before) / tick_s_ * time_constant_s_;
    out_ = in - lag + kept_ * (out_ - before + lag);
    in_ = in;
    return out_;
}

SensorDynamics::SensorDynamics(const SensorParams &params, int tick_rate_Hz, std::uint64_t seed)
    : params_(params), band_(params.band_Hz, 1.0 / tick_rate_Hz),
      corner_(params.corner_Hz, 1.0 / tick_rate_Hz),
      drift_kept_(std::exp(-1.0 / (params.drift_s * tick_rate_Hz))), noise_(seed ^ kDriftSeed) {}

double SensorDynamics::drift() {
    const double fresh = std::sqrt(1.0 - drift_kept_ * drift_kept_);
    drift_ = drift_kept_ * drift_ + fresh * params_.drift * noise_.gaussian();
    return drift_;
}

double SensorDynamics::step(double value, double other, double coil_A) {
    double seen = value + params_.cross_talk * other + params_.cross_talk_per_A * coil_A;
    seen = params_.band_Hz > 0.0 ? band_.step(seen) : seen;
    seen -= params_.corner_Hz > 0.0 ? corner_.step(seen) : 0.0;
    return seen + (params_.drift > 0.0 ? drift() : 0.0);
}

} // namespace quiesce
