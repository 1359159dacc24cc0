#include "metrics.h"

#include <gtest/gtest.h>

#include <cmath>

namespace {

using quiesce::PlantTruth;
using quiesce::settling_time_s;
using quiesce::WindowMetrics;

constexpr double kTwoPi = 6.28318530717958647692;
constexpr double kStep_s = 1e-3;

/// Samples of amplitude(t) sin(2 pi f t) from one step on until end_s.
template <typename Amplitude>
WindowMetrics measured(const quiesce::Window &window, double freq_Hz, double end_s,
                       Amplitude amplitude) {
    WindowMetrics metrics(window);
    const auto steps = static_cast<int>(std::lround(end_s / kStep_s));
    for (int i = 1; i <= steps; ++i) {
        const double time_s = i * kStep_s;
        const double value = amplitude(time_s) * std::sin(kTwoPi * freq_Hz * time_s);
        metrics.add(time_s, PlantTruth{value, 10.0 * value, 2.0, 0.0, freq_Hz * time_s, 0.0});
    }
    return metrics;
}

TEST(WindowMetrics, of_a_sine) {
    const WindowMetrics metrics = measured({1.0, 3.0}, 10.0, 3.0, [](double) { return 0.25; });
    EXPECT_NEAR(metrics.amplitude_m().value(), 0.25, 1e-4);
    EXPECT_NEAR(metrics.accel_rms_m_s2(), 2.5 / std::sqrt(2.0), 1e-9);
    EXPECT_NEAR(metrics.displacement_rms_m(), 0.25 / std::sqrt(2.0), 1e-10);
    EXPECT_NEAR(metrics.mean_current_A(), 2.0, 1e-12);
}

TEST(WindowMetrics, ignores_what_is_outside_its_window) {
    const WindowMetrics metrics = measured({1.0, 2.0}, 10.0, 4.0, [](double time_s) {
        return time_s > 1.0005 && time_s < 2.0005 ? 1.0 : 50.0;
    });
    EXPECT_NEAR(metrics.amplitude_m().value(), 1.0, 1e-3);
}

TEST(WindowMetrics, amplitude_is_the_mean_over_cycles) {
    // Cycles of 0.1 s: the first ten at 1, the next ten at 3.
    const WindowMetrics metrics =
        measured({1.0, 3.0}, 10.0, 3.0, [](double time_s) { return time_s < 2.0005 ? 1.0 : 3.0; });
    EXPECT_NEAR(metrics.amplitude_m().value(), 2.0, 2e-3);
}

TEST(WindowMetrics, leaves_out_a_cycle_that_is_cut_off) {
    // 2.5 cycles fit; in the last half cycle the motion is only positive.
    const WindowMetrics metrics = measured({0.0, 0.25}, 10.0, 0.25, [](double) { return 1.0; });
    EXPECT_NEAR(metrics.amplitude_m().value(), 1.0, 1e-3);
}

TEST(WindowMetrics, takes_what_there_is_when_no_cycle_is_whole) {
    const WindowMetrics metrics = measured({0.0, 0.5}, 1.0, 0.5, [](double) { return 1.0; });
    EXPECT_NEAR(metrics.amplitude_m().value(), 0.5, 2e-3) << "half a sine spans 0 .. 1";
}

TEST(WindowMetrics, peak_is_the_largest_distance_from_rest_in_the_window) {
    const WindowMetrics metrics = measured({1.0, 2.0}, 10.0, 3.0, [](double time_s) {
        return time_s < 1.5 ? 1.0 : time_s < 2.0005 ? 3.0 : 50.0;
    });
    EXPECT_NEAR(metrics.peak_displacement_m(), 3.0, 1e-2);
}

TEST(WindowMetrics, peak_counts_where_the_window_begins) {
    WindowMetrics metrics({1.0, 2.0});
    metrics.add(0.5, {-9.0, 0.0, 0.0, 0.0, 0.5, 0.0});
    metrics.add(1.0, {-5.0, 0.0, 0.0, 0.0, 1.0, 0.0});
    metrics.add(1.5, {1.0, 0.0, 0.0, 0.0, 1.5, 0.0});
    EXPECT_EQ(metrics.peak_displacement_m(), 5.0);
}

TEST(WindowMetrics, no_amplitude_where_the_phase_stands_still) {
    WindowMetrics metrics({0.0, 1.0});
    for (int i = 1; i <= 10; ++i) {
        const double cycles = std::min(0.7, 0.1 * i); // a sine, then something else
        metrics.add(0.1 * i, {1.0, 2.0, 3.0, 0.0, cycles, 0.0});
    }
    EXPECT_FALSE(metrics.amplitude_m().has_value());
    EXPECT_NEAR(metrics.displacement_rms_m(), std::sqrt(0.95), 1e-12);
}

TEST(WindowMetrics, work_of_a_damper_is_what_it_takes) {
    // F = c v with v = V sin(2 pi f t): the structure loses c V^2 / 2 a second.
    WindowMetrics metrics({1.0, 3.0});
    for (int i = 1; i <= 4000; ++i) {
        const double time_s = i * kStep_s;
        const double velocity_m_s = 0.2 * std::sin(kTwoPi * 10.0 * time_s);
        metrics.add(time_s, {0.0, 0.0, 0.0, 7.0 * velocity_m_s, 10.0 * time_s, velocity_m_s});
    }
    EXPECT_NEAR(metrics.damper_work_J(), -7.0 * 0.2 * 0.2 / 2.0 * 2.0, 1e-9);
}

TEST(SettlingTime, of_an_exponential_approach) {
    // x^2 = 1 + 3 exp(-t/0.5) for t > 1 s. Trailing mean over 0.2 s: 1 + 3 exp(-t/0.5) *
    // (exp(0.4) - 1)/0.4; its root is within 5 % of 1 once the second term is below 0.1025.
    std::vector<double> squares;
    for (int i = 1; i <= 10000; ++i) {
        const double since_s = i * kStep_s - 1.0;
        squares.push_back(since_s < 0.0 ? 4.0 : 1.0 + 3.0 * std::exp(-since_s / 0.5));
    }
    const double expected_s = 0.5 * std::log(3.0 * (std::exp(0.4) - 1.0) / 0.4 / 0.1025);
    const auto settle_s = settling_time_s(squares, kStep_s, 1.0, 0.2, 1.0, 0.05);
    ASSERT_TRUE(settle_s.has_value());
    EXPECT_NEAR(*settle_s, expected_s, 3e-3);
}

TEST(SettlingTime, counts_from_the_last_time_outside) {
    std::vector<double> squares(5000, 1.0);
    squares[3999] = 200.0; // one outlier at 4 s lifts the mean for 0.2 s
    const auto settle_s = settling_time_s(squares, kStep_s, 1.0, 0.2, 1.0, 0.05);
    ASSERT_TRUE(settle_s.has_value());
    EXPECT_NEAR(*settle_s, 3.2, 2e-3);
}

TEST(SettlingTime, nothing_when_it_never_settles) {
    const std::vector<double> squares(3000, 2.0);
    EXPECT_FALSE(settling_time_s(squares, kStep_s, 1.0, 0.2, 1.0, 0.05).has_value());
}

} // namespace
