#include "hysteresis_network.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace quiesce {

namespace {

/// Points on either side of rest at which slopes are taken.
constexpr int kPoints = 20;

} // namespace

std::size_t feature_count(const HysteresisNetworkParams &p) {
    return 2 + (p.uses_accel ? 1 : 0) + p.coil_times_s.size() + p.elastic_times_s.size() +
           p.chain_times_s.size() + p.stop_reaches_m.size() + (p.base ? 1 : 0);
}

HysteresisNetwork::HysteresisNetwork(HysteresisNetworkParams params, std::vector<Network> members)
    : params_(std::move(params)), members_(std::move(members)) {
    for (const Network &member : members_) {
        layers_.push_back(member.core());
        widest_ = std::max(widest_, member.widest());
    }
    for (const std::vector<quiesce_layer> &layers : layers_) {
        first_layers_.push_back(layers.data());
        layer_counts_.push_back(static_cast<int>(layers.size()));
    }
    core_ = core();
    own_states_ = static_cast<std::size_t>(quiesce_hysteresis_states(&core_));
}

quiesce_hysteresis HysteresisNetwork::core() const {
    const HysteresisNetworkParams &p = params_;
    const auto size = [](const std::vector<double> &values) {
        return static_cast<int>(values.size());
    };
    return {p.force_scale_N,
            p.current_scale_A,
            p.field_exponent,
            p.saturation,
            p.clip,
            p.uses_accel ? 1 : 0,
            p.base ? 1 : 0,
            size(p.coil_times_s),
            p.coil_times_s.data(),
            p.coil_fall_times_s.data(),
            size(p.elastic_times_s),
            p.elastic_times_s.data(),
            size(p.chain_times_s),
            p.chain_times_s.data(),
            size(p.stop_reaches_m),
            p.stop_reaches_m.data(),
            p.means.data(),
            p.scales.data(),
            p.skip.data(),
            size(p.means),
            static_cast<int>(members_.front().output_count()),
            first_layers_.data(),
            layer_counts_.data(),
            static_cast<int>(members_.size()),
            static_cast<int>(widest_)};
}

std::size_t HysteresisNetwork::state_count() const {
    return own_states_ + (params_.base ? params_.base->state_count() : 0);
}

bool HysteresisNetwork::uses_accel() const {
    return params_.uses_accel || (params_.base && params_.base->uses_accel());
}

/// What the networks add to the base. state: this model's own elements.
double HysteresisNetwork::added_N(const DamperInput &input, double current_A, double base_N,
                                  const double *state) const {
    const std::size_t features = params_.means.size();
    std::vector<double> room(features + 2 * members_.front().output_count() + 2 * widest_);
    const std::array motion = {input.position_m, input.velocity_m_s, input.accel_m_s2};
    quiesce_hysteresis_features(&core_, motion.data(), base_N, state, room.data());
    return quiesce_hysteresis_added_N(&core_, room.data(), current_A, room.data() + features);
}

/// 0 without a base. state and rates: those of all elements.
double HysteresisNetwork::base_N(const DamperInput &input, double current_A, const double *state,
                                 double *rates) const {
    if (!params_.base) {
        return 0.0;
    }
    DamperInput seen = input;
    seen.current_A = current_A;
    return params_.base->force_N(seen, state + own_states_,
                                 rates == nullptr ? nullptr : rates + own_states_);
}

double HysteresisNetwork::force_N(const DamperInput &input, const double *state,
                                  double *rates) const {
    // A base with states writes its rates in any case.
    std::vector<double> unused(rates == nullptr ? state_count() : 0);
    double *out = rates == nullptr ? unused.data() : rates;
    quiesce_hysteresis_rates(&core_, input.velocity_m_s, input.current_A, state, out);
    const double current_A = quiesce_hysteresis_current_A(&core_, input.current_A, state);
    const double from_base_N = base_N(input, current_A, state, out);
    return from_base_N + added_N(input, current_A, from_base_N, state);
}

/// The elements after a quick move from rest; those of a base stay at rest.
std::vector<double> HysteresisNetwork::quick_state(double moved_m, double current_A) const {
    std::vector<double> out(params_.coil_times_s.size(), current_A);
    out.insert(out.end(), params_.elastic_times_s.size(), moved_m);
    out.insert(out.end(), params_.chain_times_s.size(), 0.0);
    for (const double reach_m : params_.stop_reaches_m) {
        out.push_back(std::copysign(1.0 - std::exp(-std::abs(moved_m) / reach_m), moved_m));
    }
    out.resize(state_count(), 0.0);
    return out;
}

double HysteresisNetwork::quick_force_N(double moved_m, double current_A) const {
    return force_N({0.0, moved_m, current_A}, quick_state(moved_m, current_A).data(), nullptr);
}

double HysteresisNetwork::stiffest_N_s_m(double current_A) const {
    const std::vector<double> rest = quick_state(0.0, current_A);
    const double step_m_s = params_.speed_m_s / kPoints;
    double most = params_.base ? params_.base->stiffest_N_s_m(current_A) : 0.0;
    for (int k = -kPoints; k < kPoints; ++k) {
        const double from_N = force_N({step_m_s * k, 0.0, current_A}, rest.data(), nullptr);
        const double to_N = force_N({step_m_s * (k + 1), 0.0, current_A}, rest.data(), nullptr);
        most = std::max(most, std::abs(to_N - from_N) / step_m_s);
    }
    return most;
}

double HysteresisNetwork::stiffest_N_m(double current_A) const {
    double smallest_m = params_.stroke_m;
    for (const double reach_m : params_.stop_reaches_m) {
        smallest_m = std::min(smallest_m, reach_m);
    }
    const double step_m = 0.1 * smallest_m;
    double most = params_.base ? params_.base->stiffest_N_m(current_A) : 0.0;
    for (int k = -kPoints; k < kPoints; ++k) {
        const double rise_N =
            quick_force_N(step_m * (k + 1), current_A) - quick_force_N(step_m * k, current_A);
        most = std::max(most, std::abs(rise_N) / step_m);
    }
    return most;
}

double HysteresisNetwork::fastest_rate_1_s(double current_A) const {
    double most = params_.base ? params_.base->fastest_rate_1_s(current_A) : 0.0;
    for (const std::vector<double> *times : {&params_.coil_times_s, &params_.coil_fall_times_s,
                                             &params_.elastic_times_s, &params_.chain_times_s}) {
        for (const double time_s : *times) {
            most = std::max(most, 1.0 / time_s);
        }
    }
    for (const double reach_m : params_.stop_reaches_m) {
        most = std::max(most, params_.speed_m_s / reach_m);
    }
    return most;
}

} // namespace quiesce
