#include "fault_injector.h"

#include <gtest/gtest.h>

namespace {

using quiesce::ActuatorFault;
using quiesce::FaultInjector;
using quiesce::FaultKind;

constexpr std::int32_t kFullScale = 2047;

/// Of the one sensor and the one damper.
FaultInjector injector_of(const std::vector<quiesce::InjectedFault> &faults) {
    std::vector<quiesce::PlacedFault> placed;
    for (const quiesce::InjectedFault &fault : faults) {
        placed.push_back({fault, 0, 0});
    }
    return {placed, {kFullScale}};
}

lockstep_stimulus_t applied(FaultInjector &injector, double time_s, std::int32_t counts) {
    lockstep_stimulus_t stimulus = {LOCKSTEP_FRESH | LOCKSTEP_ENABLE, {counts}, {0}};
    injector.apply(time_s, stimulus);
    return stimulus;
}

lockstep_stimulus_t during(FaultKind kind) {
    FaultInjector injector = injector_of({{kind, 1.0, 0.5}});
    applied(injector, 0.999, 11);
    return applied(injector, 1.0, 12);
}

TEST(FaultInjector, each_kind_shows_in_the_stimulus) {
    EXPECT_EQ(during(FaultKind::dropout).flags, LOCKSTEP_ENABLE);
    EXPECT_EQ(during(FaultKind::stuck).counts[0], 11);
    EXPECT_EQ(during(FaultKind::saturate).counts[0], kFullScale);
    EXPECT_GT(during(FaultKind::range).counts[0], kFullScale);
    EXPECT_NE(during(FaultKind::estop).flags & LOCKSTEP_ESTOP, 0u);
    EXPECT_EQ(during(FaultKind::fault_reset).flags, LOCKSTEP_FRESH | LOCKSTEP_FAULT_RESET);
    EXPECT_EQ(during(FaultKind::disable).flags, LOCKSTEP_FRESH);
    EXPECT_NE(during(FaultKind::lost_tick).flags & LOCKSTEP_LOST, 0u);
    EXPECT_EQ(during(FaultKind::coil_open).flags, LOCKSTEP_FRESH | LOCKSTEP_ENABLE);
}

TEST(FaultInjector, a_stuck_sample_is_none_of_a_lost_tick) {
    FaultInjector injector =
        injector_of({{FaultKind::lost_tick, 1.0, 0.001}, {FaultKind::stuck, 1.001, 0.01}});
    applied(injector, 0.999, 11);
    applied(injector, 1.0, 12);
    EXPECT_EQ(applied(injector, 1.001, 13).counts[0], 11);
}

TEST(FaultInjector, is_present_from_its_start_until_its_end) {
    FaultInjector injector = injector_of({{FaultKind::dropout, 0.003, 0.002}});
    int lost = 0;
    for (int tick = 0; tick < 10; ++tick) {
        const double time_s = static_cast<double>(tick) / 1000.0;
        const bool is_lost = (applied(injector, time_s, tick).flags & LOCKSTEP_FRESH) == 0;
        EXPECT_EQ(is_lost, tick == 3 || tick == 4) << "tick " << tick;
        lost += is_lost ? 1 : 0;
    }
    EXPECT_EQ(lost, 2);
}

TEST(FaultInjector, stuck_sample_stays_for_the_whole_fault) {
    FaultInjector injector = injector_of({{FaultKind::stuck, 1.0, 1.0}});
    applied(injector, 0.9, 5);
    EXPECT_EQ(applied(injector, 1.1, 6).counts[0], 5);
    EXPECT_EQ(applied(injector, 1.9, 7).counts[0], 5);
    EXPECT_EQ(applied(injector, 2.1, 8).counts[0], 8);
}

TEST(FaultInjector, actuator_faults_reach_the_actuator) {
    const FaultInjector injector =
        injector_of({{FaultKind::driver_stuck, 1.0, 2.0}, {FaultKind::coil_open, 2.0, 2.0}});
    EXPECT_EQ(injector.actuator(0.5, 0), ActuatorFault::none);
    EXPECT_EQ(injector.actuator(1.5, 0), ActuatorFault::driver_stuck);
    EXPECT_EQ(injector.actuator(2.5, 0), ActuatorFault::coil_open);
    EXPECT_EQ(injector.actuator(4.5, 0), ActuatorFault::none);
}

TEST(FaultInjector, order_and_overlap_do_not_matter) {
    FaultInjector injector = injector_of({{FaultKind::estop, 5.0, 1.0},
                                          {FaultKind::disable, 0.0, 4.0},
                                          {FaultKind::dropout, 1.0, 0.1},
                                          {FaultKind::saturate, 2.0, 0.5}});
    for (int tick = 0; tick < 7000; ++tick) {
        const double time_s = static_cast<double>(tick) / 1000.0;
        const lockstep_stimulus_t found = applied(injector, time_s, 1);
        EXPECT_EQ((found.flags & LOCKSTEP_ESTOP) != 0, tick >= 5000 && tick < 6000) << tick;
        EXPECT_EQ((found.flags & LOCKSTEP_ENABLE) == 0, tick < 4000) << tick;
        EXPECT_EQ((found.flags & LOCKSTEP_FRESH) == 0, tick >= 1000 && tick < 1100) << tick;
        EXPECT_EQ(found.counts[0] == kFullScale, tick >= 2000 && tick < 2500) << tick;
    }
}

TEST(FaultInjector, a_fault_befalls_its_own_sensor_and_damper) {
    FaultInjector injector({{{FaultKind::saturate, 1.0, 1.0}, 1, 0},
                            {{FaultKind::dropout, 1.0, 1.0}, 2, 0},
                            {{FaultKind::coil_open, 1.0, 1.0}, 0, 1}},
                           {100, 200, 300});
    lockstep_stimulus_t stimulus = {LOCKSTEP_FRESH * 7u, {5, 6, 7}, {0}};
    injector.apply(1.5, stimulus);
    EXPECT_EQ(stimulus.counts[0], 5);
    EXPECT_EQ(stimulus.counts[1], 200);
    EXPECT_EQ(stimulus.flags, LOCKSTEP_FRESH * 3u);
    EXPECT_EQ(injector.actuator(1.5, 0), ActuatorFault::none);
    EXPECT_EQ(injector.actuator(1.5, 1), ActuatorFault::coil_open);
}

} // namespace
