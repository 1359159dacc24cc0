#include "switched_stiffness.h"

#include <gtest/gtest.h>

#include <cmath>

namespace {

using quiesce::SwitchedStiffness;

constexpr double kTwoPi = 6.28318530717958647692;
constexpr double kPeak_m = 0.003;
constexpr double kOmega_rad_s = kTwoPi * 10.0;

/// Work done on the structure in one cycle of x = kPeak_m cos(psi) under current_A(x, v).
template <typename Current>
double work_J(const SwitchedStiffness &damper, Current current_A) {
    constexpr int kSteps = 100000;
    double work = 0.0;
    for (int i = 0; i < kSteps; ++i) {
        const double psi = kTwoPi * (i + 0.5) / kSteps;
        const double x_m = kPeak_m * std::cos(psi);
        const double v_m_s = -kPeak_m * kOmega_rad_s * std::sin(psi);
        const double force_N =
            damper.force_N({v_m_s, x_m, current_A(x_m, v_m_s)}, nullptr, nullptr);
        work -= force_N * v_m_s * kTwoPi / kOmega_rad_s / kSteps;
    }
    return work;
}

TEST(SwitchedStiffness, force_is_the_sum_of_both) {
    const SwitchedStiffness damper({100.0, 50.0, 3000.0, 400.0, 0.01});
    EXPECT_DOUBLE_EQ(damper.force_N({0.2, 0.003, 2.0}, nullptr, nullptr),
                     200.0 * 0.2 + 3800.0 * 0.003);
    EXPECT_DOUBLE_EQ(damper.stiffest_N_s_m(2.0), 200.0);
    EXPECT_DOUBLE_EQ(damper.stiffest_N_m(2.0), 3800.0);
    EXPECT_DOUBLE_EQ(damper.lowest_position_m(), -0.01);
}

TEST(SwitchedStiffness, a_constant_current_makes_no_work_of_it) {
    const SwitchedStiffness damper({0.0, 0.0, 3000.0, 400.0, 0.01});
    EXPECT_NEAR(work_J(damper, [](double, double) { return 2.0; }), 0.0, 1e-9);
}

TEST(SwitchedStiffness, work_follows_when_the_current_is_on) {
    constexpr double kPerA_N_m = 400.0;
    constexpr double kCurrent_A = 2.0;
    const SwitchedStiffness damper({0.0, 0.0, 3000.0, kPerA_N_m, 0.01});
    // Twice a cycle a spring of 800 N/m is loaded from 0 to the peak, or unloaded.
    const double swing_J = kPerA_N_m * kCurrent_A * kPeak_m * kPeak_m;
    const auto outwards = [](double x, double v) { return x * v > 0.0 ? kCurrent_A : 0.0; };
    const auto inwards = [](double x, double v) { return x * v < 0.0 ? kCurrent_A : 0.0; };
    EXPECT_NEAR(work_J(damper, outwards), -swing_J, 1e-6 * swing_J) << "takes energy out";
    EXPECT_NEAR(work_J(damper, inwards), swing_J, 1e-6 * swing_J) << "puts energy in";
}

TEST(SwitchedStiffness, its_viscous_part_only_takes) {
    const SwitchedStiffness damper({100.0, 50.0, 0.0, 0.0, 0.01});
    const double expected_J =
        -200.0 * kPeak_m * kPeak_m * kOmega_rad_s * kOmega_rad_s / 2.0 * kTwoPi / kOmega_rad_s;
    EXPECT_NEAR(work_J(damper, [](double, double) { return 2.0; }), expected_J, 1e-9);
}

} // namespace
