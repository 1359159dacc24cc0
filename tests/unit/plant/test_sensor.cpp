#include <gtest/gtest.h>

#include <cmath>

#include "accelerometer.h"
#include "noise.h"

namespace {

using quiesce::Accelerometer;
using quiesce::Noise;

TEST(Noise, is_a_standard_normal) {
    Noise noise(7);
    constexpr int kCount = 400000;
    double sum = 0.0;
    double square = 0.0;
    double fourth = 0.0;
    double neighbours = 0.0;
    double last = 0.0;
    int beyond_3_sigma = 0;
    for (int i = 0; i < kCount; ++i) {
        const double x = noise.gaussian();
        sum += x;
        square += x * x;
        fourth += x * x * x * x;
        neighbours += x * last;
        beyond_3_sigma += std::abs(x) > 3.0 ? 1 : 0;
        last = x;
    }
    EXPECT_NEAR(sum / kCount, 0.0, 0.006);
    EXPECT_NEAR(square / kCount, 1.0, 0.01);
    EXPECT_NEAR(fourth / kCount, 3.0, 0.06);
    EXPECT_NEAR(neighbours / kCount, 0.0, 0.006);
    EXPECT_NEAR(static_cast<double>(beyond_3_sigma) / kCount, 0.0027, 0.0004);
}

TEST(Noise, same_seed_same_bits_other_seed_other_bits) {
    Noise a(1);
    Noise b(1);
    Noise c(2);
    int equal = 0;
    for (int i = 0; i < 1000; ++i) {
        const std::uint64_t bits = a.bits();
        ASSERT_EQ(bits, b.bits());
        equal += bits == c.bits() ? 1 : 0;
    }
    EXPECT_EQ(equal, 0);
}

TEST(Noise, bits_are_those_of_the_published_generator) {
    // xoshiro256++ from the SplitMix64 sequence of seed 0: fixed for good, so that recorded seeds
    // keep their meaning. First value computed by hand from the definition.
    const std::uint64_t s0 = 0xE220A8397B1DCDAFu;
    const std::uint64_t s3 = 0xF88BB8A8724C81ECu;
    const std::uint64_t sum = s0 + s3;
    Noise noise(0);
    EXPECT_EQ(noise.bits(), ((sum << 23) | (sum >> 41)) + s0);
}

TEST(Accelerometer, scale_of_24_bits_over_49_4_g) {
    const Accelerometer sensor({49.4, 24, 0.0, 0}, 1);
    EXPECT_NEAR(sensor.scale_m_s2(), 5.7751e-5, 1e-9);
    EXPECT_EQ(sensor.full_scale_counts(), 8388607);
}

TEST(Accelerometer, rounds_to_the_nearest_count) {
    Accelerometer sensor({49.4, 24, 0.0, 0}, 1);
    EXPECT_EQ(sensor.sample_counts(10.4 * sensor.scale_m_s2()), 10);
    EXPECT_EQ(sensor.sample_counts(10.6 * sensor.scale_m_s2()), 11);
    EXPECT_EQ(sensor.sample_counts(-10.6 * sensor.scale_m_s2()), -11);
}

TEST(Accelerometer, saturates_and_offsets) {
    Accelerometer sensor({2.0, 12, 0.0, -5}, 1);
    EXPECT_EQ(sensor.sample_counts(0.0), -5);
    EXPECT_EQ(sensor.sample_counts(1e6), 2047);
    EXPECT_EQ(sensor.sample_counts(-1e6), -2047);
}

TEST(Accelerometer, noise_has_the_stated_rms) {
    Accelerometer sensor({49.4, 24, 0.5, 0}, 3);
    constexpr int kCount = 100000;
    double square = 0.0;
    for (int i = 0; i < kCount; ++i) {
        const double accel = sensor.sample_counts(0.0) * sensor.scale_m_s2();
        square += accel * accel;
    }
    EXPECT_NEAR(std::sqrt(square / kCount), 0.5e-3 * quiesce::kGravity_m_s2, 2.5e-5);
}

} // namespace
