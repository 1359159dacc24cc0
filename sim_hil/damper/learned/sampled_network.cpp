#include "sampled_network.h"

#include <algorithm>

namespace quiesce {

namespace {

constexpr std::size_t kClock = 0;
constexpr std::size_t kStarted = 1;
constexpr std::size_t kHeld = 2;
constexpr std::size_t kMeans = 3; // of the quadrature

/// A sample is due when its time has come to this part of it: times are sums of steps.
constexpr double kDue = 1.0 - 1e-6;

} // namespace

SampledNetwork::SampledNetwork(InputBox box, SampledNetworkParams params, Network network)
    : box_(std::move(box)), params_(std::move(params)), network_(std::move(network)),
      width_(box_.count() + (params_.quadrature ? kQuadratureFeatures : 0)),
      first_moment_(kMeans + (params_.quadrature ? kQuadratureStates : 0)),
      moment_count_(params_.lags.back() + 1),
      force_count_(params_.feedback.empty() ? 0 : params_.feedback.back()),
      first_force_(first_moment_ + moment_count_ * width_) {}

/// From the delayed values in the state.
double SampledNetwork::evaluated_N(const double *state) const {
    std::vector<double> in;
    in.reserve(network_.input_count());
    for (const std::size_t lag : params_.lags) {
        const double *moment = state + first_moment_ + lag * width_;
        for (std::size_t k = 0; k < box_.count(); ++k) {
            in.push_back(box_.scaled(k, moment[k]));
        }
        in.insert(in.end(), moment + box_.count(), moment + width_);
    }
    for (const std::size_t lag : params_.feedback) {
        in.push_back(state[first_force_ + lag - 1] / params_.force_scale_N);
    }
    double out = 0.0;
    network_.run(in.data(), &out);
    return params_.force_scale_N * out;
}

void SampledNetwork::take_sample(const DamperInput &input, double *state) const {
    double *moments = state + first_moment_;
    std::copy_backward(moments, moments + (moment_count_ - 1) * width_,
                       moments + moment_count_ * width_);
    const Inputs now = box_.picked(input);
    std::copy_n(now.begin(), box_.count(), moments);
    if (params_.quadrature) {
        double *means = state + kMeans;
        update_quadrature(*params_.quadrature, input.position_m, input.velocity_m_s,
                          params_.sample_time_s, means);
        const QuadratureFeatures features =
            quadrature_features(*params_.quadrature, input.position_m, input.velocity_m_s, means);
        std::copy(features.begin(), features.end(), moments + box_.count());
    }
    state[kHeld] = evaluated_N(state);
    if (force_count_ > 0) {
        double *forces = state + first_force_;
        std::copy_backward(forces, forces + force_count_ - 1, forces + force_count_);
        forces[0] = state[kHeld];
    }
    state[kStarted] = 1.0;
}

double SampledNetwork::force_N(const DamperInput &input, const double *state, double *rates) const {
    if (rates != nullptr) {
        std::fill_n(rates, state_count(), 0.0);
    }
    if (state[kStarted] != 0.0) {
        return state[kHeld];
    }
    // Nothing has been sampled yet: rest before now.
    std::vector<double> first(state, state + state_count());
    take_sample(input, first.data());
    return first[kHeld];
}

void SampledNetwork::after_step(const DamperInput &input, double *state, double dt_s) const {
    state[kClock] += dt_s;
    if (state[kClock] >= kDue * params_.sample_time_s) {
        state[kClock] -= params_.sample_time_s;
        if (state[kClock] >= kDue * params_.sample_time_s) {
            state[kClock] = 0.0; // steps longer than the sample time: a sample at each
        }
        take_sample(input, state);
    }
}

double SampledNetwork::stiffest_N_s_m(double /*current_A*/) const {
    // Between samples the force is constant.
    return 0.0;
}

} // namespace quiesce
