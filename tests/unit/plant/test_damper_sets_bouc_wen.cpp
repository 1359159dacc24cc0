/// Published parameter sets of the Bouc-Wen family and of the squeeze film: each is read, and gives
/// the forces that the reference computed from them independently.
#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "damper_motion.h"
#include "damper_section.h"
#include "file_mistakes.h"
#include "input_error.h"
#include "kernels/kwok_bouc_wen.h"
#include "squeeze_biviscosity.h"

namespace {

using quiesce::expect_message;
using quiesce::InputError;
using quiesce::load_damper;
using quiesce::Loop;
using quiesce::Mistake;
using quiesce::read;
using quiesce::sine_loop;
using quiesce::spoilt;

std::string file(const std::string &name) {
    return "sim_hil/data/dampers/" + name + ".toml";
}

/// Printed to the last digit given: half of that, or 1 %.
void expect_close(double value, double expected, double last_digit) {
    EXPECT_NEAR(value, expected, std::max(0.01 * std::abs(expected), 0.5 * last_digit));
}

struct KwokRow {
    double current_A, freq_Hz, amplitude_m, max_N, min_N, area_J;
};

const KwokRow kKwok[] = {
    {0.0, 2.5, 0.005, 357, -381, 6.64},   {0.0, 10.0, 0.003, 580, -605, 6.11},
    {0.5, 2.5, 0.005, 639, -664, 11.9},   {0.5, 10.0, 0.003, 1009, -1033, 10.6},
    {1.0, 2.5, 0.005, 962, -986, 17.9},   {1.0, 10.0, 0.003, 1477, -1501, 15.6},
    {1.5, 2.5, 0.005, 1325, -1348, 24.7}, {1.5, 10.0, 0.003, 1986, -2009, 21.0},
};

void expect_row(const quiesce::Damper &damper, const KwokRow &row) {
    SCOPED_TRACE(std::to_string(row.current_A) + " A " + std::to_string(row.freq_Hz) + " Hz");
    const Loop loop = sine_loop(damper, row.amplitude_m, row.freq_Hz, row.current_A, 2);
    expect_close(loop.max_N, row.max_N, 1.0);
    expect_close(loop.min_N, row.min_N, 1.0);
    expect_close(loop.area_J, row.area_J, 0.01);
}

TEST(PublishedKwokBoucWen, peaks_and_loop_areas) {
    const auto choice = load_damper(file("rd1005_kwok_bouc_wen"));
    for (const KwokRow &row : kKwok) {
        expect_row(*choice.damper, row);
    }
}

TEST(PublishedKwokBoucWen, softened_set_has_the_same_peaks) {
    const auto choice = load_damper(file("rd1005_kwok_bouc_wen_soft"));
    expect_row(*choice.damper, {1.5, 2.5, 0.005, 1325, -1348, 24.5});
    expect_row(*choice.damper, {1.5, 10.0, 0.003, 1986, -2009, 20.8});
}

TEST(PublishedKwokBoucWen, pre_yield_travel_is_half_a_micrometre) {
    const auto choice = load_damper(file("rd1005_kwok_bouc_wen"));
    // n speed / travel, n from 1.58 to 1.76.
    EXPECT_NEAR(1.58 * 0.2 / choice.damper->fastest_rate_1_s(0.0), 0.50e-6, 0.01e-6);
    EXPECT_NEAR(1.76 * 0.2 / choice.damper->fastest_rate_1_s(1.5), 0.55e-6, 0.01e-6);
}

TEST(PublishedKwokBoucWen, with_mu_in_m_s_it_would_drive) {
    const auto damper = quiesce::constant<quiesce::KwokBoucWen>(
        {6025.0, 1.22, 8555.0, 4845.0, 325e3, 2505e3, 4185e3, 1.76, -11.53}, 0.2);
    const Loop loop = sine_loop(damper, 0.005, 2.5, 1.5);
    expect_close(loop.max_N, 7207, 1.0);
    expect_close(loop.area_J, -122.0, 1.0);
    EXPECT_FALSE(quiesce::KwokBoucWen::is_passive(
        std::array<double, 9>{6025.0, 1.22, 8555.0, 4845.0, 325e3, 2505e3, 4185e3, 1.76, 0.0}
            .data()));
}

void expect_half_ranges(const std::string &name, double amplitude_m,
                        const std::array<double, 4> &expected_N) {
    const auto choice = load_damper(file(name));
    for (std::size_t k = 0; k < expected_N.size(); ++k) {
        const Loop loop =
            sine_loop(*choice.damper, amplitude_m, 2.5, 0.75 * static_cast<double>(k), 6);
        expect_close(loop.half_range_N(), expected_N[k], 1.0);
        EXPECT_GT(loop.area_J, 0.0);
    }
    ASSERT_TRUE(choice.coil.has_value());
    EXPECT_NEAR(choice.coil->rise_s * 190.0, 1.0, 1e-4);
}

TEST(PublishedModifiedBoucWen, prototype) {
    expect_half_ranges("spencer_prototype", 0.015, {550, 912, 1268, 1619});
}

TEST(PublishedModifiedBoucWen, seat_damper) {
    expect_half_ranges("seat_damper", 0.008, {160, 459, 760, 1062});
}

/// The set is not usable, but what it computes to is known.
TEST(PublishedModifiedBoucWen, table_of_the_rd_8040_1) {
    const struct {
        const char *current;
        double max_N, min_N, area_J;
    } rows[] = {
        {"0.0", 3058, -2754, 16.8}, {"0.2", 1630, -1019, 7.3}, {"0.4", 2081, -1135, 9.0},
        {"0.6", 2064, -1184, 8.8},  {"0.8", 2289, -1068, 9.0}, {"1.0", 1944, -1280, 8.7},
    };
    for (const auto &row : rows) {
        SCOPED_TRACE(row.current);
        const auto choice =
            load_damper(file(std::string("rd8040_modified_bouc_wen_") + row.current + "A"));
        const Loop loop = sine_loop(*choice.damper, 0.0015, 10.0, 0.0, 6);
        expect_close(loop.half_range_N(), 0.5 * (row.max_N - row.min_N), 1.0);
        expect_close(loop.area_J, row.area_J, 0.1);
    }
}

TEST(PublishedBoucWen, squeeze_damper_at_four_currents) {
    const double rms_scale_N[] = {0.28, 0.35, 0.42, 0.50}; // of k X and c V together
    for (int i = 0; i < 4; ++i) {
        const auto choice = load_damper(file("squeeze_2012_bouc_wen_" + std::to_string(i) + "A"));
        const Loop loop = sine_loop(*choice.damper, 5e-5, 5.0, i);
        EXPECT_GT(loop.max_N, 0.6 * rms_scale_N[i]);
        EXPECT_LT(loop.max_N, 1.6 * rms_scale_N[i]);
        EXPECT_GT(loop.area_J, 0.0);
    }
}

TEST(PublishedFilm, is_the_squeeze_damper_over_a_motion) {
    const auto choice = load_damper(file("squeeze_2012_film"));
    const quiesce::SqueezeBiviscosity film(
        {0.025, 0.002, 2e-5, 0.042, 3e-5, 0.160, 1.0, 1000.0, 0.030, 4.74e-5});
    const quiesce::Samples samples = quiesce::sine(1e-4, 10.0, 2.0, 1);
    const std::vector<double> force = quiesce::run(*choice.damper, samples, 1);
    for (std::size_t k = 0; k < force.size(); ++k) {
        ASSERT_EQ(force[k], film.force_N({samples.v[k], samples.x[k], 2.0}, nullptr, nullptr));
    }
    EXPECT_EQ(choice.damper->lowest_position_m(), 2e-5 - 0.002);
}

TEST(PublishedFilm, may_say_what_it_was_identified_from) {
    const std::string text = read(file("squeeze_2012_film"));
    const std::string limits = "stroke_m = 1e-4\nspeed_m_s = 0.01\n";
    const auto at = text.find("[parameters]");
    const quiesce::TemporaryFile fitted(text.substr(0, at) + limits + text.substr(at));
    const auto choice = load_damper(fitted.path());
    EXPECT_EQ(choice.damper->lowest_position_m(), 2e-5 - 0.002);
}

class SetMistakes : public testing::TestWithParam<Mistake> {};

TEST_P(SetMistakes, are_named) {
    expect_message(spoilt(read(file("rd1005_kwok_bouc_wen")), GetParam()), GetParam().words,
                   load_damper);
}

const Mistake kSetMistakes[] = {
    {"no_parameter", "alpha_N = [1680.0, 2110.0]\n", "", "parameters.alpha_N: missing"},
    {"cubic", "[1680.0, 2110.0]", "[1.0, 2.0, 3.0, 4.0]", "parameters.alpha_N: expected"},
    {"below_range", "n = [1.58, 0.12]", "n = 0.5", "parameters.n: expected a number in 1 .. 20"},
    {"printed_letter", "delta_1_m", "A", "parameters.delta_1_m: missing"},
    {"unknown", "f0_N =", "x0_m = 0.1\nf0_N =", "parameters.x0_m: unknown key"},
    {"no_stroke", "stroke_m = 0.025\n", "", "stroke_m: missing"},
    {"no_table", "[parameters]", "[parametres]", "parameters: missing"},
    {"text", "[5570.0, 1990.0]", "\"5570\"", "parameters.k_N_m: expected a number"},
};
INSTANTIATE_TEST_SUITE_P(DamperFile, SetMistakes, testing::ValuesIn(kSetMistakes),
                         [](const auto &test) { return std::string(test.param.name); });

} // namespace
