#include <gtest/gtest.h>

#include <cmath>

#include "chirp_segment.h"
#include "excitation.h"
#include "sine_segment.h"

namespace {

using quiesce::ChirpSegment;
using quiesce::Excitation;
using quiesce::Shaker;
using quiesce::ShakerParams;
using quiesce::SineSegment;

constexpr double kTwoPi = 6.28318530717958647692;

/// 1 N at every frequency.
constexpr ShakerParams kUnit = {1.0, 10.0, 0.0, 1.0};

TEST(Shaker, gain_is_exact_at_its_reference_and_rolls_off) {
    const Shaker shaker({2.96, 10.0, 5.4, 0.1});
    EXPECT_DOUBLE_EQ(shaker.amplitude(10.0), 0.296);
    const double at_20_N =
        0.296 * std::sqrt((1.0 + std::pow(10.0 / 5.4, 2.0)) / (1.0 + std::pow(20.0 / 5.4, 2.0)));
    EXPECT_NEAR(shaker.amplitude(20.0), at_20_N, 1e-15);
}

TEST(Shaker, without_corner_is_flat) {
    const Shaker shaker({2.0, 10.0, 0.0, 0.5});
    EXPECT_EQ(shaker.amplitude(1.0), 1.0);
    EXPECT_EQ(shaker.amplitude(1000.0), 1.0);
}

TEST(Excitation, phase_is_continuous_over_a_frequency_step) {
    Excitation excitation;
    excitation.append(std::make_unique<SineSegment>(kUnit, 9.3), 1.234);
    excitation.append(std::make_unique<SineSegment>(kUnit, 20.0), 10.0);
    const double before = excitation.sample(0, 1.234).phase_cycles;
    const double after = excitation.sample(1, 1.234).phase_cycles;
    EXPECT_NEAR(before, 9.3 * 1.234, 1e-12);
    EXPECT_NEAR(before, after, 1e-12);
    EXPECT_NEAR(excitation.sample(0, 1.234).force_N, excitation.sample(1, 1.234).force_N, 1e-12);
    EXPECT_EQ(excitation.at(1.2339).freq_Hz, 9.3);
    EXPECT_EQ(excitation.at(1.2341).freq_Hz, 20.0);
}

TEST(Excitation, a_segment_includes_its_start_and_not_its_end) {
    Excitation excitation;
    excitation.append(std::make_unique<SineSegment>(kUnit, 10.0), 4.0);
    excitation.append(std::make_unique<SineSegment>(kUnit, 20.0), 4.0);
    EXPECT_EQ(excitation.segment_at(0.0), 0u);
    EXPECT_EQ(excitation.segment_at(4.0), 1u);
    EXPECT_EQ(excitation.segment_at(100.0), 1u) << "the last one goes on";
}

TEST(Excitation, chirp_phase_is_the_integral_of_its_frequency) {
    Excitation excitation;
    excitation.append(std::make_unique<ChirpSegment>(kUnit, 5.0, 10.0, 8.0), 8.0);
    double integral = 0.0;
    constexpr double kStep_s = 1e-3;
    for (int i = 0; i < 8000; ++i) {
        integral += kStep_s * excitation.at((i + 0.5) * kStep_s).freq_Hz;
    }
    EXPECT_NEAR(excitation.at(8.0).phase_cycles, integral, 1e-9);
    EXPECT_NEAR(excitation.at(8.0).freq_Hz, 10.0, 1e-12);
    EXPECT_NEAR(excitation.at(2.0).force_N, std::sin(kTwoPi * excitation.at(2.0).phase_cycles),
                1e-9);
}

} // namespace
