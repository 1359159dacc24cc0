#include "squeeze_psi.h"

#include <gtest/gtest.h>

#include <cmath>
#include <initializer_list>

#include "squeeze_psi_lanes.h"

namespace {

using quiesce::squeeze_psi_closed_form;
using quiesce::squeeze_psi_quadrature;
using quiesce::squeeze_wall_excess;
using quiesce::SqueezePsi;

double relative(double value, double expected) {
    return std::abs(value / expected - 1.0);
}

/// Plain Simpson rule over S with G from the cubic by bisection: shares nothing with the code under
/// test.
double psi_by_definition(double chi, double gamma) {
    const auto wall_stress = [gamma](double s) {
        if (s <= gamma / 3.0) {
            return 3.0 * s / gamma;
        }
        const double k = 1.0 - gamma;
        double low = 1.0;
        double high = 3.0 * s + 1.5 + 1.0;
        for (int i = 0; i < 200; ++i) {
            const double g = 0.5 * (low + high);
            (g * g * g - 3.0 * (s + 0.5 * k) * g * g + 0.5 * k < 0.0 ? low : high) = g;
        }
        return low;
    };
    constexpr int kIntervals = 20000;
    double sum = 0.0;
    for (int i = 0; i <= kIntervals; ++i) {
        const double s = chi * i / kIntervals;
        const double weight = i == 0 || i == kIntervals ? 1.0 : (i % 2 == 1 ? 4.0 : 2.0);
        sum += weight * s * s * wall_stress(s);
    }
    return sum * chi / (3.0 * kIntervals) / (chi * chi * chi);
}

TEST(SqueezePsi, quadrature_matches_the_definition) {
    for (const double gamma : {0.3, 0.05, 3e-3}) {
        for (const double chi : {0.02, 0.3, 4.0, 60.0}) {
            EXPECT_LT(relative(squeeze_psi_quadrature(chi, gamma), psi_by_definition(chi, gamma)),
                      2e-7)
                << "chi " << chi << " gamma " << gamma;
        }
    }
}

TEST(SqueezePsi, without_a_table_it_is_the_quadrature) {
    for (double gamma = 1e-12; gamma <= 1.0; gamma *= 10.0) {
        EXPECT_EQ(quiesce::squeeze_psi_of(0.0, gamma), 0.0);
        for (double chi = 0.1 * gamma; chi < 1e6; chi *= 1.07) {
            ASSERT_LT(
                relative(quiesce::squeeze_psi_of(chi, gamma), squeeze_psi_quadrature(chi, gamma)),
                1e-9)
                << "chi " << chi << " gamma " << gamma;
        }
    }
}

TEST(SqueezePsi, wall_excess_solves_the_cubic) {
    for (const double gamma : {1.0, 0.2, 3e-5}) {
        for (const double excess : {1e-12, 1e-6, 1e-2, 1.0, 1e5}) {
            const double x = squeeze_wall_excess(excess, gamma);
            const double g = 1.0 + x;
            const double back =
                x * (x * (2.0 * x + 3.0) + gamma * (2.0 + x)) / (6.0 * g * g); // S - gamma/3
            EXPECT_LT(relative(back, excess), 1e-12) << "excess " << excess << " gamma " << gamma;
        }
    }
}

TEST(SqueezePsi, unyielded_film_is_linear) {
    const double gamma = 3e-5;
    for (const double part : {1e-12, 0.1, 1.0}) {
        const double chi = part * gamma / 3.0;
        EXPECT_DOUBLE_EQ(squeeze_psi_quadrature(chi, gamma), 0.75 * chi / gamma);
    }
    EXPECT_EQ(squeeze_psi_quadrature(0.0, gamma), 0.0);
}

TEST(SqueezePsi, newtonian_limit) {
    for (const double gamma : {1e-12, 3e-5, 0.5, 1.0}) {
        for (const double chi : {1e6, 1e8}) {
            EXPECT_LT(relative(squeeze_psi_quadrature(chi, gamma), 0.75 * chi), 1e-6);
        }
    }
}

TEST(SqueezePsi, newtonian_limit_converges_as_one_over_chi) {
    // Psi = 3 chi/4 + (1 - gamma)/2 + ..: the distance from the limit is 2/3 (1 - gamma)/chi.
    for (const double chi : {1e3, 1e4, 1e5}) {
        const double distance = squeeze_psi_quadrature(chi, 3e-5) / (0.75 * chi) - 1.0;
        EXPECT_NEAR(distance * chi, 2.0 / 3.0, 1e-4);
    }
}

TEST(SqueezePsi, equal_viscosities_are_newtonian_everywhere) {
    for (const double chi : {1e-9, 0.1, 1.0, 1e3}) {
        EXPECT_LT(relative(squeeze_psi_quadrature(chi, 1.0), 0.75 * chi), 1e-13);
    }
}

TEST(SqueezePsi, bingham_limit_to_1e_6) {
    // G -> 1 + sqrt(2 S), so that Psi -> 1/3 + (2 sqrt(2)/7) sqrt(chi) for gamma << chi << 1.
    for (const double gamma : {1e-18, 1e-16}) {
        for (const double chi : {1e-13, 1e-12, 2e-11}) {
            const double expected = 1.0 / 3.0 + 2.0 * std::sqrt(2.0) / 7.0 * std::sqrt(chi);
            EXPECT_LT(relative(squeeze_psi_quadrature(chi, gamma), expected), 1e-6);
        }
        EXPECT_LT(relative(squeeze_psi_quadrature(5e-13, gamma), 1.0 / 3.0), 1e-6);
    }
}

TEST(SqueezePsi, bingham_limit_converges_as_root_of_chi) {
    // gamma <= 1e-12: the distance from 1/3 falls by sqrt(10) a decade while gamma << chi.
    const double far = 3.0 * squeeze_psi_quadrature(2e-9, 1e-15) - 1.0;
    const double near = 3.0 * squeeze_psi_quadrature(2e-11, 1e-15) - 1.0;
    EXPECT_NEAR(far / near, 10.0, 0.05);
    EXPECT_LT(near, 6e-6);
}

TEST(SqueezePsi, closed_form_agrees_where_it_is_well_conditioned) {
    for (const double gamma : {1.0, 0.5, 0.1, 1e-2}) {
        for (const double chi : {0.1, 0.5, 2.0, 10.0, 300.0}) {
            EXPECT_LT(
                relative(squeeze_psi_closed_form(chi, gamma), squeeze_psi_quadrature(chi, gamma)),
                1e-11)
                << "chi " << chi << " gamma " << gamma;
        }
    }
}

TEST(SqueezePsi, interpolant_is_within_1e_8_everywhere) {
    for (const double gamma : {1.0, 0.5, 1e-2, 3e-5, 1e-12}) {
        const SqueezePsi psi(gamma);
        double worst = 0.0;
        for (double exponent = -17.0; exponent < 8.0; exponent += 1e-3) {
            const double chi = std::pow(10.0, exponent);
            worst = std::max(worst, relative(psi(chi), squeeze_psi_quadrature(chi, gamma)));
        }
        EXPECT_LT(worst, 1e-10) << "gamma " << gamma;
    }
}

TEST(SqueezePsi, interpolant_is_within_1e_8_next_to_yield) {
    for (const double gamma : {0.5, 3e-5, 1e-12}) {
        const SqueezePsi psi(gamma);
        double worst = 0.0;
        for (double exponent = -15.0; exponent < 1.0; exponent += 1e-3) {
            const double chi = gamma / 3.0 * (1.0 + std::pow(10.0, exponent));
            worst = std::max(worst, relative(psi(chi), squeeze_psi_quadrature(chi, gamma)));
        }
        EXPECT_LT(worst, 1e-10) << "gamma " << gamma;
    }
}

TEST(SqueezePsi, rises_with_chi) {
    const SqueezePsi psi(3e-5);
    double last = 0.0;
    for (double exponent = -12.0; exponent < 7.0; exponent += 1e-3) {
        const double now = psi(std::pow(10.0, exponent));
        ASSERT_GT(now, last) << "at 1e" << exponent;
        last = now;
    }
}

} // namespace
