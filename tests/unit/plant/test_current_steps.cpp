// The current loop that ships, in closed loop with coils.
#include <gtest/gtest.h>

#include "current_run.h"

namespace quiesce {
namespace {

constexpr std::uint64_t SEED = 7;

TEST(CurrentSteps, OneSetOfGainsServesEveryCoil) {
    int possible = 0;
    for (const CoilCircuitParams &coil : all_coils()) {
        const CurrentStep step = full_scale_step(coil, SEED);
        if (!step.is_possible) {
            continue;
        }
        possible++;
        SCOPED_TRACE(testing::Message() << coil.supply_V << " V, " << coil.resistance_ohm
                                        << " ohm, " << coil.inductance_H << " H");
        EXPECT_LE(step.overshoot_pct, 5.0);
        EXPECT_LE(step.steady_pct, 1.0);
        EXPECT_LE(step.time_ms, step.bound_ms * 1.1 + 0.2);
    }
    EXPECT_EQ(possible, 15); // 6.5 ohm at 12 V take 1.8 A
}

CurrentRun settled(const CoilCircuitParams &coil, std::int32_t command_mA) {
    CurrentRun run(coil, SEED);
    run.command(command_mA);
    run.steps(6000);
    return run;
}

TEST(CurrentSteps, ResistanceAndRiseAreThoseOfTheCoil) {
    CoilCircuitParams coil;
    coil.diode_V = 0.0; // else it counts as resistance
    coil.supply_ohm = 0.0;
    coil.thermal_K_W = 0.0;
    CurrentRun run = settled(coil, 1500);
    run.coil.set_temperature_degC(100.0);
    run.steps(12000);
    current_loop_report_t report{};
    ASSERT_TRUE(current_loop_report(&run.loop, 12000, &report));
    EXPECT_EQ(report.coil, CURRENT_LOOP_FOLLOWS);
    EXPECT_NEAR(report.resistance_mohm, 1000.0 * run.coil.resistance_ohm(), 60.0);
    EXPECT_NEAR(report.rise_degC, 80, 4);
}

TEST(CurrentSteps, ResistanceIsKnownFromACurrentThatNeverRests) {
    CoilCircuitParams coil;
    coil.diode_V = 0.0;
    coil.supply_ohm = 0.0;
    coil.thermal_K_W = 0.0;
    coil.saturation_A = 2.0;
    CurrentRun run(coil, SEED);
    for (int i = 0; i < 40; i++) { // a square wave of 10 Hz
        run.command(i % 2 == 0 ? 1500 : 300);
        run.steps(500);
    }
    current_loop_report_t report{};
    ASSERT_TRUE(current_loop_report(&run.loop, 12000, &report));
    EXPECT_NEAR(report.resistance_mohm, 5000, 150);
}

TEST(CurrentSteps, OpenAndShortCoilsAreTold) {
    CoilCircuitParams open;
    open.resistance_ohm = 1e6;
    CurrentRun run = settled(open, 1000);
    current_loop_report_t report{};
    ASSERT_TRUE(current_loop_report(&run.loop, 12000, &report));
    EXPECT_EQ(report.coil, CURRENT_LOOP_OPEN);

    CoilCircuitParams turns; // most of its turns are bridged
    turns.resistance_ohm = 0.6;
    turns.inductance_H = 0.02;
    turns.diode_V = 0.0;
    CurrentRun shorted = settled(turns, 1000);
    ASSERT_TRUE(current_loop_report(&shorted.loop, 12000, &report));
    EXPECT_EQ(report.coil, CURRENT_LOOP_SHORT);
}

TEST(CurrentSteps, FullBridgeTakesTheCurrentDownFaster) {
    CoilCircuitParams coil;
    coil.supply_V = 24.0;
    double left_A[2] = {};
    for (const bool is_full : {false, true}) {
        coil.is_full_bridge = is_full;
        CurrentRun run = settled(coil, 2000);
        run.command(0);
        run.steps(60);
        left_A[is_full ? 1 : 0] = run.coil.current_A();
        run.steps(3000);
        EXPECT_NEAR(run.coil.current_A(), 0.0, 0.02);
    }
    EXPECT_GT(left_A[0], 1.0);
    EXPECT_LT(left_A[1], 0.8);
}

TEST(CurrentSteps, AnotherSupplyLeavesTheCurrent) {
    CoilCircuitParams coil;
    coil.supply_V = 24.0;
    coil.supply_ohm = 2.0; // it droops by 20 %
    CurrentRun run = settled(coil, 1500);
    EXPECT_NEAR(run.coil.current_A(), 1.5, 0.015);
}

} // namespace
} // namespace quiesce
