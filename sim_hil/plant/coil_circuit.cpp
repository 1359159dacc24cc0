#include "coil_circuit.h"

#include <algorithm>
#include <cmath>

namespace quiesce {
namespace {

constexpr double COPPER_PER_K = 0.00393;
constexpr double LONGEST_STEP_S = 5e-6;

} // namespace

CoilCircuit::CoilCircuit(const CoilCircuitParams &params, double step_s, std::uint64_t seed)
    : params_(params), step_s_(step_s), temperature_degC_(params.ambient_degC), noise_(seed) {}

double CoilCircuit::resistance_ohm() const {
    return params_.resistance_ohm * (1.0 + COPPER_PER_K * (temperature_degC_ - 20.0));
}

double CoilCircuit::most_current_A() const {
    return params_.supply_V / (resistance_ohm() + params_.supply_ohm);
}

void CoilCircuit::piece(double voltage_V, double series_ohm, double time_s) {
    const double resistance_ohm = this->resistance_ohm() + series_ohm;
    const int steps = std::max(1, static_cast<int>(std::ceil(time_s / LONGEST_STEP_S)));
    for (int i = 0; i < steps; i++) {
        const double part = params_.saturation_A > 0.0 ? current_A_ / params_.saturation_A : 0.0;
        const double inductance_H = params_.inductance_H / (1.0 + part * part);
        const double target_A = voltage_V / resistance_ohm;
        const double left = std::exp(-resistance_ohm / inductance_H * time_s / steps);
        current_A_ = target_A + (current_A_ - target_A) * left;
        if (!params_.is_full_bridge) {
            current_A_ = std::max(current_A_, 0.0);
        }
    }
}

void CoilCircuit::run(double duty) {
    const double least = params_.is_full_bridge ? -1.0 : 0.0;
    const double counted = std::nearbyint(std::clamp(duty, least, 1.0) * params_.pwm_counts);
    const double share = std::abs(counted) / params_.pwm_counts;
    const double on_V = counted < 0.0 ? -params_.supply_V : params_.supply_V;
    const double off_V = params_.is_full_bridge ? 0.0 : -params_.diode_V;
    const double period_s = step_s_ / params_.pwm_periods;
    for (int i = 0; i < params_.pwm_periods; i++) {
        piece(off_V, 0.0, (1.0 - share) * period_s / 2.0);
        piece(on_V, params_.supply_ohm, share * period_s);
        piece(off_V, 0.0, (1.0 - share) * period_s / 2.0);
    }
    load_A_ = std::abs(current_A_) * share;
    const double heat_K = params_.thermal_K_W * current_A_ * current_A_ * resistance_ohm();
    temperature_degC_ +=
        (heat_K - (temperature_degC_ - params_.ambient_degC)) * step_s_ / params_.thermal_s;
}

std::int32_t CoilCircuit::sensed_mA() {
    const double half = std::ldexp(1.0, params_.sense_bits - 1);
    const double counts = (current_A_ + params_.sense_noise_A * noise_.gaussian()) * half /
                          params_.sense_full_scale_A;
    const double limited = std::clamp(std::nearbyint(counts), -half, half - 1.0);
    return static_cast<std::int32_t>(
        std::nearbyint(limited * params_.sense_full_scale_A * 1000.0 / half));
}

std::int32_t CoilCircuit::sensed_supply_mV() const {
    const double full = std::ldexp(1.0, params_.sense_bits) - 1.0;
    const double volts = params_.supply_V - params_.supply_ohm * load_A_;
    const double counts =
        std::clamp(std::nearbyint(volts * full / params_.supply_sense_V), 0.0, full);
    return static_cast<std::int32_t>(
        std::nearbyint(counts * params_.supply_sense_V * 1000.0 / full));
}

} // namespace quiesce
