/// Learned damper models: published sets against the reference, values by hand, sampling.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <string>
#include <vector>

#include "anfis.h"
#include "damper_over_motion.h"
#include "damper_section.h"
#include "hysteresis_network.h"
#include "input_error.h"
#include "neuro_fuzzy_stf.h"
#include "periodic_orbit.h"
#include "plant.h"
#include "plant_file.h"
#include "sampled_network.h"
#include "sine_segment.h"
#include "static_network.h"
#include "support_vector.h"
#include "ts_fuzzy.h"
#include "viscous.h"

namespace {

using quiesce::Damper;
using quiesce::DamperInput;
using quiesce::InputBox;
using quiesce::InputKind;
using quiesce::InputRange;
using quiesce::Network;
using quiesce::NetworkLayer;

constexpr double kTwoPi = 6.28318530717958647692;

/// One cycle of 10 Hz and 1.5 mm, the published test.
constexpr int kSteps = 2000;
constexpr double kFreq_Hz = 10.0;
constexpr double kPeak_m = 0.0015;

DamperInput on_cycle(int step, double current_A) {
    const double angle = kTwoPi * step / kSteps;
    return {kTwoPi * kFreq_Hz * kPeak_m * std::cos(angle), kPeak_m * std::sin(angle), current_A};
}

std::vector<double> cycle_N(const Damper &damper, double current_A) {
    std::vector<double> out;
    for (int step = 0; step < kSteps; ++step) {
        out.push_back(damper.force_N(on_cycle(step, current_A), nullptr, nullptr));
    }
    return out;
}

double work_J(const std::vector<double> &force_N) {
    double sum = 0.0;
    for (int step = 0; step < kSteps; ++step) {
        sum += force_N[static_cast<std::size_t>(step)] * on_cycle(step, 0.0).velocity_m_s;
    }
    return sum / (kSteps * kFreq_Hz);
}

double deviation(const std::vector<double> &model, const std::vector<double> &truth) {
    double error = 0.0;
    double size = 0.0;
    for (std::size_t k = 0; k < truth.size(); ++k) {
        error += (model[k] - truth[k]) * (model[k] - truth[k]);
        size += truth[k] * truth[k];
    }
    return std::sqrt(error / size);
}

std::shared_ptr<const Damper> published(const std::string &name) {
    return quiesce::load_damper("sim_hil/data/dampers/rd8040_" + name + ".toml").damper;
}

// Published sets

/// The reference's sanity runs, and the published errors of scenario B in percent.
struct PublishedRow {
    double current_A;
    const char *nine_rules;
    double highest27_N, lowest27_N, work27_J;
    double highest9_N, lowest9_N, work9_J;
    double scenario_b_pct;
};

constexpr PublishedRow kPublished[] = {
    {0.0, "anfis9_0.0A", 247, -236, 1.27, 254, -241, 1.29, 77.10},
    {0.2, "anfis9_0.2A", 677, -614, 3.33, 705, -605, 3.31, 39.36},
    {0.4, "anfis9_0.4A", 926, -835, 4.51, 930, -860, 4.55, 16.67},
    {0.6, "anfis9_0.6A", 1113, -1010, 5.40, 1112, -1021, 5.45, 3.48},
    {0.8, "anfis9_0.8A", 1288, -1174, 6.23, 1291, -1181, 6.26, 16.03},
    {1.0, "anfis9_1.0A", 1332, -1216, 6.44, 1378, -1208, 6.46, 19.32},
};

void expect_loop(const std::vector<double> &force_N, double highest_N, double lowest_N,
                 double loop_J) {
    EXPECT_NEAR(*std::max_element(force_N.begin(), force_N.end()) / highest_N, 1.0, 0.01);
    EXPECT_NEAR(*std::min_element(force_N.begin(), force_N.end()) / lowest_N, 1.0, 0.01);
    EXPECT_NEAR(work_J(force_N) / loop_J, 1.0, 0.01);
}

TEST(LearnedDampers, published_anfis_gives_the_reference_peaks_and_loop_areas) {
    const auto rules27 = published("anfis27");
    for (const PublishedRow &row : kPublished) {
        SCOPED_TRACE(row.current_A);
        expect_loop(cycle_N(*rules27, row.current_A), row.highest27_N, row.lowest27_N,
                    row.work27_J);
        expect_loop(cycle_N(*published(row.nine_rules), row.current_A), row.highest9_N,
                    row.lowest9_N, row.work9_J);
    }
}

TEST(LearnedDampers, nine_rules_at_another_current_err_as_published) {
    const std::vector<double> experiment = cycle_N(*published("anfis27"), 0.6);
    for (const PublishedRow &row : kPublished) {
        const double error = deviation(cycle_N(*published(row.nine_rules), 0.6), experiment);
        EXPECT_NEAR(100.0 * error, row.scenario_b_pct, 1.5) << row.current_A;
    }
}

TEST(LearnedDampers, inputs_are_cut_off_at_the_range_of_the_training) {
    const auto damper = published("anfis27");
    const double corner_N = damper->force_N({0.095, 0.0015, 1.0}, nullptr, nullptr);
    EXPECT_DOUBLE_EQ(damper->force_N({0.2, 0.003, 2.0}, nullptr, nullptr), corner_N);
    EXPECT_LT(std::abs(corner_N), 8000.0);
}

// Fuzzy models

InputBox motion_box() {
    return InputBox({{InputKind::displacement, -0.01, 0.01}, {InputKind::velocity, -0.2, 0.2}});
}

double still_N(const Damper &damper, const DamperInput &input) {
    return damper.force_N(input, nullptr, nullptr);
}

TEST(Anfis, weighted_mean_by_hand) {
    const InputBox box({{InputKind::velocity, -1.0, 1.0}});
    const quiesce::Anfis anfis(box, 0.1, {{{-1.0, 1.0}, {0.5, 1.0}}}, {-10.0, 30.0});
    const double low = std::exp(-0.5 * 1.2 * 1.2 / 0.25);
    const double high = std::exp(-0.5 * 0.8 * 0.8);
    EXPECT_NEAR(still_N(anfis, {0.2, 0.0, 0.0}), (-10.0 * low + 30.0 * high) / (low + high), 1e-12);
}

TEST(Anfis, memberships_too_narrow_to_reach_still_give_the_nearest_rule) {
    const InputBox box({{InputKind::velocity, -1.0, 1.0}});
    const quiesce::Anfis anfis(box, 0.1, {{{-1.0, 1.0}, {1e-3, 1e-3}}}, {-10.0, 30.0});
    EXPECT_DOUBLE_EQ(still_N(anfis, {0.1, 0.0, 0.0}), 30.0);
    EXPECT_DOUBLE_EQ(still_N(anfis, {-0.1, 0.0, 0.0}), -10.0);
}

TEST(TsFuzzy, one_rule_is_linear_and_equal_rules_do_not_matter) {
    const quiesce::FuzzyCluster rule{{0.3, -0.2}, {0.5, 0.5}, {100.0, 40.0}, 7.0};
    const quiesce::TsFuzzy one(motion_box(), 0.1, {rule});
    const quiesce::TsFuzzy two(motion_box(), 0.1, {rule, rule});
    const DamperInput input{0.1, -0.002, 0.0};
    EXPECT_NEAR(still_N(one, input), 100.0 * -0.2 + 40.0 * 0.5 + 7.0, 1e-12);
    EXPECT_NEAR(still_N(two, input), still_N(one, input), 1e-12);
}

quiesce::StfParams stf(bool uses_minimum) {
    const quiesce_triangles motion{{-1.0, -0.5, 0.0, 0.5, 1.0}, {1.0, 1.0, 1.0, 1.0, 1.0}};
    const quiesce_triangles current{{0.0, 0.25, 0.5, 0.75, 1.0}, {0.5, 0.5, 0.5, 0.5, 0.5}};
    return {2000.0,
            0.005,
            0.1,
            1.5,
            uses_minimum ? 1 : 0,
            motion,
            motion,
            current,
            {-1.0, -0.7, 0.0, 0.7, 1.0},
            {0.1, 0.3, 0.5, 0.7, 0.9},
            {0, 0, 1, 2, 4, 0, 1, 1, 3, 4, 0, 1, 2, 3, 4, 0, 1, 3, 3, 4, 0, 2, 3, 4, 4}};
}

TEST(NeuroFuzzyStf, nodes_and_a_point_between_them_by_hand) {
    const quiesce::NeuroFuzzyStf product(stf(false), 0.02);
    EXPECT_NEAR(still_N(product, {0.1, 0.0, 1.5}), 2000.0 * 0.9 * 1.0, 1e-9);
    EXPECT_NEAR(still_N(product, {0.05, 0.0, 0.0}), 2000.0 * 0.1 * 0.7, 1e-9);
    // x at 0.25, v at 0.1 of their scales: grades 0.5/0.5 and 0.8/0.2.
    const double product_u = 0.5 * (0.8 * 0.0 + 0.2 * 0.7) + 0.5 * (0.8 * 0.7 + 0.2 * 0.7);
    const DamperInput between{0.01, 0.00125, 0.75};
    EXPECT_NEAR(still_N(product, between), 2000.0 * 0.5 * product_u, 1e-9);
    const double minimum_u = (0.5 * 0.0 + 0.2 * 0.7 + 0.5 * 0.7 + 0.2 * 0.7) / 1.4;
    const quiesce::NeuroFuzzyStf minimum(stf(true), 0.02);
    EXPECT_NEAR(still_N(minimum, between), 2000.0 * 0.5 * minimum_u, 1e-9);
}

TEST(NeuroFuzzyStf, no_membership_gives_no_force_and_no_nan) {
    quiesce::StfParams p = stf(false);
    std::fill_n(p.disp.bases, quiesce_stf_labels, 1e-3);
    EXPECT_DOUBLE_EQ(still_N(quiesce::NeuroFuzzyStf(p, 0.02), {0.05, 0.00123, 1.0}), 0.0);
}

// Networks and support vectors

NetworkLayer layer(std::size_t inputs, std::vector<double> weights, std::vector<double> biases) {
    return {inputs, biases.size(), std::move(weights), std::move(biases)};
}

TEST(StaticNetwork, by_hand) {
    const Network network(
        {layer(2, {1.0, -2.0, 0.5, 0.25}, {0.1, -0.3}), layer(2, {2.0, 3.0}, {0.05})});
    const quiesce::StaticNetwork damper(motion_box(), 0.1, network, 500.0);
    const double x = 0.4;
    const double v = -0.5;
    const double expected =
        2.0 * std::tanh(x - 2.0 * v + 0.1) + 3.0 * std::tanh(0.5 * x + 0.25 * v - 0.3) + 0.05;
    EXPECT_NEAR(still_N(damper, {-0.1, 0.004, 0.0}), 500.0 * expected, 1e-9);
}

TEST(StaticNetwork, slopes_bound_those_inside_the_range) {
    const Network network({layer(2, {0.0, 5.0}, {0.0}), layer(1, {1.0}, {0.0})});
    const quiesce::StaticNetwork damper(motion_box(), 0.1, network, 500.0);
    EXPECT_NEAR(damper.stiffest_N_s_m(0.0) / (500.0 * 5.0 / 0.2), 1.0, 0.03);
    EXPECT_DOUBLE_EQ(damper.stiffest_N_m(0.0), 0.0);
}

TEST(SupportVector, by_hand) {
    const quiesce::SupportVector damper(motion_box(), 0.1,
                                        {500.0, 2.0, 0.1, {0.5, -1.0}, {0.4, -0.5, 0.0, 0.5}});
    const double far2 = 0.4 * 0.4 + 1.0;
    EXPECT_NEAR(still_N(damper, {-0.1, 0.004, 0.0}), 500.0 * (0.1 + 0.5 - std::exp(-2.0 * far2)),
                1e-9);
}

// Networks that sample

/// A motion of 101 samples at 1 kHz: 20 Hz, 3 mm.
struct SampledMotion {
    std::vector<double> disp_m, velocity_m_s, accel_m_s2, current_A;

