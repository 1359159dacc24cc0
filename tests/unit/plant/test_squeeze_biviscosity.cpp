#include "squeeze_biviscosity.h"

#include <gtest/gtest.h>

#include <cmath>

#include "noise.h"

namespace {

using quiesce::DamperInput;
using quiesce::SqueezeBiviscosity;
using quiesce::SqueezeBiviscosityParams;

constexpr double kPi = 3.14159265358979323846;

SqueezeBiviscosityParams film() {
    return {0.025, 0.002, 2e-5, 0.042, 3e-5, 0.160, 1.0, 1000.0, 0.030, 1.0};
}

double force_N(const SqueezeBiviscosity &damper, const DamperInput &input) {
    return damper.force_N(input, nullptr, nullptr);
}

TEST(SqueezeBiviscosity, yield_stress_at_5_A) {
    EXPECT_NEAR(SqueezeBiviscosity(film()).yield_stress_Pa(5.0), 4244.0, 1.0);
}

TEST(SqueezeBiviscosity, yield_stress_follows_its_exponent) {
    SqueezeBiviscosityParams params = film();
    params.yield_exponent = 1.5;
    const SqueezeBiviscosity damper(params);
    EXPECT_NEAR(damper.yield_stress_Pa(4.0) / damper.yield_stress_Pa(1.0), 8.0, 1e-12);
}

TEST(SqueezeBiviscosity, without_current_it_is_stefans_film) {
    const SqueezeBiviscosity damper(film());
    const double gap_m = 0.0021;
    const double expected =
        3.0 * kPi * 0.042 * std::pow(0.025, 4.0) * 0.003 / (2.0 * std::pow(gap_m, 3.0));
    EXPECT_NEAR(force_N(damper, {0.003, 1e-4, 0.0}) / expected, 1.0, 1e-12);
    EXPECT_NEAR(damper.stiffest_N_s_m(0.0),
                3.0 * kPi * 0.042 * std::pow(0.025, 4.0) / (2.0 * std::pow(0.002, 3.0)), 1e-9);
}

TEST(SqueezeBiviscosity, fast_film_reaches_the_newtonian_limit) {
    const SqueezeBiviscosity damper(film());
    const double newtonian =
        3.0 * kPi * 0.042 * std::pow(0.025, 4.0) / (2.0 * std::pow(0.002, 3.0));
    // chi = eta a v / (h^2 tau1) = 1e6 at 5 A.
    const double velocity_m_s = 1e6 * 4e-6 * damper.yield_stress_Pa(5.0) / (0.042 * 0.025);
    EXPECT_NEAR(force_N(damper, {velocity_m_s, 0.0, 5.0}) / (newtonian * velocity_m_s), 1.0, 1e-6);
}

TEST(SqueezeBiviscosity, slow_film_does_not_depend_on_the_current) {
    const SqueezeBiviscosity damper(film());
    const double slow_m_s = 1e-6; // yield begins at 32 um/s with 1 A
    const double expected =
        3.0 * kPi * 0.042 / 3e-5 * std::pow(0.025, 4.0) * slow_m_s / (2.0 * std::pow(0.002, 3.0));
    for (const double current_A : {1.0, 2.0, 5.0}) {
        EXPECT_NEAR(force_N(damper, {slow_m_s, 0.0, current_A}) / expected, 1.0, 1e-12);
    }
}

TEST(SqueezeBiviscosity, yield_force_of_an_ideal_bingham_film) {
    SqueezeBiviscosityParams params = film();
    params.viscosity_ratio = 1e-12;
    params.viscosity_Pa_s = 1e-6;
    const SqueezeBiviscosity damper(params);
    const double tau1 = damper.yield_stress_Pa(5.0);
    const double yield_N = 2.0 * kPi * tau1 * std::pow(0.025, 3.0) / (3.0 * 0.002);
    // chi = 5e-10, 500 gamma: what is left is 1.2 sqrt(chi).
    const double velocity_m_s = 5e-10 * 4e-6 * tau1 / (1e-6 * 0.025);
    EXPECT_NEAR(force_N(damper, {velocity_m_s, 0.0, 5.0}) / yield_N, 1.0, 4e-5);
}

TEST(SqueezeBiviscosity, force_scale_scales_the_force) {
    SqueezeBiviscosityParams params = film();
    params.force_scale = 4.74e-5;
    const DamperInput input = {0.002, -1e-4, 3.0};
    EXPECT_NEAR(force_N(SqueezeBiviscosity(params), input) /
                    force_N(SqueezeBiviscosity(film()), input),
                4.74e-5, 1e-18);
}

TEST(SqueezeBiviscosity, opposes_motion_at_every_point) {
    const SqueezeBiviscosity damper(film());
    quiesce::Noise random(2012);
    const auto uniform = [&random] { return static_cast<double>(random.bits() >> 11) * 0x1p-53; };
    for (int i = 0; i < 200000; ++i) {
        const double size_m_s = std::pow(10.0, -300.0 + 306.0 * uniform());
        const double velocity_m_s = uniform() < 0.5 ? -size_m_s : size_m_s;
        const double position_m = -0.003 + 0.01 * uniform();
        const double current_A = uniform() < 0.1 ? 0.0 : std::pow(10.0, -12.0 + 13.0 * uniform());
        const double force = force_N(damper, {velocity_m_s, position_m, current_A});
        ASSERT_TRUE(std::isfinite(force)) << velocity_m_s << " " << position_m << " " << current_A;
        ASSERT_GE(force * velocity_m_s, 0.0);
        ASSERT_EQ(force, -force_N(damper, {-velocity_m_s, position_m, current_A})) << "odd in v";
    }
    EXPECT_EQ(force_N(damper, {0.0, 0.0, 5.0}), 0.0);
}

TEST(SqueezeBiviscosity, no_slope_is_steeper_than_announced) {
    const SqueezeBiviscosity damper(film());
    const double stiffest = damper.stiffest_N_s_m(5.0);
    for (double velocity_m_s = 1e-7; velocity_m_s < 1.0; velocity_m_s *= 1.1) {
        const double step = 1e-3 * velocity_m_s;
        const double slope = (force_N(damper, {velocity_m_s + step, 0.0, 5.0}) -
                              force_N(damper, {velocity_m_s, 0.0, 5.0})) /
                             step;
        ASSERT_LE(slope, stiffest * (1.0 + 1e-9)) << velocity_m_s;
    }
}

} // namespace
