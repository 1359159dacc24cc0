#include "hysteresis_network.h"

#include <algorithm>
#include <cmath>
#include <numeric>

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
    : params_(std::move(params)), members_(std::move(members)) {}

std::size_t HysteresisNetwork::own_states() const {
    return params_.coil_times_s.size() + params_.elastic_times_s.size() +
           params_.chain_times_s.size() + params_.stop_reaches_m.size();
}

std::size_t HysteresisNetwork::state_count() const {
    return own_states() + (params_.base ? params_.base->state_count() : 0);
}

bool HysteresisNetwork::uses_accel() const {
    return params_.uses_accel || (params_.base && params_.base->uses_accel());
}

void HysteresisNetwork::write_rates(const DamperInput &input, const double *state,
                                    double *rates) const {
    const double v = input.velocity_m_s;
    for (std::size_t j = 0; j < params_.coil_times_s.size(); ++j) {
        const double rise_A = input.current_A - *state++;
        const std::vector<double> &times =
            rise_A > 0.0 ? params_.coil_times_s : params_.coil_fall_times_s;
        *rates++ = rise_A / times[j];
    }
    for (const double time_s : params_.elastic_times_s) {
        *rates++ = v - *state++ / time_s;
    }
    double from = v;
    for (const double time_s : params_.chain_times_s) {
        *rates++ = (from - *state) / time_s;
        from = *state++;
    }
    for (const double reach_m : params_.stop_reaches_m) {
        *rates++ = (v - std::abs(v) * *state++) / reach_m;
    }
}

/// state: this model's own elements.
std::vector<double> HysteresisNetwork::features(const DamperInput &input, const double *state,
                                                double base_N) const {
    std::vector<double> out{input.position_m, input.velocity_m_s};
    if (params_.uses_accel) {
        out.push_back(input.accel_m_s2);
    }
    out.insert(out.end(), state, state + own_states());
    if (params_.base) {
        out.push_back(base_N);
    }
    for (std::size_t k = 0; k < out.size(); ++k) {
        out[k] = std::clamp((out[k] - params_.means[k]) / params_.scales[k], -params_.clip,
                            params_.clip);
    }
    return out;
}

/// Of full current, 0 .. 1.
double HysteresisNetwork::field(double current_A) const {
    const double part = std::max(0.0, current_A / params_.current_scale_A);
    const double toe = std::pow(part, params_.field_exponent);
    return toe * (1.0 + params_.saturation) / (params_.saturation + toe);
}

/// What the networks add to the base.
double HysteresisNetwork::correction_N(const std::vector<double> &features,
                                       double current_A) const {
    std::vector<double> heads(members_.front().output_count(), 0.0);
    std::vector<double> one(heads.size());
    for (const Network &member : members_) {
        member.run(features.data(), one.data());
        for (std::size_t k = 0; k < heads.size(); ++k) {
            heads[k] += one[k] / static_cast<double>(members_.size());
        }
    }
    const double g = field(current_A);
    const double *skip = params_.skip.data();
    double power = 1.0;
    double sum = 0.0;
    for (const double head : heads) {
        sum += power * std::inner_product(features.begin(), features.end(), skip, head);
        skip += features.size();
        power *= g;
    }
    return params_.force_scale_N * sum;
}

/// 0 without a base. state and rates: those of all elements.
double HysteresisNetwork::base_N(const DamperInput &input, double current_A, const double *state,
                                 double *rates) const {
    if (!params_.base) {
        return 0.0;
    }
    DamperInput seen = input;
    seen.current_A = current_A;
    return params_.base->force_N(seen, state + own_states(),
                                 rates == nullptr ? nullptr : rates + own_states());
}

double HysteresisNetwork::force_N(const DamperInput &input, const double *state,
                                  double *rates) const {
    // A base with states writes its rates in any case.
    std::vector<double> unused(rates == nullptr ? state_count() : 0);
    double *out = rates == nullptr ? unused.data() : rates;
    write_rates(input, state, out);
    const double current_A = params_.coil_times_s.empty() ? input.current_A : state[0];
    const double from_base_N = base_N(input, current_A, state, out);
    return from_base_N + correction_N(features(input, state, from_base_N), current_A);
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
