/// Polynomials of the velocity by the sign of the acceleration.
#include <gtest/gtest.h>

#include <array>
#include <cmath>

#include "damper_motion.h"
#include "kernels/choi_polynomial.h"
#include "kernels/second_order_polynomial.h"

namespace {

using quiesce::ChoiPolynomial;
using quiesce::constant;
using quiesce::Motion;
using quiesce::SecondOrderPolynomial;

template <class Kernel, std::size_t kCount>
double force_N(const std::array<double, kCount> &p, double v, double a) {
    const double *no_states = nullptr;
    double *no_rates = nullptr;
    return Kernel::force_N(p.data(), Motion<double>{0.0, v, a, 0.0}, no_states, no_rates);
}

constexpr std::array<double, 7> kSecond{1.0, 20.0, 300.0, -4.0, 50.0, -600.0, 0.2};
constexpr std::array<double, 15> kChoi{1.0,  2.0, 3.0,  4.0, 5.0,  6.0, 7.0, -1.0,
                                       20.0, 3.0, 40.0, 5.0, 60.0, 7.0, 2.0};

TEST(SecondOrderPolynomial, by_hand) {
    EXPECT_DOUBLE_EQ(force_N<SecondOrderPolynomial>(kSecond, 0.1, 1.0), 1.0 + 2.0 + 3.0);
    EXPECT_DOUBLE_EQ(force_N<SecondOrderPolynomial>(kSecond, 0.1, -1.0), -4.0 + 5.0 - 6.0);
    EXPECT_DOUBLE_EQ(force_N<SecondOrderPolynomial>(kSecond, -0.1, 1.0), 1.0 - 2.0 + 3.0);
}

TEST(SecondOrderPolynomial, at_no_acceleration_is_the_mean) {
    EXPECT_DOUBLE_EQ(force_N<SecondOrderPolynomial>(kSecond, 0.1, 0.0), 0.5);
}

TEST(SecondOrderPolynomial, holds_beyond_the_speed_of_the_fit) {
    for (const double side : {-1.0, 1.0}) {
        EXPECT_EQ(force_N<SecondOrderPolynomial>(kSecond, side * 50.0, 1.0),
                  force_N<SecondOrderPolynomial>(kSecond, side * 0.2, 1.0));
    }
}

TEST(ChoiPolynomial, by_hand) {
    EXPECT_NEAR(force_N<ChoiPolynomial>(kChoi, 2.0, 1.0),
                1.0 + 4.0 + 12.0 + 32.0 + 80.0 + 192.0 + 448.0, 1e-10);
    EXPECT_NEAR(force_N<ChoiPolynomial>(kChoi, -2.0, -1.0),
                -1.0 - 40.0 + 12.0 - 320.0 + 80.0 - 1920.0 + 448.0, 1e-10);
}

TEST(ChoiPolynomial, coefficients_follow_the_current) {
    // b + c I: printed as such; here each coefficient with its law.
    std::array<quiesce::CurrentLaw, 15> laws{};
    laws[1] = {100.0, 50.0, 0.0};
    laws[8] = {100.0, 50.0, 0.0};
    laws[14] = {1.0, 0.0, 0.0};
    const quiesce::KernelDamper<ChoiPolynomial> damper(laws.data(), 0.01, 1.0);
    EXPECT_TRUE(damper.uses_accel());
    EXPECT_DOUBLE_EQ(damper.force_N({0.1, 0.0, 2.0, 1.0}, nullptr, nullptr), 20.0);
}

TEST(ChoiPolynomial, odd_sets_make_an_odd_force) {
    std::array<double, 15> p = kChoi;
    for (std::size_t k = 0; k < 7; ++k) {
        p[7 + k] = k % 2 == 1 ? p[k] : -p[k];
    }
    for (const double v : {-3.0, -0.7, 0.0, 0.3, 1.9}) {
        for (const double a : {-1.0, 0.0, 1.0}) {
            EXPECT_EQ(force_N<ChoiPolynomial>(p, v, a), -force_N<ChoiPolynomial>(p, -v, -a));
        }
    }
}

TEST(ChoiPolynomial, is_passive_only_with_odd_positive_terms) {
    std::array<double, 15> p{};
    p[14] = 1.0;
    p[1] = p[3] = p[8] = p[12] = 5.0;
    EXPECT_TRUE(ChoiPolynomial::is_passive(p.data()));
    p[2] = 1e-3;
    EXPECT_FALSE(ChoiPolynomial::is_passive(p.data()));
    p[2] = 0.0;
    p[10] = -1.0;
    EXPECT_FALSE(ChoiPolynomial::is_passive(p.data()));
}

TEST(ChoiPolynomial, no_slope_is_steeper_than_announced) {
    const double stiffest = ChoiPolynomial::stiffest_N_s_m(kChoi.data());
    for (double v = -2.1; v < 2.1; v += 0.01) {
        for (const double a : {-1.0, 1.0}) {
            const double slope = (force_N<ChoiPolynomial>(kChoi, v + 1e-6, a) -
                                  force_N<ChoiPolynomial>(kChoi, v, a)) /
                                 1e-6;
            ASSERT_LE(std::abs(slope), stiffest * (1.0 + 1e-6));
        }
    }
}

} // namespace
