/// Bingham and its extensions, biviscous, arctangent and magic formula models: limits, values by
/// hand, independent references, order and step bound.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <vector>

#include "damper_motion.h"
#include "kernels/arctangent.h"
#include "kernels/bingham.h"
#include "kernels/extended_tanh_bingham.h"
#include "kernels/fractional_bingham.h"
#include "kernels/gamota_filisko.h"
#include "kernels/hysteretic_biviscous.h"
#include "kernels/magic_formula.h"
#include "kernels/nonlinear_bingham_hysteretic.h"
#include "kernels/nonlinear_biviscous.h"
#include "kernels/zhang_tanh.h"

namespace {

using quiesce::Arctangent;
using quiesce::Bingham;
using quiesce::constant;
using quiesce::Damper;
using quiesce::DamperInput;
using quiesce::ExtendedTanhBingham;
using quiesce::FractionalBingham;
using quiesce::GamotaFilisko;
using quiesce::HystereticBiviscous;
using quiesce::MagicFormula;
using quiesce::Noise;
using quiesce::NonlinearBinghamHysteretic;
using quiesce::NonlinearBiviscous;
using quiesce::ramp;
using quiesce::run;
using quiesce::Samples;
using quiesce::sine;
using quiesce::substeps_for;
using quiesce::ZhangTanh;

constexpr double kPi = 3.14159265358979323846;

/// Of a model without states.
double static_N(const Damper &damper, double x_m, double v_m_s, double a_m_s2 = 0.0) {
    DamperInput input{};
    input.position_m = x_m;
    input.velocity_m_s = v_m_s;
    input.accel_m_s2 = a_m_s2;
    return damper.force_N(input, nullptr, nullptr);
}

double largest_difference(const std::vector<double> &a, const std::vector<double> &b) {
    double most = 0.0;
    for (std::size_t k = 0; k < a.size(); ++k) {
        const double off = std::abs(a[k] - b[k]);
        most = off <= most ? most : off;
    }
    return most;
}

/// Force amplitude and phase against x = amplitude sin over the last of some cycles, per metre.
std::complex<double> stiffness_N_m(const std::vector<double> &force_N, double amplitude_m,
                                   int cycles) {
    const std::size_t per_cycle = (force_N.size() - 1) / static_cast<std::size_t>(cycles);
    std::complex<double> sum = 0.0;
    for (std::size_t k = force_N.size() - 1 - per_cycle; k + 1 < force_N.size(); ++k) {
        const double angle =
            2.0 * kPi * static_cast<double>(k % per_cycle) / static_cast<double>(per_cycle);
        sum += force_N[k] * std::complex<double>(std::sin(angle), std::cos(angle));
    }
    return sum * 2.0 / (static_cast<double>(per_cycle) * amplitude_m);
}

/// How much smaller the error gets when the step is halved, at a fine step.
double gain_of_halving(const Damper &damper, const Samples &samples, int substeps) {
    const std::vector<double> exact = run(damper, samples, 64 * substeps);
    return largest_difference(run(damper, samples, substeps), exact) /
           largest_difference(run(damper, samples, 2 * substeps), exact);
}

TEST(Bingham, is_friction_and_damping_far_from_rest) {
    const auto damper = constant<Bingham>({950.0, 5000.0, 75.0, 0.002});
    EXPECT_NEAR(static_N(damper, 0.0, 0.08), 950.0 + 400.0 + 75.0, 1e-9);
    EXPECT_NEAR(static_N(damper, 0.0, -0.08), -950.0 - 400.0 + 75.0, 1e-9);
    EXPECT_NEAR(static_N(damper, 0.0, 0.002), 950.0 * std::tanh(1.0) + 10.0 + 75.0, 1e-6);
    EXPECT_NEAR(damper.stiffest_N_s_m(0.0), 950.0 / 0.002 + 5000.0, 1e-9);
}

TEST(NonlinearBinghamHysteretic, first_loading_by_hand) {
    // Straight to 0.8 fy at 8 mm, then s = 0.8 + 0.2 tanh(5 rho (x - 8 mm)).
    const auto damper = constant<NonlinearBinghamHysteretic>({500.0, 100.0, 0.0, 0.0, 0.0, 0.0});
    const Samples samples = ramp(0.05, 0.016, 160);
    const std::vector<double> force = run(damper, samples, 10);
    EXPECT_NEAR(force[40], 500.0 * 0.4, 1e-9);
    EXPECT_NEAR(force[80], 500.0 * 0.8, 1e-9);
    for (const std::size_t k : {90U, 110U, 160U}) {
        const double past_m = samples.x[k] - 0.008;
        EXPECT_NEAR(force[k], 500.0 * (0.8 + 0.2 * std::tanh(500.0 * past_m)), 1e-6);
    }
}

TEST(NonlinearBinghamHysteretic, unloads_with_its_spring) {
    const auto damper =
        constant<NonlinearBinghamHysteretic>({500.0, 2000.0, 0.0, 0.0, 0.0, 0.0}, 0.2);
    const Samples samples = sine(0.01, 3.0, 0.0, 1, 4000);
    const std::vector<double> force = run(damper, samples, 20);
    const std::size_t turn = 1000; // a quarter: largest displacement
    EXPECT_NEAR(force[turn], 500.0, 1e-3);
    const std::size_t later = 1060;
    const double back_m = samples.x[turn] - samples.x[later];
    ASSERT_LT(2000.0 * back_m, 1.7);
    EXPECT_NEAR(force[later], 500.0 * (1.0 - 2000.0 * back_m), 0.05);
}

TEST(NonlinearBinghamHysteretic, damping_is_cubic_and_odd) {
    const auto damper = constant<NonlinearBinghamHysteretic>({0.0, 1.0, 100.0, 30.0, 7.0, 0.0});
    double state = 0.0;
    double rate = 0.0;
    for (const double v : {-2.0, 2.0}) {
        DamperInput input{};
        input.velocity_m_s = v;
        EXPECT_NEAR(damper.force_N(input, &state, &rate), v * (100.0 + 60.0 + 28.0), 1e-9);
    }
}

TEST(NonlinearBinghamHysteretic, order_and_step_bound) {
    const auto damper =
        constant<NonlinearBinghamHysteretic>({500.0, 1000.0, 0.0, 0.0, 0.0, 0.0}, 0.05);
    const double rate_1_s = damper.fastest_rate_1_s(0.0);
    EXPECT_NEAR(rate_1_s, 500.0, 1e-9);
    // The knee begins at a sample: 0.8 mm of 1.2 mm.
    EXPECT_NEAR(gain_of_halving(damper, ramp(0.05, 0.0012, 12), 8), 16.0, 3.0);
    const auto end_N = [&](double part) {
        return run(damper, ramp(0.05, 0.05 * 400.0 * part / rate_1_s, 400), 1).back();
    };
    EXPECT_NEAR(end_N(2.6), 500.0, 1e-3);
    EXPECT_GT(std::abs(end_N(3.3) - 500.0), 1.0);
}

TEST(FractionalBingham, sinusoid_limit) {
    for (const double phi : {0.2, 0.5, 0.8}) {
        const auto damper = constant<FractionalBingham>({0.0, 1.0, phi, 0.0, 1.0});
        for (const double freq_Hz : {0.25, 2.5, 25.0, 90.0}) {
            const Samples samples = sine(0.01, freq_Hz, 0.0, 20, 200);
            const std::vector<double> force =
                run(damper, samples, substeps_for(damper, samples, 1.0));
            const std::complex<double> exact =
                std::pow(std::complex<double>(0.0, 2.0 * kPi * freq_Hz), phi);
            const std::complex<double> found = stiffness_N_m(force, 0.01, 20);
            EXPECT_LT(std::abs(found / exact - 1.0), 0.013) << phi << " " << freq_Hz << " Hz";
        }
    }
}

/// Gruenwald-Letnikov derivative of samples that were zero before, with its full memory.
std::vector<double> gruenwald_letnikov(const std::vector<double> &x, double step_s, double order) {
    std::vector<double> weight(x.size(), 1.0);
    for (std::size_t k = 1; k < x.size(); ++k) {
        weight[k] = weight[k - 1] * (1.0 - (order + 1.0) / static_cast<double>(k));
    }
    std::vector<double> out(x.size(), 0.0);
    for (std::size_t n = 0; n < x.size(); ++n) {
        for (std::size_t k = 0; k <= n; ++k) {
            out[n] += weight[k] * x[n - k];
        }
        out[n] *= std::pow(step_s, -order);
    }
    return out;
}

TEST(FractionalBingham, follows_gruenwald_letnikov_from_rest) {
    Noise random(5);
    Samples fine = quiesce::random_motion(0.005, random, 8000);
    fine.step_s = 2.5e-4; // four times as fast: 4 .. 40 Hz
    for (std::vector<double> *values : {&fine.v, &fine.a}) {
        const double times = values == &fine.v ? 4.0 : 16.0;
        for (double &value : *values) {
            value *= times;
        }
    }
    for (const double phi : {0.3, 0.6, 0.9}) {
        const auto damper = constant<FractionalBingham>({0.0, 1.0, phi, 0.0, 1.0});
        const std::vector<double> exact = gruenwald_letnikov(fine.x, fine.step_s, phi);
        // The reference is that of phi / 2 steps earlier, to second order.
        const std::vector<double> now = run(damper, fine, 1);
        std::vector<double> force = now;
        for (std::size_t k = 1; k < force.size(); ++k) {
            force[k] = (1.0 - 0.5 * phi) * now[k] + 0.5 * phi * now[k - 1];
        }
        // It starts with a jump of the velocity, which no band-limited derivative follows.
        std::copy(exact.begin(), exact.begin() + 20, force.begin());
        const double most = *std::max_element(exact.begin(), exact.end());
        EXPECT_LT(largest_difference(force, exact), 0.012 * most) << phi;
    }
}

TEST(FractionalBingham, spans_spring_and_dashpot) {
    const Samples samples = sine(0.01, 3.0, 0.0, 2, 500);
    const auto spring = constant<FractionalBingham>({0.0, 1.0, 0.0, 0.0, 1.0});
    const auto dashpot = constant<FractionalBingham>({0.0, 1.0, 1.0, 0.0, 1.0});
    EXPECT_LT(largest_difference(run(spring, samples, 2), samples.x), 1e-5);
    EXPECT_LT(largest_difference(run(dashpot, samples, 2), samples.v), 2e-4);
    const auto bingham = constant<Bingham>({300.0, 800.0, 20.0, 0.01});
    const auto same = constant<FractionalBingham>({300.0, 800.0, 1.0, 20.0, 0.01});
    EXPECT_LT(largest_difference(run(bingham, samples, 2), run(same, samples, 2)), 0.3);
}

TEST(FractionalBingham, order_and_step_bound) {
    const auto damper = constant<FractionalBingham>({0.0, 1.0, 0.5, 0.0, 1.0});
    EXPECT_NEAR(gain_of_halving(damper, sine(0.01, 20.0, 0.0, 1, 200), 4), 16.0, 3.0);
    const auto most = [&](double step_s) {
        Samples samples = sine(0.01, 1.0 / (200.0 * step_s), 0.0, 5, 200);
        double largest = 0.0;
        for (const double force : run(damper, samples, 1)) {
            largest = std::max(largest, std::abs(force));
        }
        return largest;
    };
    EXPECT_LT(most(2.7 / 4000.0), 1.0);
    EXPECT_GT(most(3.0 / 4000.0), 1e6);
}

TEST(ZhangTanh, is_guos_model_with_an_offset) {
    const auto guo = constant<ExtendedTanhBingham>({700.0, 12.0, 900.0, 15.0});
    const auto zhang = constant<ZhangTanh>({700.0, 12.0, 900.0, 15.0, 33.0});
    for (const double v : {-0.2, 0.0, 0.07}) {
        const double u = v + 15.0 * 0.004;
        EXPECT_NEAR(static_N(guo, 0.004, v), 700.0 * std::tanh(12.0 * u) + 900.0 * u, 1e-6);
        EXPECT_NEAR(static_N(zhang, 0.004, v) - static_N(guo, 0.004, v), 33.0, 1e-9);
    }
    EXPECT_GT(static_N(guo, 0.004, 0.0), 0.0);
    EXPECT_NEAR(zhang.stiffest_N_s_m(0.0), 700.0 * 12.0 + 900.0, 1e-9);
    EXPECT_NEAR(zhang.stiffest_N_m(0.0), (700.0 * 12.0 + 900.0) * 15.0, 1e-9);
}

// k2 2e5 N/m, fc 400 N, c0 1500 N s/m, c1 6000 N s/m, k1 5e4 N/m.
constexpr double kK2 = 2e5;
constexpr double kOffset_N = 600.0;
const std::array<double, 6> kGamota{kK2, 400.0 / kK2, 1500.0 / kK2, 6000.0 / kK2, 0.25, 0.0};

TEST(GamotaFilisko, is_a_linear_solid_before_yield) {
    std::array<double, 6> p = kGamota;
    p[1] = 1.0;
    const auto damper = constant<GamotaFilisko>(p);
    const Samples samples = sine(0.001, 3.0, 0.0, 10);
    const std::vector<double> force = run(damper, samples, substeps_for(damper, samples, 0.1));
    const std::complex<double> solid(5e4, 2.0 * kPi * 3.0 * 6000.0);
    const std::complex<double> exact = 1.0 / (1.0 / kK2 + 1.0 / solid);
    EXPECT_LT(std::abs(stiffness_N_m(force, 0.001, 10) / exact - 1.0), 1e-5);
}

TEST(GamotaFilisko, is_a_bingham_model_on_a_long_way) {
    const auto damper = constant<GamotaFilisko>(kGamota);
    const std::vector<double> force = run(damper, ramp(0.1, 0.2, 2000), 2);
    EXPECT_NEAR(force.back(), 400.0 + 1500.0 * 0.1, 1e-3);
}

TEST(GamotaFilisko, yields_without_its_offset) {
    std::array<double, 6> shifted = kGamota;
    shifted[5] = kOffset_N;
    const Samples samples = sine(0.01, 3.0, 0.0, 1);
    std::vector<double> force = run(constant<GamotaFilisko>(shifted), samples, 4);
    for (double &one : force) {
        one -= kOffset_N;
    }
    EXPECT_LT(largest_difference(force, run(constant<GamotaFilisko>(kGamota), samples, 4)), 1e-9);
}

TEST(GamotaFilisko, is_the_printed_form_in_other_letters) {
    const Samples samples = sine(0.01, 3.0, 0.0, 1, 1000);
    const std::vector<double> force = run(constant<GamotaFilisko>(kGamota), samples, 4);
    constexpr int kFine = 400;
    const double step_s = samples.step_s / kFine;
    double x1 = 0.0;
    double x2 = 0.0;
    for (std::size_t k = 0; k + 1 < force.size(); ++k) {
        for (int part = 0; part < kFine; ++part) {
            const double t = (static_cast<double>(k) + part / double{kFine}) * samples.step_s;
            const double phi = kK2 * (0.01 * std::sin(6.0 * kPi * t) - x2);
            if (part == 0) {
                ASSERT_NEAR(force[k], phi, 0.2) << t;
            }
            const double side = phi > 0.0 ? 1.0 : -1.0;
            const double rate1 = std::abs(phi) > 400.0 ? (phi - 400.0 * side) / 1500.0 : 0.0;
            const double rate2 = rate1 + (phi - 5e4 * (x2 - x1)) / 6000.0;
            x1 += step_s * rate1;
            x2 += step_s * rate2;
        }
    }
}

TEST(GamotaFilisko, order_and_step_bound) {
    std::array<double, 6> p = kGamota;
    p[1] = 1.0; // no yield
    p[2] = 1e3;
    const auto damper = constant<GamotaFilisko>(p);
    const double rate_1_s = damper.fastest_rate_1_s(0.0);
    EXPECT_NEAR(rate_1_s, 1.25 / 0.03, 1e-2);
    EXPECT_NEAR(gain_of_halving(damper, sine(0.001, 3.0, 0.0, 1, 40), 1), 16.0, 4.0);
    const auto end_N = [&](double part) {
        const double freq_Hz = rate_1_s / (40.0 * part);
        return std::abs(run(damper, sine(0.001, freq_Hz, 0.0, 20, 40), 1).back());
    };
    EXPECT_LT(end_N(2.7), 1e3);
    EXPECT_GT(end_N(3.0), 1e9);
}

TEST(NonlinearBiviscous, printed_branches) {
    // c_pre = 800 + 600 / 0.02 = 30800.
    const auto damper = constant<NonlinearBiviscous>({800.0, 600.0, 0.02});
    EXPECT_NEAR(static_N(damper, 0.0, 0.01), 308.0, 1e-9);
    EXPECT_NEAR(static_N(damper, 0.0, 0.02), 616.0, 1e-9);
    EXPECT_NEAR(static_N(damper, 0.0, 0.3), 840.0, 1e-9);
    EXPECT_NEAR(static_N(damper, 0.0, -0.3), -840.0, 1e-9);
    EXPECT_NEAR(damper.stiffest_N_s_m(0.0), 30800.0, 1e-9);
}

/// One printed line: posts c1 v - l1 and c3 v + l2, steep part cpre (v - v0) between its knots.
struct PrintedLine {
    double c1, l1, c3, l2, cpre, v0;
    double low() const { return (cpre * v0 - l1) / (cpre - c1); }
    double high() const { return (cpre * v0 + l2) / (cpre - c3); }
    double force_N(double v) const {
        if (v <= low()) {
            return c1 * v - l1;
        }
        return v >= high() ? c3 * v + l2 : cpre * (v - v0);
    }
};

const PrintedLine kRising{900.0, 350.0, 700.0, 420.0, 9000.0, 0.03};
const PrintedLine kFalling{900.0, 350.0, 700.0, 420.0, 8000.0, -0.02};

std::array<double, 9> zhao(double a_s_m_s2) {
    return {900.0,
            350.0,
            700.0,
            420.0,
            0.5 * (kRising.low() + kRising.high()),
            0.5 * (kRising.high() - kRising.low()),
            0.5 * (kFalling.low() + kFalling.high()),
            0.5 * (kFalling.high() - kFalling.low()),
            a_s_m_s2};
}

TEST(HystereticBiviscous, is_the_printed_form_where_the_sign_is_clear) {
    const auto damper = constant<HystereticBiviscous>(zhao(0.1));
    for (double v = -0.3; v < 0.3; v += 0.013) {
        EXPECT_NEAR(static_N(damper, 0.0, v, 5.0), kRising.force_N(v), 1e-6) << v;
        EXPECT_NEAR(static_N(damper, 0.0, v, -5.0), kFalling.force_N(v), 1e-6) << v;
    }
}

TEST(HystereticBiviscous, is_continuous_within_the_band) {
    const auto damper = constant<HystereticBiviscous>(zhao(0.5));
    const double gap_N = kFalling.force_N(0.0) - kRising.force_N(0.0);
    EXPECT_NEAR(gap_N, 430.0, 1e-9);
    double last_N = static_N(damper, 0.0, 0.0, -3.0);
    for (double a = -3.0; a < 3.0; a += 0.01) {
        const double force_N = static_N(damper, 0.0, 0.0, a);
        EXPECT_LE(std::abs(force_N - last_N), 0.011 * gap_N) << a;
        last_N = force_N;
    }
    EXPECT_NEAR(static_N(damper, 0.0, 0.0, 0.0),
                0.5 * (kRising.force_N(0.0) + kFalling.force_N(0.0)), 1e-9);
}

TEST(HystereticBiviscous, takes_energy_on_a_sine) {
    const auto damper = constant<HystereticBiviscous>(zhao(0.5));
    EXPECT_GT(quiesce::sine_loop(damper, 0.005, 3.0, 0.0).area_J, 0.0);
}

TEST(Arctangent, limits) {
    const auto damper = constant<Arctangent>({800.0, 30.0, 12.0, 100.0, 2000.0, 5.0});
    EXPECT_NEAR(static_N(damper, 0.0, 0.0), 5.0, 1e-12);
    EXPECT_NEAR(static_N(damper, 0.0, 1e6) - 1e8, 805.0, 1e-3);
    const double u = 0.05 + 12.0 * 0.003;
    EXPECT_NEAR(static_N(damper, 0.003, 0.05),
                2.0 / kPi * 800.0 * std::atan(30.0 * u) + 5.0 + 6.0 + 5.0, 1e-6);
    const auto slope = (static_N(damper, 0.0, 1e-6) - 5.0) / 1e-6;
    EXPECT_NEAR(slope, damper.stiffest_N_s_m(0.0), 0.01);
}

TEST(MagicFormula, values_by_hand) {
    const auto damper = constant<MagicFormula>({800.0, 500.0, 1.2, 20.0, 0.4, 10.0, 15.0, 1e-3});
    const auto expected_N = [](double p) {
        const double bent = 0.6 * 20.0 * p + 0.4 * std::atan(20.0 * p);
        return (800.0 + 500.0 * std::abs(p)) * std::sin(1.2 * std::atan(bent));
    };
    EXPECT_NEAR(static_N(damper, 0.002, 0.03, 1.0), expected_N(0.03 + 0.02), 1e-5);
    EXPECT_NEAR(static_N(damper, 0.002, 0.03, -1.0), expected_N(0.03 + 0.03), 1e-5);
    EXPECT_NEAR(static_N(damper, 0.002, 0.03, 0.0), expected_N(0.03 + 0.025), 1e-5);
    EXPECT_NEAR(static_N(damper, 0.0, 1e-7) / 1e-7, 800.0 * 1.2 * 20.0, 1.0);
}

TEST(MagicFormula, gives_out_no_energy_with_equal_shares) {
    Noise random(9);
    const std::array<double, 8> p{800.0, 500.0, 0.9, 20.0, -2.0, 12.0, 12.0, 1.0};
    ASSERT_TRUE(MagicFormula::is_passive(p.data()));
    for (int k = 0; k < 10; ++k) {
        const Samples samples = quiesce::random_motion(0.005, random);
        const std::vector<double> force = run(constant<MagicFormula>(p), samples, 1);
        double energy_J = 0.0;
        for (std::size_t n = 0; n < force.size(); ++n) {
            energy_J += force[n] * samples.v[n] * samples.step_s;
            ASSERT_GT(energy_J, 0.0) << n;
        }
    }
}

TEST(MagicFormula, is_not_passive_where_it_switches) {
    std::array<double, 8> p{800.0, 500.0, 0.9, 20.0, -2.0, 12.0, 11.0, 1.0};
    EXPECT_FALSE(MagicFormula::is_passive(p.data()));
    p = {800.0, 500.0, 1.1, 20.0, -2.0, 12.0, 12.0, 1.0};
    EXPECT_FALSE(MagicFormula::is_passive(p.data()));
}

/// Forces over a random motion and over its mirror image, without an offset.
template <class Kernel>
double asymmetry(std::array<double, Kernel::kParameters.size()> p, std::uint64_t seed) {
    Noise random(seed);
    Samples samples = quiesce::random_motion(0.005, random, 500);
    const auto damper = constant<Kernel>(p, samples.fastest_m_s());
    const int substeps = substeps_for(damper, samples, 2.0);
    const std::vector<double> force = run(damper, samples, substeps);
    for (std::vector<double> *values : {&samples.x, &samples.v, &samples.a}) {
        for (double &value : *values) {
            value = -value;
        }
    }
    std::vector<double> mirrored = run(damper, samples, substeps);
    double scale = 1e-300;
    for (double &value : mirrored) {
        scale = std::max(scale, std::abs(value));
        value = -value;
    }
    return largest_difference(force, mirrored) / scale;
}

TEST(BinghamFamily, is_odd_without_its_offset) {
    EXPECT_LT(asymmetry<Bingham>({500.0, 900.0, 0.0, 0.01}, 1), 1e-12);
    EXPECT_LT(asymmetry<NonlinearBinghamHysteretic>({500.0, 800.0, 900.0, 20.0, 5.0, 0.0}, 2),
              1e-12);
    EXPECT_LT(asymmetry<FractionalBingham>({500.0, 900.0, 0.7, 0.0, 0.05}, 3), 1e-12);
    EXPECT_LT(asymmetry<ExtendedTanhBingham>({500.0, 12.0, 900.0, 14.0}, 4), 1e-12);
    EXPECT_LT(asymmetry<ZhangTanh>({500.0, 12.0, 900.0, 14.0, 0.0}, 5), 1e-12);
    EXPECT_LT(asymmetry<GamotaFilisko>(kGamota, 6), 1e-12);
    EXPECT_LT(asymmetry<NonlinearBiviscous>({900.0, 500.0, 0.02}, 7), 1e-12);
    EXPECT_LT(asymmetry<HystereticBiviscous>(
                  {900.0, 300.0, 900.0, 300.0, 0.02, 0.05, -0.02, 0.05, 0.5}, 8),
              1e-12);
    EXPECT_LT(asymmetry<Arctangent>({500.0, 30.0, 12.0, 100.0, 2000.0, 0.0}, 9), 1e-12);
    EXPECT_LT(asymmetry<MagicFormula>({800.0, 500.0, 1.2, 20.0, 0.4, 12.0, 12.0, 0.5}, 10), 1e-12);
}

} // namespace
