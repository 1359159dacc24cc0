#include "sampled_network.h"

#include <algorithm>

namespace quiesce {

SampledNetwork::SampledNetwork(InputBox box, SampledNetworkParams params, Network network)
    : box_(std::move(box)), params_(std::move(params)), network_(std::move(network)) {
    for (std::size_t k = 0; k < box_.count(); ++k) {
        low_.push_back(box_.range(k).min);
        high_.push_back(box_.range(k).max);
    }
    layers_ = network_.core();
    core_ = core();
    states_ = static_cast<std::size_t>(quiesce_sampled_states(&core_));
}

quiesce_sampled SampledNetwork::core() const {
    return {params_.sample_time_s,
            params_.force_scale_N,
            static_cast<int>(box_.count()),
            low_.data(),
            high_.data(),
            params_.lags.data(),
            static_cast<int>(params_.lags.size()),
            params_.feedback.data(),
            static_cast<int>(params_.feedback.size()),
            params_.quadrature ? &*params_.quadrature : nullptr,
            layers_.data(),
            static_cast<int>(layers_.size()),
            static_cast<int>(network_.widest())};
}

void SampledNetwork::take_sample(const DamperInput &input, double *state) const {
    std::vector<double> room(network_.input_count() + 2 * network_.widest());
    const Inputs picked = box_.picked(input);
    quiesce_sampled_take(&core_, picked.data(), input.position_m, input.velocity_m_s, state,
                         room.data());
}

double SampledNetwork::force_N(const DamperInput &input, const double *state, double *rates) const {
    if (rates != nullptr) {
        std::fill_n(rates, state_count(), 0.0);
    }
    if (state[quiesce_sampled_started] != 0.0) {
        return state[quiesce_sampled_held];
    }
    // Nothing has been sampled yet: rest before now.
    std::vector<double> first(state, state + state_count());
    take_sample(input, first.data());
    return first[quiesce_sampled_held];
}

void SampledNetwork::after_step(const DamperInput &input, double *state, double dt_s) const {
    if (quiesce_sampled_is_due(params_.sample_time_s, dt_s, state)) {
        take_sample(input, state);
    }
}

double SampledNetwork::stiffest_N_s_m(double /*current_A*/) const {
    // Between samples the force is constant.
    return 0.0;
}

} // namespace quiesce
