/// Published Bingham and hyperbolic tangent sets: each is read, and gives the peaks and loop areas
/// that were computed from the tables independently.
#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "damper_motion.h"
#include "damper_section.h"
#include "file_mistakes.h"

namespace {

using quiesce::expect_message;
using quiesce::load_damper;
using quiesce::Loop;
using quiesce::Mistake;
using quiesce::read;
using quiesce::spoilt;

constexpr double kPi = 3.14159265358979323846;

struct Row {
    const char *name;
    double current_A, freq_Hz, amplitude_m;
    double max_N, min_N, area_J;
};

class PublishedTanh : public testing::TestWithParam<Row> {};

TEST_P(PublishedTanh, peaks_and_loop_areas_within_1_percent) {
    const Row &row = GetParam();
    const auto choice = load_damper("sim_hil/data/dampers/" + std::string(row.name) + ".toml");
    const Loop loop =
        quiesce::sine_loop(*choice.damper, row.amplitude_m, row.freq_Hz, row.current_A);
    EXPECT_NEAR(loop.max_N, row.max_N, std::max(0.01 * std::abs(row.max_N), 0.5));
    EXPECT_NEAR(loop.min_N, row.min_N, std::max(0.01 * std::abs(row.min_N), 0.5));
    EXPECT_NEAR(loop.area_J, row.area_J, 0.01 * row.area_J);
}

INSTANTIATE_TEST_SUITE_P(
    RD1005, PublishedTanh,
    testing::Values(Row{"rd1005_bingham", 1.5, 2.5, 0.005, 1418, -1268, 25.2},
                    Row{"rd1005_bingham", 1.5, 10.0, 0.003, 1968, -1818, 20.3},
                    Row{"rd1005_kwok_tanh", 0.0, 2.5, 0.005, 189, -75, 2.15},
                    Row{"rd1005_kwok_tanh", 0.0, 10.0, 0.003, 322, -208, 2.57},
                    Row{"rd1005_kwok_tanh", 0.5, 2.5, 0.005, 652, -556, 11.2},
                    Row{"rd1005_kwok_tanh", 0.5, 10.0, 0.003, 892, -796, 9.05},
                    Row{"rd1005_kwok_tanh", 1.0, 2.5, 0.005, 994, -916, 17.8},
                    Row{"rd1005_kwok_tanh", 1.0, 10.0, 0.003, 1341, -1263, 14.1},
                    Row{"rd1005_kwok_tanh", 1.5, 2.5, 0.005, 1214, -1154, 22.0},
                    Row{"rd1005_kwok_tanh", 1.5, 10.0, 0.003, 1668, -1608, 17.6}));

INSTANTIATE_TEST_SUITE_P(
    RD8040, PublishedTanh,
    testing::Values(Row{"rd8040_kwok_tanh_0.0A", 0.0, 10.0, 0.0015, 242, -258, 1.28},
                    Row{"rd8040_kwok_tanh_0.2A", 0.2, 10.0, 0.0015, 655, -557, 3.28},
                    Row{"rd8040_kwok_tanh_0.4A", 0.4, 10.0, 0.0015, 823, -860, 4.50},
                    Row{"rd8040_kwok_tanh_0.6A", 0.6, 10.0, 0.0015, 1060, -995, 5.37},
                    Row{"rd8040_kwok_tanh_0.8A", 0.8, 10.0, 0.0015, 1197, -1202, 6.15},
                    Row{"rd8040_kwok_tanh_1.0A", 1.0, 10.0, 0.0015, 1226, -1254, 6.30},
                    Row{"rd8040_kwok_tanh", 1.0, 10.0, 0.0015, 1226, -1254, 6.30}));

TEST(PublishedKwokTanh, single_set_of_the_rd8040_over_its_currents) {
    const auto choice = load_damper("sim_hil/data/dampers/rd8040_kwok_tanh.toml");
    const double peak_N[] = {75, 525, 865, 1096, 1216, 1226};
    for (int k = 0; k < 6; ++k) {
        const Loop loop = quiesce::sine_loop(*choice.damper, 0.0015, 10.0, 0.2 * k);
        EXPECT_NEAR(loop.max_N, peak_N[k], 0.01 * peak_N[k]) << 0.2 * k << " A";
    }
}

/// In-phase part of the force over x = 5 mm sin at 2.5 Hz, in N/m.
template <class Force>
double equivalent_stiffness_N_m(Force &&force_N) {
    constexpr int kCount = 4000;
    double sum = 0.0;
    for (int k = 0; k < kCount; ++k) {
        const double angle = 2.0 * kPi * (k + 0.5) / kCount;
        const double x_m = 0.005 * std::sin(angle);
        const double v_m_s = 0.005 * 5.0 * kPi * std::cos(angle);
        sum += force_N(x_m, v_m_s) * std::sin(angle);
    }
    return 2.0 * sum / (kCount * 0.005);
}

TEST(PublishedKwokTanh, loop_needs_the_sign_of_the_displacement) {
    const auto choice = load_damper("sim_hil/data/dampers/rd1005_kwok_tanh.toml");
    const double ours_N_m = equivalent_stiffness_N_m([&](double x_m, double v_m_s) {
        return choice.damper->force_N({v_m_s, x_m, 1.5}, nullptr, nullptr);
    });
    const double sign_of_v_N_m = equivalent_stiffness_N_m([](double x_m, double v_m_s) {
        return 4125.5 * v_m_s + 2550.0 * x_m +
               860.0 * std::tanh(100.0 * v_m_s + std::copysign(1.03, v_m_s)) + 30.0;
    });
    EXPECT_NEAR(ours_N_m, 31e3, 500.0);
    EXPECT_NEAR(sign_of_v_N_m, 2.8e3, 300.0);
}

class DamperFileMistakes : public testing::TestWithParam<Mistake> {};

TEST_P(DamperFileMistakes, are_named) {
    expect_message(spoilt(read("sim_hil/data/dampers/rd1005_bingham.toml"), GetParam()),
                   GetParam().words, load_damper);
}

INSTANTIATE_TEST_SUITE_P(
    RD1005, DamperFileMistakes,
    testing::Values(
        Mistake{"other_schema", "\"quiesce-damper\"", "\"quiesce-plant\"",
                "schema: expected one of: quiesce-damper; found 'quiesce-plant'"},
        Mistake{"no_name", "name = \"rd1005_bingham\"", "", "name: missing"},
        Mistake{"unknown_model", "model = \"bingham\"", "model = \"binghamm\"",
                "model: expected one of:"},
        Mistake{"negative_friction", "fc_N = 950.0", "fc_N = -950.0", "parameters.fc_N: expected"},
        Mistake{"no_friction", "fc_N = 950.0", "", "parameters.fc_N: missing"},
        Mistake{"zero_eps", "eps_m_s = 0.002", "eps_m_s = 0.0", "parameters.eps_m_s: expected"},
        Mistake{"nan", "c_N_s_m = 5000.0", "c_N_s_m = nan", "parameters.c_N_s_m: expected"},
        Mistake{"unknown_parameter", "fc_N = 950.0", "fc_N = 950.0\nfd_N = 1.0",
                "parameters.fd_N: unknown key"},
        Mistake{"no_stroke", "stroke_m = 0.025", "", "stroke_m: missing"}),
    [](const testing::TestParamInfo<Mistake> &param) { return std::string(param.param.name); });

} // namespace
