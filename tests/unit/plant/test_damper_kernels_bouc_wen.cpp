/// Bouc-Wen, Kwok's asymmetric and Spencer's modified Bouc-Wen, modified and viscous Dahl: limits,
/// passivity, order and step bound.
#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <type_traits>

#include "damper_motion.h"
#include "kernels/bouc_wen.h"
#include "kernels/kwok_bouc_wen.h"
#include "kernels/modified_bouc_wen.h"
#include "kernels/modified_dahl.h"
#include "kernels/normalised_bouc_wen.h"
#include "kernels/viscous_dahl.h"

namespace {

using quiesce::BoucWen;
using quiesce::constant;
using quiesce::Damper;
using quiesce::KwokBoucWen;
using quiesce::ModifiedBoucWen;
using quiesce::ModifiedDahl;
using quiesce::Noise;
using quiesce::NormalisedBoucWen;
using quiesce::run;
using quiesce::Samples;
using quiesce::substeps_for;
using quiesce::ViscousDahl;

double largest(const std::vector<double> &values) {
    double out = 0.0;
    for (const double one : values) {
        out = std::max(out, std::abs(one));
    }
    return out;
}

void expect_same(const Damper &one, const Damper &other, const Samples &samples, double tolerance) {
    const int substeps = std::max(substeps_for(one, samples, 0.2), 1);
    const std::vector<double> a = run(one, samples, substeps);
    const std::vector<double> b = run(other, samples, substeps);
    for (std::size_t k = 0; k < a.size(); ++k) {
        ASSERT_NEAR(a[k], b[k], tolerance * largest(a)) << k;
    }
}

// One and the same damper in three forms: A 1.5, beta 100, gamma 300 1/m2, n 2.
constexpr double kZ0 = 0.0612372435695794525; // sqrt(1.5 / 400)

TEST(BoucWen, is_the_normalised_form_in_other_letters) {
    Noise random(1);
    expect_same(constant<BoucWen>({800.0, 3000.0, 2e5, 1.5, 1e6, 3e6, 2.0, 20.0}),
                constant<NormalisedBoucWen>(
                    {800.0, 3000.0, 2e5 * kZ0 / 100.0, 150.0 / kZ0, 0.75, 2.0, 20.0}),
                quiesce::random_motion(0.005, random), 1e-8);
}

TEST(BoucWen, first_loading_and_unloading_by_hand) {
    // n = 1, beta = gamma = s / 2: z = (A / s)(1 - exp(-s x)), then down with slope A.
    const auto damper = constant<BoucWen>({0.0, 0.0, 1000.0, 2.0, 50.0, 50.0, 1.0, 0.0});
    Samples samples = quiesce::ramp(0.1, 0.02, 200);
    const std::vector<double> up = run(damper, samples, 2);
    const double z1 = 0.02 * (1.0 - std::exp(-2.0));
    EXPECT_NEAR(up.back(), 1000.0 * z1, 1e-7);
    for (int k = 1; k <= 50; ++k) {
        samples.add(0.02 - 1e-4 * k, -0.1, 0.0, 0.0);
    }
    // The turn takes one sample, in which the velocity passes through zero.
    const std::vector<double> force = run(damper, samples, 2);
    EXPECT_NEAR(force[250] - force[202], -1000.0 * 2.0 * 48e-4, 1e-7);
}

TEST(BoucWen, ends_at_its_largest_force) {
    const auto damper = constant<BoucWen>({0.0, 0.0, 2e5, 1.5, 1e6, 3e6, 2.0, 0.0});
    const Samples samples = quiesce::ramp(0.1, 0.02, 200);
    EXPECT_NEAR(run(damper, samples, substeps_for(damper, samples)).back(), 2e5 * kZ0 / 100.0,
                1e-6);
}

TEST(BoucWen, beta_that_would_run_away_is_held) {
    const auto damper = constant<BoucWen>({0.0, 0.0, 1000.0, 1.0, -1e9, 1e6, 2.0, 0.0});
    EXPECT_LT(largest(run(damper, quiesce::sine(0.01, 5.0, 0.0, 20), 20)),
              1000.0 * std::sqrt(1.0 / 1e4) * 1.001);
}

TEST(KwokBoucWen, without_shift_is_bouc_wen) {
    Noise random(2);
    expect_same(constant<KwokBoucWen>({800.0, 0.0, 3000.0, 2e5, 1.5, 1e6, 3e6, 2.0, 20.0}),
                constant<BoucWen>({800.0, 3000.0, 2e5, 1.5, 1e6, 3e6, 2.0, 20.0}),
                quiesce::random_motion(0.005, random), 1e-12);
}

TEST(KwokBoucWen, scale_of_z_is_redundant) {
    Noise random(3);
    const double s = 7.0;
    expect_same(
        constant<KwokBoucWen>({800.0, 0.01, 3000.0, 2e3, 150.0, 100.0, 300.0, 1.7, 0.0}),
        constant<KwokBoucWen>({800.0, 0.01, 3000.0, 2e3 / s, 150.0 * s, 100.0 * std::pow(s, -0.7),
                               300.0 * std::pow(s, -0.7), 1.7, 0.0}),
        quiesce::random_motion(0.005, random), 1e-8);
}

TEST(KwokBoucWen, shift_by_hand) {
    const auto damper =
        constant<KwokBoucWen>({1000.0, 0.01, 0.0, 100.0, 1000.0, 0.0, 1000.0, 1.0, 3.0});
    // Yielded: z = 1.
    EXPECT_NEAR(run(damper, quiesce::ramp(0.1, 0.02, 200), 5).back(),
                1000.0 * (0.1 - 0.01) + 100.0 + 3.0, 1e-4);
}

TEST(ModifiedBoucWen, stiff_series_dashpot_is_bouc_wen_in_parallel) {
    Noise random(4);
    expect_same(
        constant<ModifiedBoucWen>({500.0, 2000.0, 1e13, 700.0, 300.0, 2000.0, 0.8, 1.5, -9.0}),
        constant<NormalisedBoucWen>({500.0, 2700.0, 300.0, 2000.0, 0.8, 1.5, -9.0}),
        quiesce::random_motion(0.005, random), 1e-6);
}

TEST(ModifiedBoucWen, without_hysteresis_is_two_dashpots_in_series) {
    const auto damper = constant<ModifiedBoucWen>({300.0, 0.0, 600.0, 50.0, 0.0, 1e3, 1, 2, 4});
    EXPECT_NEAR(run(damper, quiesce::ramp(0.1, 0.02, 100), 1).back(),
                200.0 * 0.1 + 50.0 * 0.02 + 4.0, 1e-12);
}

TEST(ModifiedBoucWen, rolls_off_at_low_speed) {
    // y' = (kw w + c0 v)/(c0 + c1) carries all of v while kw w can follow: F = c1 v below kw / c1.
    const auto damper =
        constant<ModifiedBoucWen>({100.0, 0.0, 1e4, 0.0, 500.0, 1e5, 0.5, 2.0, 0.0}, 0.01);
    const Samples samples = quiesce::ramp(0.01, 0.01, 500);
    EXPECT_NEAR(run(damper, samples, substeps_for(damper, samples)).back(), 100.0, 1e-3);
}

TEST(ModifiedDahl, follows_its_closed_form) {
    const auto damper = constant<ModifiedDahl>({0.0, 0.0, 100.0, 500.0, 7.0});
    const std::vector<double> force = run(damper, quiesce::ramp(-0.2, 0.006, 60), 2);
    for (std::size_t k = 0; k < force.size(); ++k) {
        ASSERT_NEAR(force[k], 7.0 - 100.0 * (1.0 - std::exp(-0.05 * static_cast<double>(k))), 1e-6);
    }
}

TEST(ModifiedDahl, is_the_normalised_bouc_wen_of_order_1) {
    Noise random(5);
    expect_same(constant<ModifiedDahl>({900.0, 300.0, 400.0, 2000.0, 5.0}),
                constant<NormalisedBoucWen>({300.0, 900.0, 400.0, 2000.0, 1.0, 1.0, 5.0}),
                quiesce::random_motion(0.005, random), 1e-8);
}

TEST(ViscousDahl, is_the_modified_one_without_spring) {
    Noise random(6);
    expect_same(constant<ViscousDahl>({300.0, 400.0, 2000.0, 0.0, 0.0}),
                constant<ModifiedDahl>({0.0, 300.0, 400.0, 2000.0, 0.0}),
                quiesce::random_motion(0.005, random), 1e-14);
}

TEST(ViscousDahl, asymmetry_by_hand) {
    const auto damper = constant<ViscousDahl>({300.0, 400.0, 2000.0, 0.1, -0.25});
    EXPECT_NEAR(run(damper, quiesce::ramp(0.1, 0.02, 400), 1).back(), 330.0 * 0.1 + 300.0, 1e-6);
    EXPECT_NEAR(run(damper, quiesce::ramp(-0.1, 0.02, 400), 1).back(), -270.0 * 0.1 - 500.0, 1e-6);
}

template <class Kernel>
class Hysteresis : public testing::Test {};
using Kernels = testing::Types<BoucWen, KwokBoucWen, ModifiedBoucWen, ModifiedDahl, ViscousDahl>;
struct KernelName {
    template <class Kernel>
    static std::string GetName(int /*index*/) {
        return Kernel::kName;
    }
};
TYPED_TEST_SUITE(Hysteresis, Kernels, KernelName);

/// Random parameters without offset, k >= 0 and, for the passive ones, the rest as it must be.
template <class Kernel>
auto passive_parameters(Noise &random) {
    auto p = quiesce::random_parameters<Kernel>(random);
    for (std::size_t k = 0; k < p.size(); ++k) {
        const std::string name = Kernel::kParameters[k].name;
        if (name == "f0_N" || name == "mu_m_s") {
            p[k] = 0.0;
        } else if (name == "k_N_m" || name == "k1_N_m") {
            p[k] = std::abs(p[k]);
        }
    }
    return p;
}

TYPED_TEST(Hysteresis, gives_out_no_energy_where_it_says_so) {
    Noise random(7);
    int passive = 0;
    for (int trial = 0; trial < 60; ++trial) {
        const auto p = passive_parameters<TypeParam>(random);
        const Samples samples = quiesce::random_motion(0.004, random, 500);
        if (!TypeParam::is_passive(p.data())) {
            continue;
        }
        ++passive;
        const auto damper = constant<TypeParam>(p, samples.fastest_m_s());
        const std::vector<double> force = run(damper, samples, substeps_for(damper, samples));
        double energy_J = 0.0;
        double moved_J = 0.0;
        for (std::size_t k = 1; k < force.size(); ++k) {
            const double part = 0.5 * (force[k] + force[k - 1]) * (samples.x[k] - samples.x[k - 1]);
            energy_J += part;
            moved_J += std::abs(part);
            ASSERT_GE(energy_J, -2e-3 * moved_J) << trial << " " << k;
        }
    }
    EXPECT_GE(passive, 10);
}

TYPED_TEST(Hysteresis, is_odd) {
    Noise random(8);
    for (int trial = 0; trial < 20; ++trial) {
        auto p = quiesce::random_parameters<TypeParam>(random);
        for (std::size_t k = 0; k < p.size(); ++k) {
            p[k] = std::string(TypeParam::kParameters[k].name) == "f0_N" ? 0.0 : p[k];
        }
        const Samples samples = quiesce::random_motion(0.004, random, 300);
        Samples mirrored = samples;
        for (std::size_t k = 0; k < samples.x.size(); ++k) {
            mirrored.x[k] = -samples.x[k];
            mirrored.v[k] = -samples.v[k];
            mirrored.a[k] = -samples.a[k];
        }
        const auto damper = constant<TypeParam>(p, samples.fastest_m_s());
        const int substeps = substeps_for(damper, samples);
        const std::vector<double> there = run(damper, samples, substeps);
        const std::vector<double> here = run(damper, mirrored, substeps);
        for (std::size_t k = 0; k < there.size(); ++k) {
            ASSERT_EQ(there[k], -here[k]) << trial << " " << k;
        }
    }
}

/// Smooth: pulled at a velocity that varies but keeps its sign.
Samples pull() {
    Samples out;
    out.step_s = 1e-3;
    for (int k = 0; k <= 100; ++k) {
        const double t = out.step_s * k;
        out.add(0.05 * t + 2e-4 * (1.0 - std::cos(100.0 * t)), 0.05 + 0.02 * std::sin(100.0 * t),
                2.0 * std::cos(100.0 * t), 0.0);
    }
    return out;
}

/// Of the force at the end of `samples` with so many substeps, against many more.
double error_N(const Damper &damper, const Samples &samples, int substeps) {
    const std::vector<double> exact = run(damper, samples, 64 * substeps);
    const std::vector<double> force = run(damper, samples, substeps);
    double error = 0.0;
    for (std::size_t k = 0; k < force.size(); ++k) {
        error = std::max(error, std::abs(force[k] - exact[k]));
    }
    return error;
}

template <class Kernel>
auto pulled() {
    if constexpr (std::is_same_v<Kernel, BoucWen>) {
        return constant<Kernel>({100.0, 1000.0, 1e5, 1.0, 1e4, 3e4, 2.0, 0.0}, 0.07);
    } else if constexpr (std::is_same_v<Kernel, KwokBoucWen>) {
        return constant<Kernel>({100.0, 0.01, 1000.0, 500.0, 200.0, 50.0, 150.0, 2.0, 0.0}, 0.07);
    } else if constexpr (std::is_same_v<Kernel, ModifiedBoucWen>) {
        return constant<Kernel>({100.0, 1000.0, 2e4, 0.0, 500.0, 500.0, 0.75, 2.0, 0.0}, 0.07);
    } else if constexpr (std::is_same_v<Kernel, ModifiedDahl>) {
        return constant<Kernel>({1000.0, 100.0, 500.0, 500.0, 0.0}, 0.07);
    } else {
        return constant<Kernel>({100.0, 500.0, 500.0, 0.0, 0.0}, 0.07);
    }
}

TYPED_TEST(Hysteresis, converges_with_fourth_order) {
    const auto damper = pulled<TypeParam>();
    const double coarse = error_N(damper, pull(), 2);
    const double fine = error_N(damper, pull(), 4);
    EXPECT_NEAR(std::log2(coarse / fine), 4.0, 0.4) << coarse << " " << fine;
}

/// Yielded at the announced speed, with this part of the announced rate in a step.
double settled_error(const Damper &damper, double rate_1_s, double part) {
    Samples samples;
    samples.step_s = part / rate_1_s;
    for (int k = 0; k <= 400; ++k) {
        samples.add(0.0, 0.07, 0.0, 0.0);
    }
    const std::vector<double> force = run(damper, samples, 1);
    double error = 0.0;
    for (std::size_t k = force.size() - 20; k < force.size(); ++k) {
        const double off = std::abs(force[k] - run(damper, samples, 32).back());
        error = std::isfinite(off) ? std::max(error, off) : 1e300;
    }
    return error / std::abs(run(damper, samples, 32).back());
}

TEST(StepBound, holds_where_the_rate_is_exact) {
    const auto stable_below = [](const Damper &damper) {
        const double rate = damper.fastest_rate_1_s(0.0);
        EXPECT_LT(settled_error(damper, rate, 2.7), 1e-3);
        EXPECT_GT(settled_error(damper, rate, 2.95), 1e-2);
    };
    stable_below(pulled<BoucWen>());
    stable_below(pulled<KwokBoucWen>());
    stable_below(pulled<ModifiedDahl>());
    stable_below(pulled<ViscousDahl>());
}

TEST(StepBound, of_the_modified_model_is_twice_too_careful_at_worst_without_spring) {
    const auto damper =
        constant<ModifiedBoucWen>({100.0, 0.0, 2e4, 0.0, 10.0, 500.0, 0.75, 2.0, 0.0}, 0.07);
    const double rate = damper.fastest_rate_1_s(0.0);
    EXPECT_LT(settled_error(damper, rate, 2.7), 1e-3);
    EXPECT_GT(settled_error(damper, rate, 2.0 * 2.95 * 1.05), 1e-2);
}

} // namespace
