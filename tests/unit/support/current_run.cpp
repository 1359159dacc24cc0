#include "current_run.h"

#include <algorithm>
#include <cmath>

namespace quiesce {
namespace {

constexpr std::int32_t FULL_SCALE_mA = 2000;
constexpr double FULL_SCALE_A = 2.0;
constexpr int SETTLING_STEPS = 4000;
constexpr int STEADY_STEPS = 2000;

} // namespace

current_loop_cfg_t shipped_loop(bool is_full_bridge) {
    current_loop_cfg_t cfg{};
    cfg.resistance_mohm = 5000;
    cfg.gain_mV_a_mA_q8 = 50 * 256;
    cfg.integral_time_us = 20000;
    cfg.integral_mV = 8000;
    cfg.least_duty = is_full_bridge ? -CURRENT_LOOP_FULL : 0;
    cfg.full_scale_mA = FULL_SCALE_mA;
    return cfg;
}

CurrentRun::CurrentRun(const CoilCircuitParams &coil_params, std::uint64_t seed)
    : coil(coil_params, LOOP_STEP_S, seed) {
    const current_loop_cfg_t cfg = shipped_loop(coil_params.is_full_bridge);
    current_loop_init(&loop, &cfg);
}

void CurrentRun::step() {
    const std::int32_t sensed_mA = coil.sensed_mA();
    const std::int32_t next = current_loop_step(&loop, sensed_mA, coil.sensed_supply_mV());
    coil.run(static_cast<double>(duty_) / CURRENT_LOOP_FULL);
    duty_ = next;
}

void CurrentRun::steps(int count) {
    for (int i = 0; i < count; i++) {
        step();
    }
}

CurrentStep full_scale_step(const CoilCircuitParams &params, std::uint64_t seed) {
    CurrentStep found;
    CoilCircuit pushed(params, LOOP_STEP_S, seed);
    found.is_possible = pushed.most_current_A() > FULL_SCALE_A;
    if (!found.is_possible) {
        return found;
    }
    for (int i = 1; pushed.current_A() < (1.0 - BAND) * FULL_SCALE_A; i++) {
        pushed.run(1.0);
        found.bound_ms = i * LOOP_STEP_S * 1000.0;
    }
    CurrentRun run(params, seed);
    run.steps(100);
    run.command(FULL_SCALE_mA);
    double most_A = 0.0;
    for (int i = 1; i <= SETTLING_STEPS; i++) {
        run.step();
        const double current_A = run.coil.current_A();
        most_A = std::max(most_A, current_A);
        if (std::abs(current_A - FULL_SCALE_A) > BAND * FULL_SCALE_A) {
            found.time_ms = (i + 1) * LOOP_STEP_S * 1000.0;
        }
    }
    double sum_A = 0.0;
    for (int i = 0; i < STEADY_STEPS; i++) {
        run.step();
        sum_A += run.coil.current_A();
    }
    found.overshoot_pct = std::max(0.0, most_A / FULL_SCALE_A - 1.0) * 100.0;
    found.steady_pct = std::abs(sum_A / STEADY_STEPS / FULL_SCALE_A - 1.0) * 100.0;
    return found;
}

std::vector<CoilCircuitParams> all_coils() {
    std::vector<CoilCircuitParams> coils;
    for (const double supply_V : {12.0, 24.0}) {
        for (const double resistance_ohm : {3.5, 5.0, 6.5}) {
            for (const double inductance_H : {0.02, 0.06, 0.2}) {
                CoilCircuitParams coil;
                coil.supply_V = supply_V;
                coil.resistance_ohm = resistance_ohm;
                coil.inductance_H = inductance_H;
                coil.saturation_A = 3.0;
                coils.push_back(coil);
            }
        }
    }
    return coils;
}

} // namespace quiesce