    SampledMotion() {
        const double omega = kTwoPi * 20.0;
        for (int k = 0; k <= 100; ++k) {
            const double angle = omega * 0.001 * k;
            disp_m.push_back(0.003 * std::sin(angle));
            velocity_m_s.push_back(0.003 * omega * std::cos(angle));
            accel_m_s2.push_back(-0.003 * omega * omega * std::sin(angle));
            current_A.push_back(0.0);
        }
    }

    std::vector<double> force_N(const Damper &damper, int substeps) const {
        const quiesce::MotionGrid grid({disp_m.size(), 0.001, disp_m.data(), velocity_m_s.data(),
                                        accel_m_s2.data(), current_A.data()},
                                       substeps);
        std::vector<double> out(disp_m.size());
        quiesce::damper_over_motion(damper, grid, out.data());
        return out;
    }
};

InputBox velocity_box() {
    return InputBox({{InputKind::velocity, -1.0, 1.0}});
}

TEST(SampledNetwork, a_lag_is_that_many_samples_at_any_step) {
    const quiesce::SampledNetwork damper(velocity_box(), {0.1, 0.001, 100.0, {3}, {}},
                                         Network({layer(1, {1.0}, {0.0})}));
    const SampledMotion motion;
    for (const int substeps : {1, 4}) {
        const std::vector<double> force_N = motion.force_N(damper, substeps);
        for (std::size_t k = 10; k < force_N.size(); ++k) {
            EXPECT_NEAR(force_N[k], 100.0 * motion.velocity_m_s[k - 3], 1e-9) << k;
        }
    }
}

TEST(SampledNetwork, its_force_is_fed_back_and_held_between_samples) {
    // F[k] = 0.9 F[k-1] + 10 v[k], sampled every second millisecond.
    const quiesce::SampledNetwork damper(velocity_box(), {0.1, 0.002, 100.0, {0}, {1}},
                                         Network({layer(2, {0.1, 0.9}, {0.0})}));
    const SampledMotion motion;
    const std::vector<double> force_N = motion.force_N(damper, 2);
    double expected_N = force_N[2];
    for (std::size_t k = 4; k < force_N.size(); k += 2) {
        expected_N = 0.9 * expected_N + 10.0 * motion.velocity_m_s[k];
        EXPECT_NEAR(force_N[k], expected_N, 1e-9) << k;
        EXPECT_DOUBLE_EQ(force_N[k - 1], force_N[k - 2]) << k;
    }
}

using QuadratureFeatures = std::array<double, quiesce_quadrature_features>;

QuadratureFeatures quadrature_features(const quiesce_quadrature &params, double position_m,
                                       double velocity_m_s, const double *means) {
    QuadratureFeatures out{};
    quiesce_quadrature_write(&params, position_m, velocity_m_s, means, out.data());
    return out;
}

TEST(Quadrature, tells_envelope_frequency_and_phase_of_a_sine) {
    const quiesce_quadrature params{0.2, 0.004, 20.0, 500.0};
    const SampledMotion motion;
    const double omega = kTwoPi * 20.0;
    double means[quiesce_quadrature_states] = {};
    for (std::size_t k = 0; k < motion.disp_m.size(); ++k) {
        quiesce_quadrature_update(&params, motion.disp_m[k], motion.velocity_m_s[k], 0.001, means);
        if (k % 50 == 0 && k > 0) { // whole cycles: the means' ratio is that of a sine
            const QuadratureFeatures found =
                quadrature_features(params, motion.disp_m[k], motion.velocity_m_s[k], means);
            EXPECT_NEAR(found[0], 2.0 * 0.003 / 0.004 - 1.0, 0.1);
            EXPECT_NEAR(found[1], 2.0 * (omega - 20.0) / 480.0 - 1.0, 0.1);
            EXPECT_NEAR(found[2] * found[2] + found[3] * found[3], 1.0, 1e-12);
            EXPECT_NEAR(found[3], -1.0, 0.01); // v > 0 in mid-stroke
        }
    }
}

TEST(Quadrature, rest_has_no_phase_and_extremes_are_cut_off) {
    const quiesce_quadrature params{0.2, 0.004, 20.0, 500.0};
    double means[quiesce_quadrature_states] = {};
    for (const double feature : quadrature_features(params, 0.0, 0.0, means)) {
        EXPECT_EQ(feature, 0.0);
    }
    quiesce_quadrature_update(&params, 0.0, 1e6, 0.001, means);
    const QuadratureFeatures fast = quadrature_features(params, 0.0, 1e6, means);
    EXPECT_DOUBLE_EQ(fast[0], 1.0);
    EXPECT_DOUBLE_EQ(fast[1], 1.0);
    means[1] = 0.0;
    EXPECT_DOUBLE_EQ(quadrature_features(params, 0.1, 0.0, means)[1], -1.0);
}

quiesce::PlantModel plant_with(std::shared_ptr<const Damper> damper) {
    quiesce::PlantModel model = quiesce::load_plant("sim_hil/data/plants/squeeze_2012.toml");
    model.dampers[0].damper = std::move(damper);
    return model;
}

double largest_m(const quiesce::PlantModel &model) {
    quiesce::Excitation excitation;
    excitation.append(std::make_unique<quiesce::SineSegment>(model.shaker, 11.5), 10.0);
    quiesce::Plant plant(model, excitation, 1000);
    double most_m = 0.0;
    for (int tick = 0; tick < 3000; ++tick) {
        plant.advance();
        most_m = std::max(most_m, tick < 2000 ? 0.0 : std::abs(plant.truth().displacement_m));
    }
    return most_m;
}

TEST(SampledNetwork, in_a_plant_it_does_what_the_model_it_copies_does) {
    const double viscous_N_s_m = 0.5;
    const auto copy = std::make_shared<quiesce::SampledNetwork>(
        velocity_box(), quiesce::SampledNetworkParams{1.0, 0.0005, viscous_N_s_m, {0}, {}},
        Network({layer(1, {1.0}, {0.0})}));
    const auto truth =
        std::make_shared<quiesce::Viscous>(quiesce::ViscousParams{viscous_N_s_m, 0.0, 1.0});
    const auto none = std::make_shared<quiesce::Viscous>(quiesce::ViscousParams{0.0, 0.0, 1.0});
    const double expected_m = largest_m(plant_with(truth));
    EXPECT_LT(expected_m, 0.9 * largest_m(plant_with(none)));
    EXPECT_NEAR(largest_m(plant_with(copy)) / expected_m, 1.0, 0.02);
}

TEST(SampledNetwork, has_no_periodic_orbit) {
    const auto damper = std::make_shared<quiesce::SampledNetwork>(
        velocity_box(), quiesce::SampledNetworkParams{1.0, 0.001, 1.0, {0}, {}},
        Network({layer(1, {1.0}, {0.0})}));
    try {
        const quiesce::PeriodicOrbit orbit(plant_with(damper), {10.0, 1.0, 16, true});
        FAIL() << "accepted";
    } catch (const quiesce::InputError &error) {
        EXPECT_NE(std::string(error.what()).find("sample time of its own"), std::string::npos);
    }
}

// Networks over hysteresis elements

/// Passes one feature on as the force; features x, v, coil, elastic, chain, stop.
quiesce::HysteresisNetworkParams elements(std::size_t feature) {
    quiesce::HysteresisNetworkParams p{};
    p.stroke_m = 0.1;
    p.speed_m_s = 1.0;
    p.force_scale_N = 1.0;
    p.current_scale_A = 1.0;
    p.field_exponent = 1.0;
    p.saturation = 1e12;
    p.coil_times_s = {0.01};
    p.coil_fall_times_s = {0.02};
    p.elastic_times_s = {0.005};
    p.chain_times_s = {0.004};
    p.stop_reaches_m = {0.001};
    p.means.assign(6, 0.0);
    p.scales.assign(6, 1.0);
    p.clip = 1e3;
    p.skip.assign(6, 0.0);
    p.skip[feature] = 1.0;
    return p;
}

Network silent(std::size_t features, std::size_t heads) {
    return Network({layer(features, std::vector<double>(features, 0.0), {0.0}),
                    layer(1, std::vector<double>(heads, 0.0), std::vector<double>(heads, 0.0))});
}

/// Constant velocity of 50 mm/s and a constant current, 101 samples at 1 kHz; the last value.
double last_of_ramp(const Damper &damper, double current_A) {
    SampledMotion motion;
    for (std::size_t k = 0; k < motion.disp_m.size(); ++k) {
        motion.disp_m[k] = 5e-5 * static_cast<double>(k);
        motion.velocity_m_s[k] = 0.05;
        motion.accel_m_s2[k] = 0.0;
        motion.current_A[k] = current_A;
    }
    return motion.force_N(damper, 10).back();
}

TEST(HysteresisNetwork, each_element_follows_its_equation) {
    const auto last = [](std::size_t feature, double current_A) {
        return last_of_ramp(quiesce::HysteresisNetwork(elements(feature), {silent(6, 1)}),
                            current_A);
    };
    EXPECT_NEAR(last(0, 0.0), 0.005, 1e-9);
    EXPECT_NEAR(last(1, 0.0), 0.05, 1e-9);
    EXPECT_NEAR(last(2, 2.0), 2.0 * (1.0 - std::exp(-0.1 / 0.01)), 1e-6);
    EXPECT_NEAR(last(2, -2.0), -2.0 * (1.0 - std::exp(-0.1 / 0.02)), 1e-6);
    EXPECT_NEAR(last(3, 0.0), 0.05 * 0.005 * (1.0 - std::exp(-0.1 / 0.005)), 1e-9);
    EXPECT_NEAR(last(4, 0.0), 0.05 * (1.0 - std::exp(-0.1 / 0.004)), 1e-9);
    EXPECT_NEAR(last(5, 0.0), 1.0 - std::exp(-0.005 / 0.001), 1e-6);
}

TEST(HysteresisNetwork, stands_on_its_base_which_sees_the_lagged_current) {
    quiesce::HysteresisNetworkParams p = elements(0);
    p.means.assign(7, 0.0);
    p.scales.assign(7, 1.0);
    p.skip.assign(7, 0.0);
    p.base = std::make_shared<quiesce::Viscous>(quiesce::ViscousParams{100.0, 50.0, 1.0});
    p.coil_times_s = {0.1};
    const quiesce::HysteresisNetwork damper(p, {silent(7, 1)});
    const double seen_A = 2.0 * (1.0 - std::exp(-1.0));
    EXPECT_NEAR(last_of_ramp(damper, 2.0), (100.0 + 50.0 * seen_A) * 0.05, 1e-5);
}

TEST(HysteresisNetwork, heads_are_weighed_by_powers_of_the_field) {
    quiesce::HysteresisNetworkParams p = elements(0);
    p.coil_times_s.clear();
    p.coil_fall_times_s.clear();
    p.means.assign(5, 0.0);
    p.scales.assign(5, 1.0);
    p.field_exponent = 1.5;
    p.saturation = 2.0;
    p.skip = {0, 1, 0, 0, 0, 0, 10, 0, 0, 0};
    const quiesce::HysteresisNetwork damper(p, {silent(5, 2)});
    const double toe = std::pow(0.25, 1.5);
    const double field = toe * 3.0 / (2.0 + toe);
    EXPECT_NEAR(last_of_ramp(damper, 0.25), 0.05 * (1.0 + 10.0 * field), 1e-9);
}

TEST(HysteresisNetwork, bounds_of_rate_and_slope_hold) {
    quiesce::HysteresisNetworkParams p = elements(5);
    p.force_scale_N = 300.0;
    const quiesce::HysteresisNetwork damper(p, {silent(6, 1)});
    EXPECT_DOUBLE_EQ(damper.fastest_rate_1_s(0.0), 1.0 / 0.001);
    // The stop pushes 300 N over 1 mm.
    EXPECT_NEAR(damper.stiffest_N_m(0.0) / 3e5, 1.0, 0.06);
}

} // namespace
