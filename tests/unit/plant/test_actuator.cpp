#include <gtest/gtest.h>

#include <cmath>

#include "coil.h"
#include "current_driver.h"
#include "remanence.h"

namespace {

using quiesce::Coil;
using quiesce::CurrentDriver;
using quiesce::Remanence;

TEST(CurrentDriver, rounds_to_the_nearest_of_4095_steps) {
    const CurrentDriver driver({5.0, 12});
    const double step_A = 5.0 / 4095.0;
    EXPECT_DOUBLE_EQ(driver.output_A(0.0), 0.0);
    EXPECT_DOUBLE_EQ(driver.output_A(0.49 * step_A), 0.0);
    EXPECT_DOUBLE_EQ(driver.output_A(0.51 * step_A), step_A);
    EXPECT_DOUBLE_EQ(driver.output_A(100.2 * step_A), 100.0 * step_A);
    for (double command_A = 0.0; command_A <= 5.0; command_A += 0.001) {
        ASSERT_LE(std::abs(driver.output_A(command_A) - command_A), 0.5001 * step_A);
    }
}

TEST(CurrentDriver, limits_to_its_range) {
    const CurrentDriver driver({5.0, 12});
    EXPECT_DOUBLE_EQ(driver.output_A(-1.0), 0.0);
    EXPECT_NEAR(driver.output_A(7.0), 5.0, 1e-12);
}

TEST(Coil, reaches_63_percent_after_one_time_constant_each_way) {
    const Coil coil({0.005, 0.002}, 1e-4);
    double current_A = 0.0;
    for (int i = 0; i < 50; ++i) {
        current_A = coil.step(current_A, 4.0);
    }
    EXPECT_NEAR(current_A, 4.0 * (1.0 - std::exp(-1.0)), 1e-12);
    const double from_A = current_A;
    for (int i = 0; i < 20; ++i) {
        current_A = coil.step(current_A, 0.0);
    }
    EXPECT_NEAR(current_A, from_A * std::exp(-1.0), 1e-12);
}

TEST(Coil, without_time_constant_follows_at_once) {
    const Coil coil({0.0, 0.0}, 1e-4);
    EXPECT_EQ(coil.step(1.0, 3.0), 3.0);
    EXPECT_EQ(coil.step(3.0, 0.0), 0.0);
}

TEST(Remanence, falls_later_than_the_coil_and_rises_with_it) {
    const Remanence remanence(0.25);
    const double coil_A[] = {0.0, 1.0, 0.9, 0.75, 0.5, 0.6, 0.7, 0.8, 0.0, 0.1, 0.3};
    const double expected_A[] = {0.0, 1.0, 1.0, 1.0, 0.75, 0.75, 0.75, 0.8, 0.25, 0.25, 0.3};
    double effective_A = 0.0;
    for (std::size_t i = 0; i < 11; ++i) {
        effective_A = remanence.step(effective_A, coil_A[i]);
        EXPECT_DOUBLE_EQ(effective_A, expected_A[i]) << "step " << i;
    }
}

TEST(Remanence, does_not_depend_on_how_fine_the_steps_are) {
    const Remanence remanence(0.3);
    const double at_once_A = remanence.step(remanence.step(0.2, 2.0), 0.4);
    double effective_A = 0.2;
    for (int i = 0; i <= 160; ++i) {
        effective_A = remanence.step(effective_A, 2.0 - 0.01 * i);
    }
    EXPECT_NEAR(effective_A, at_once_A, 1e-12);
    EXPECT_NEAR(at_once_A, 0.7, 1e-12);
}

TEST(Remanence, of_no_width_is_the_coils_current) {
    const Remanence none(0.0);
    for (const double coil_A : {0.0, 1.7, 0.3, 0.1, 5.0}) {
        EXPECT_EQ(none.step(3.0, coil_A), coil_A);
    }
}

} // namespace
