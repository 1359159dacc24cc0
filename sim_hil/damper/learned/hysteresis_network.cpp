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
           p.chain_count + p.stop_reaches_m.size();
}

HysteresisNetwork::HysteresisNetwork(HysteresisNetworkParams params, Network network)
    : params_(std::move(params)), network_(std::move(network)) {}

std::size_t HysteresisNetwork::state_count() const {
    return params_.coil_times_s.size() + params_.elastic_times_s.size() + params_.chain_count +
           params_.stop_reaches_m.size();
}

void HysteresisNetwork::write_rates(const DamperInput &input, const double *state,
                                    double *rates) const {
    const double v = input.velocity_m_s;
    for (const double time_s : params_.coil_times_s) {
        *rates++ = (input.current_A - *state++) / time_s;
    }
    for (const double time_s : params_.elastic_times_s) {
        *rates++ = v - *state++ / time_s;
    }
    double from = v;
    for (std::size_t k = 0; k < params_.chain_count; ++k) {
        *rates++ = (from - *state) / params_.chain_time_s;
        from = *state++;
    }
    for (const double reach_m : params_.stop_reaches_m) {
        *rates++ = (v - std::abs(v) * *state++) / reach_m;
    }
}

std::vector<double> HysteresisNetwork::features(const DamperInput &input,
                                                const double *state) const {
    std::vector<double> out{input.position_m, input.velocity_m_s};
    if (params_.uses_accel) {
        out.push_back(input.accel_m_s2);
    }
    out.insert(out.end(), state, state + state_count());
    for (std::size_t k = 0; k < out.size(); ++k) {
        out[k] = std::clamp((out[k] - params_.means[k]) / params_.scales[k], -params_.clip,
                            params_.clip);
    }
    return out;
}

double HysteresisNetwork::force_N(const DamperInput &input, const double *state,
                                  double *rates) const {
    if (rates != nullptr) {
        write_rates(input, state, rates);
    }
    const std::vector<double> p = features(input, state);
    std::vector<double> heads(network_.output_count());
    network_.run(p.data(), heads.data());
    const double current_A = params_.coil_times_s.empty() ? input.current_A : state[0];
    const double s = current_A / params_.current_scale_A;
    const double *skip = params_.skip.data();
    double power = 1.0;
    double sum = 0.0;
    for (const double head : heads) {
        double linear = 0.0;
        for (const double feature : p) {
            linear += *skip++ * feature;
        }
        sum += power * (head + linear);
        power *= s;
    }
    return params_.force_scale_N * sum;
}

/// The elements after a quick move from rest.
std::vector<double> HysteresisNetwork::quick_state(double moved_m, double current_A) const {
    std::vector<double> out(params_.coil_times_s.size(), current_A);
    out.insert(out.end(), params_.elastic_times_s.size(), moved_m);
    out.insert(out.end(), params_.chain_count, 0.0);
    for (const double reach_m : params_.stop_reaches_m) {
        out.push_back(std::copysign(1.0 - std::exp(-std::abs(moved_m) / reach_m), moved_m));
    }
    return out;
}

double HysteresisNetwork::stiffest_N_s_m(double current_A) const {
    const std::vector<double> rest = quick_state(0.0, current_A);
    const double step_m_s = params_.speed_m_s / kPoints;
    double most = 0.0;
    double before_N = 0.0;
    for (int k = -kPoints; k <= kPoints; ++k) {
        const double now_N = force_N({step_m_s * k, 0.0, current_A}, rest.data(), nullptr);
        most = k == -kPoints ? 0.0 : std::max(most, std::abs(now_N - before_N) / step_m_s);
        before_N = now_N;
    }
    return most;
}

double HysteresisNetwork::stiffest_N_m(double current_A) const {
    double smallest_m = params_.stroke_m;
    for (const double reach_m : params_.stop_reaches_m) {
        smallest_m = std::min(smallest_m, reach_m);
    }
    const double step_m = 0.1 * smallest_m;
    double most = 0.0;
    for (int k = -kPoints; k < kPoints; ++k) {
        const std::vector<double> from = quick_state(step_m * k, current_A);
        const std::vector<double> to = quick_state(step_m * (k + 1), current_A);
        const double rise_N = force_N({0.0, step_m * (k + 1), current_A}, to.data(), nullptr) -
                              force_N({0.0, step_m * k, current_A}, from.data(), nullptr);
        most = std::max(most, std::abs(rise_N) / step_m);
    }
    return most;
}

double HysteresisNetwork::fastest_rate_1_s(double /*current_A*/) const {
    double most = params_.chain_count > 0 ? 1.0 / params_.chain_time_s : 0.0;
    for (const double time_s : params_.coil_times_s) {
        most = std::max(most, 1.0 / time_s);
    }
    for (const double time_s : params_.elastic_times_s) {
        most = std::max(most, 1.0 / time_s);
    }
    for (const double reach_m : params_.stop_reaches_m) {
        most = std::max(most, params_.speed_m_s / reach_m);
    }
    return most;
}

} // namespace quiesce
