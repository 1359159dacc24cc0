/// Segments without one frequency: tones, random force, impulse, record of base acceleration.
#include <gtest/gtest.h>

#include <cmath>
#include <complex>
#include <vector>

#include <unsupported/Eigen/FFT>

#include "excitation.h"
#include "impulse_segment.h"
#include "random_segment.h"
#include "record_segment.h"
#include "sine_segment.h"
#include "tones_segment.h"

namespace {

using quiesce::Excitation;
using quiesce::ImpulseSegment;
using quiesce::RandomParams;
using quiesce::RandomSegment;
using quiesce::RecordSegment;
using quiesce::Segment;
using quiesce::Shaker;
using quiesce::ShakerParams;
using quiesce::SineSegment;
using quiesce::TonesSegment;

constexpr double kTwoPi = 6.28318530717958647692;
constexpr ShakerParams kShaker = {2.96, 10.0, 5.4, 0.1};
constexpr ShakerParams kUnit = {1.0, 10.0, 0.0, 1.0};

double force_N(const Segment &segment, double time_s) {
    return segment.sample(time_s, 0.0).force_N;
}

TEST(TonesSegment, one_tone_is_the_sine_of_the_same_drive) {
    const TonesSegment tones(kShaker, {{9.3, 0.1, 0.0}});
    const SineSegment sine(kShaker, 9.3);
    for (double time_s = 0.0; time_s < 2.0; time_s += 0.00137) {
        ASSERT_NEAR(force_N(tones, time_s), force_N(sine, time_s), 1e-12);
    }
}

TEST(TonesSegment, tones_superpose_with_their_own_drive_and_phase) {
    const TonesSegment both(kShaker, {{5.0, 0.1, 0.0}, {13.0, 0.3, 90.0}});
    const TonesSegment first(kShaker, {{5.0, 0.1, 0.0}});
    const double second_N = Shaker(kShaker).amplitude(13.0, 0.3);
    EXPECT_NEAR(second_N, 3.0 * Shaker(kShaker).amplitude(13.0), 1e-15);
    for (double time_s = 0.0; time_s < 2.0; time_s += 0.00137) {
        ASSERT_NEAR(force_N(both, time_s),
                    force_N(first, time_s) + second_N * std::cos(kTwoPi * 13.0 * time_s), 1e-12);
    }
}

TEST(Excitation, phase_stands_still_where_there_is_no_one_frequency) {
    Excitation excitation;
    excitation.append(std::make_unique<SineSegment>(kUnit, 10.0), 1.03);
    excitation.append(
        std::make_unique<TonesSegment>(kUnit, std::vector<quiesce::Tone>{{7.0, 1.0, 0.0}}), 2.0);
    excitation.append(std::make_unique<SineSegment>(kUnit, 10.0), 1.0);
    EXPECT_NEAR(excitation.at(1.5).phase_cycles, 10.3, 1e-12);
    EXPECT_EQ(excitation.at(1.5).freq_Hz, 0.0);
    EXPECT_NEAR(excitation.at(1.5).force_N, std::sin(kTwoPi * 7.0 * 0.47), 1e-9);
    EXPECT_NEAR(excitation.at(3.03).phase_cycles, 10.3, 1e-12) << "the sine goes on from there";
}

constexpr RandomParams kRandom = {7.0, 15.0, 0.2, 5, 30.0};

/// Amplitude of each multiple of 1/duration_s in force over drive.
std::vector<double> spectrum_V(const Segment &segment, const ShakerParams &shaker,
                               double duration_s, std::size_t count) {
    std::vector<double> samples_N;
    for (std::size_t i = 0; i < count; ++i) {
        samples_N.push_back(
            force_N(segment, duration_s * static_cast<double>(i) / static_cast<double>(count)));
    }
    Eigen::FFT<double> fft;
    std::vector<std::complex<double>> spectrum;
    fft.fwd(spectrum, samples_N);
    std::vector<double> out;
    for (std::size_t i = 0; i < count / 2; ++i) {
        const double freq_Hz = static_cast<double>(i) / duration_s;
        out.push_back(2.0 * std::abs(spectrum[i]) / static_cast<double>(count) /
                      Shaker(shaker).amplitude(freq_Hz, 1.0));
    }
    return out;
}

TEST(RandomSegment, has_its_rms_inside_its_band_and_nothing_outside) {
    // 30 s hold 240 lines in 8 Hz, so that is its period, too.
    ASSERT_EQ(RandomSegment::repeat_s(kRandom), 30.0);
    const RandomSegment segment(kShaker, kRandom);
    const std::vector<double> lines_V = spectrum_V(segment, kShaker, 30.0, 30000);
    double inside_V2 = 0.0;
    double outside_V2 = 0.0;
    for (std::size_t i = 0; i < lines_V.size(); ++i) {
        (i >= 210 && i <= 450 ? inside_V2 : outside_V2) += 0.5 * lines_V[i] * lines_V[i];
    }
    EXPECT_NEAR(std::sqrt(inside_V2), 0.2, 1e-6);
    EXPECT_LT(std::sqrt(outside_V2), 1e-6);
}

TEST(RandomSegment, is_spread_over_the_band_and_gaussian) {
    const RandomSegment segment(kUnit, {7.0, 15.0, 1.0, 11, 200.0});
    double square = 0.0;
    double fourth = 0.0;
    constexpr int kCount = 200000;
    for (int i = 0; i < kCount; ++i) {
        const double value = force_N(segment, i * 1e-3);
        square += value * value / kCount;
        fourth += value * value * value * value / kCount;
    }
    EXPECT_NEAR(square, 1.0, 1e-5);
    EXPECT_NEAR(fourth, 3.0, 0.25) << "kurtosis of a Gaussian";
    const std::vector<double> lines_V = spectrum_V(segment, kUnit, 200.0, 20000);
    for (std::size_t first = 1400; first < 3000; first += 400) {
        double quarter_V2 = 0.0;
        for (std::size_t i = first; i < first + 400; ++i) {
            quarter_V2 += 0.5 * lines_V[i] * lines_V[i];
        }
        EXPECT_NEAR(quarter_V2, 0.25, 0.06) << "a quarter of the band from line " << first;
    }
}

TEST(RandomSegment, between_its_points_it_is_the_sum_of_its_lines) {
    const RandomSegment segment(kUnit, {7.0, 15.0, 1.0, 5, 30.0});
    // The points of a coarser grid are exact and give the lines; the lines give any other time.
    constexpr std::size_t kCount = 4096;
    std::vector<double> samples_N;
    for (std::size_t i = 0; i < kCount; ++i) {
        samples_N.push_back(force_N(segment, 30.0 * static_cast<double>(i) / kCount));
    }
    Eigen::FFT<double> fft;
    std::vector<std::complex<double>> spectrum;
    fft.fwd(spectrum, samples_N);
    for (const double time_s : {0.00313, 1.23457, 11.7771, 29.9991}) {
        double sum_N = 0.0;
        for (std::size_t i = 210; i <= 450; ++i) {
            sum_N += 2.0 / kCount *
                     std::real(spectrum[i] *
                               std::polar(1.0, kTwoPi * static_cast<double>(i) / 30.0 * time_s));
        }
        EXPECT_NEAR(force_N(segment, time_s), sum_N, 1e-6);
    }
}

TEST(RandomSegment, same_seed_same_force_other_seed_another) {
    const RandomSegment first(kShaker, kRandom);
    const RandomSegment again(kShaker, kRandom);
    RandomParams params = kRandom;
    params.seed = 6;
    const RandomSegment other(kShaker, params);
    double apart_N2 = 0.0;
    double own_N2 = 0.0;
    for (double time_s = 0.0; time_s < 30.0; time_s += 0.01) {
        ASSERT_EQ(force_N(first, time_s), force_N(again, time_s));
        own_N2 += std::pow(force_N(first, time_s), 2.0);
        apart_N2 += std::pow(force_N(first, time_s) - force_N(other, time_s), 2.0);
    }
    EXPECT_GT(apart_N2, own_N2);
}

TEST(RandomSegment, has_these_values) {
    // The sum of the lines of seed 5, worked out apart from this code.
    const RandomSegment segment(kShaker, kRandom);
    EXPECT_NEAR(force_N(segment, 0.0), -0.4588533269748, 1e-6);
    EXPECT_NEAR(force_N(segment, 10.0), -1.1909159080607, 1e-6);
    EXPECT_NEAR(force_N(segment, 17.12345), -0.0346711893640, 1e-6);
}

TEST(RandomSegment, goes_on_beyond_its_period) {
    const RandomSegment segment(kShaker, kRandom);
    for (double time_s = 0.0; time_s < 5.0; time_s += 0.0171) {
        ASSERT_NEAR(force_N(segment, time_s), force_N(segment, time_s + 30.0), 1e-9);
    }
}

TEST(RandomSegment, a_short_one_in_a_narrow_band_still_has_many_lines) {
    EXPECT_EQ(RandomSegment::repeat_s({9.0, 10.0, 1.0, 1, 2.0}), 200.0);
}

TEST(ImpulseSegment, is_half_a_sine_whose_integral_is_the_impulse) {
    const ImpulseSegment segment(0.3, 0.02);
    double sum_N_s = 0.0;
    constexpr double kStep_s = 1e-5;
    for (int i = 0; i < 4000; ++i) {
        sum_N_s += kStep_s * force_N(segment, (i + 0.5) * kStep_s);
    }
    EXPECT_NEAR(sum_N_s, 0.3, 1e-6);
    EXPECT_NEAR(force_N(segment, 0.01), 0.3 * kTwoPi / 4.0 / 0.02, 1e-9) << "at its middle";
    EXPECT_EQ(force_N(segment, 0.021), 0.0);
}

double base_m_s2(const Segment &segment, double time_s) {
    return segment.sample(time_s, 0.0).base_accel_m_s2;
}

TEST(RecordSegment, is_straight_between_its_points_and_nothing_after_them) {
    const RecordSegment segment({{3.0, 1.0}, {3.5, 2.0}, {4.5, -4.0}}, 1.0, 1.0);
    EXPECT_NEAR(base_m_s2(segment, 0.0), 1.0, 1e-12) << "begins with its first point";
    EXPECT_NEAR(base_m_s2(segment, 0.25), 1.5, 1e-12);
    EXPECT_NEAR(base_m_s2(segment, 0.5), 2.0, 1e-12);
    EXPECT_NEAR(base_m_s2(segment, 1.0), -1.0, 1e-12);
    EXPECT_NEAR(base_m_s2(segment, 1.5), -4.0, 1e-12) << "its last point";
    EXPECT_EQ(base_m_s2(segment, 1.50001), 0.0);
    EXPECT_EQ(segment.sample(1.0, 7.5).phase_cycles, 7.5);
    EXPECT_EQ(segment.sample(1.0, 7.5).force_N, 0.0);
}

TEST(RecordSegment, gain_and_time_scale_apply) {
    const RecordSegment segment({{0.0, 1.0}, {1.0, 3.0}}, -2.0, 5.0);
    EXPECT_NEAR(base_m_s2(segment, 0.1), -4.0, 1e-12) << "half way after a tenth of a second";
    EXPECT_EQ(base_m_s2(segment, 0.21), 0.0);
}

} // namespace
