// The coil's circuit against closed forms.
#include <gtest/gtest.h>

#include <cmath>

#include "coil_circuit.h"

namespace quiesce {
namespace {

constexpr double STEP_S = 1e-4;

CoilCircuitParams plain() {
    CoilCircuitParams params;
    params.supply_ohm = 0.0;
    params.sense_noise_A = 0.0;
    params.thermal_K_W = 0.0;
    params.diode_V = 0.0;
    return params;
}

CoilCircuit run(const CoilCircuitParams &params, double duty, int steps) {
    CoilCircuit coil(params, STEP_S, 1);
    for (int i = 0; i < steps; i++) {
        coil.run(duty);
    }
    return coil;
}

TEST(CoilCircuit, RisesAsAnExponential) {
    // 12 V, 5 ohm, 0.1 H: 20 ms of time constant.
    EXPECT_NEAR(run(plain(), 1.0, 200).current_A(), 2.4 * (1.0 - std::exp(-1.0)), 1e-9);
}

TEST(CoilCircuit, MeanVoltageSetsTheCurrentInTheEnd) {
    const CoilCircuit coil = run(plain(), 0.5, 5000);
    EXPECT_NEAR(coil.current_A(), 1.2, 2e-3); // a sample at the begin of a period is near its mean
}

TEST(CoilCircuit, FreewheelNeitherReversesNorDrives) {
    CoilCircuit coil = run(plain(), 1.0, 500);
    EXPECT_GT(coil.current_A(), 2.0);
    for (int i = 0; i < 5000; i++) {
        coil.run(-1.0);
    }
    EXPECT_GE(coil.current_A(), 0.0);
    EXPECT_LT(coil.current_A(), 1e-9);
}

TEST(CoilCircuit, FullBridgeReverses) {
    CoilCircuitParams params = plain();
    params.is_full_bridge = true;
    EXPECT_NEAR(run(params, -1.0, 5000).current_A(), -2.4, 1e-6);
}

TEST(CoilCircuit, SaturationKeepsTheFluxBalance) {
    CoilCircuitParams params = plain();
    params.resistance_ohm = 1e-6; // all of the voltage becomes flux
    params.saturation_A = 1.0;
    // L0 i_s atan(i / i_s) = v t: 12 V for 5 ms are 0.06 Vs of 0.1 H at 1 A.
    EXPECT_NEAR(run(params, 1.0, 50).current_A(), std::tan(0.6), 1e-3);
}

TEST(CoilCircuit, CopperWarmsAndResists) {
    CoilCircuitParams params = plain();
    params.thermal_K_W = 5.0;
    params.thermal_s = 0.2;
    const CoilCircuit coil = run(params, 0.5, 50000);
    // In the end T - 20 = Rth v^2 / R(T), v = 6 V.
    const double heat_W = 36.0 / coil.resistance_ohm();
    EXPECT_NEAR(coil.temperature_degC() - 20.0, 5.0 * heat_W, 0.1);
    EXPECT_NEAR(coil.resistance_ohm(), 5.0 * (1.0 + 0.00393 * (coil.temperature_degC() - 20.0)),
                1e-12);
}

TEST(CoilCircuit, SupplyDroopsUnderLoad) {
    CoilCircuitParams params = plain();
    params.supply_ohm = 1.0;
    const CoilCircuit coil = run(params, 1.0, 5000);
    EXPECT_NEAR(coil.current_A(), 2.0, 1e-6);
    EXPECT_NEAR(coil.sensed_supply_mV(), 10000, 10);
    EXPECT_NEAR(coil.most_current_A(), 2.0, 1e-12);
}

TEST(CoilCircuit, SenseRoundsLimitsAndIsNoisy) {
    CoilCircuitParams params = plain();
    params.sense_full_scale_A = 2.0;
    params.sense_bits = 8; // 15.6 mA
    CoilCircuit coil = run(params, 0.25, 5000);
    EXPECT_EQ(coil.sensed_mA(), 594); // 0.6 A is 38.4 steps
    CoilCircuit beyond = run(params, 1.0, 5000);
    EXPECT_EQ(beyond.sensed_mA(), 1984); // the last step below 2 A
    params.sense_bits = 14;
    params.sense_noise_A = 0.01;
    CoilCircuit noisy = run(params, 0.25, 5000);
    double sum = 0.0;
    double squares = 0.0;
    for (int i = 0; i < 4000; i++) {
        const double off_mA = noisy.sensed_mA() - 600.0;
        sum += off_mA;
        squares += off_mA * off_mA;
    }
    EXPECT_NEAR(sum / 4000.0, 0.0, 1.5);
    EXPECT_NEAR(std::sqrt(squares / 4000.0), 10.0, 0.6);
}

TEST(CoilCircuit, DutyComesInCountsOfTheTimer) {
    CoilCircuitParams params = plain();
    params.pwm_counts = 4;
    EXPECT_EQ(run(params, 0.1, 1000).current_A(), 0.0);
    EXPECT_EQ(run(params, 0.6, 1000).current_A(), run(params, 0.5, 1000).current_A());
}

} // namespace
} // namespace quiesce
