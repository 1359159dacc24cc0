/// The magnetorheological elastomer: its figures, its limits, its file.
#include <gtest/gtest.h>

#include <cmath>

#include "damper_section.h"
#include "elastomer.h"
#include "file_mistakes.h"
#include "plant_file.h"

namespace {

using quiesce::DamperInput;
using quiesce::Elastomer;
using quiesce::Mistake;
using quiesce::read;
using quiesce::spoilt;

const char *const kFile = "sim_hil/data/dampers/mre_2014.toml";

const Elastomer kMount({9.36e-4, 0.003, {1.080, 0.7649, -0.1391}, 0.2, 48.0, 0.0005});

TEST(Elastomer, stiffness_is_modulus_times_area_over_thickness) {
    EXPECT_NEAR(kMount.stiffest_N_m(0.0), 3.37e5, 0.005e5);
    EXPECT_NEAR(kMount.stiffest_N_m(1.0), 5.32e5, 0.005e5);
    EXPECT_NEAR(kMount.stiffest_N_m(1.5), 5.97e5, 0.005e5);
    EXPECT_NEAR(kMount.stiffest_N_m(1.78), 6.24e5, 0.01e5);
    EXPECT_NEAR(kMount.stiffest_N_m(2.0), 6.41e5, 0.01e5);
}

TEST(Elastomer, it_does_not_soften_beyond_its_highest_modulus) {
    const double highest_A = 0.7649 / (2.0 * 0.1391);
    EXPECT_GT(kMount.stiffest_N_m(highest_A), kMount.stiffest_N_m(highest_A - 0.3));
    EXPECT_EQ(kMount.stiffest_N_m(highest_A + 1.0), kMount.stiffest_N_m(highest_A));
}

TEST(Elastomer, a_cycle_at_its_frequency_loses_what_the_loss_factor_says) {
    // Of a sine with amplitude X the cycle's work is pi eta k X^2.
    constexpr double kTwoPi = 6.28318530717958647692;
    constexpr int kSteps = 2000;
    constexpr double kAmplitude_m = 1e-4;
    double work_J = 0.0;
    for (int i = 0; i < kSteps; ++i) {
        const double angle = kTwoPi * i / kSteps;
        DamperInput input{};
        input.current_A = 1.0;
        input.position_m = kAmplitude_m * std::sin(angle);
        input.velocity_m_s = kAmplitude_m * kTwoPi * 48.0 * std::cos(angle);
        work_J += kMount.force_N(input, nullptr, nullptr) * input.velocity_m_s / (48.0 * kSteps);
    }
    const double expected_J =
        0.5 * kTwoPi * 0.2 * kMount.stiffest_N_m(1.0) * kAmplitude_m * kAmplitude_m;
    EXPECT_NEAR(work_J, expected_J, 1e-9 * expected_J);
}

/// Work taken in over a slow cycle, where the loss factor is hardly anything, under current_A(x,
/// v).
template <typename Current>
double work_taken_J(Current current_A) {
    constexpr double kTwoPi = 6.28318530717958647692;
    constexpr int kSteps = 20000;
    constexpr double kAmplitude_m = 1e-4;
    constexpr double kFreq_Hz = 0.01;
    double work_J = 0.0;
    for (int i = 0; i < kSteps; ++i) {
        const double angle = kTwoPi * (i + 0.5) / kSteps;
        DamperInput input{};
        input.position_m = kAmplitude_m * std::sin(angle);
        input.velocity_m_s = kAmplitude_m * kTwoPi * kFreq_Hz * std::cos(angle);
        input.current_A = current_A(input.position_m, input.velocity_m_s);
        work_J +=
            kMount.force_N(input, nullptr, nullptr) * input.velocity_m_s / (kFreq_Hz * kSteps);
    }
    return work_J;
}

// Stiff on the way out and soft on the way back it takes energy, the other way round it gives it:
// of both the difference of the energies that are stored at the turn, twice a cycle.
TEST(Elastomer, a_current_that_changes_while_it_is_deflected_does_work) {
    const double stored_J = (kMount.stiffest_N_m(1.78) - kMount.stiffest_N_m(0.0)) * 1e-4 * 1e-4;
    const auto out = [](double x, double v) { return x * v > 0.0 ? 1.78 : 0.0; };
    const auto back = [](double x, double v) { return x * v > 0.0 ? 0.0 : 1.78; };
    EXPECT_NEAR(work_taken_J(out), stored_J, 0.002 * stored_J);
    EXPECT_NEAR(work_taken_J(back), -stored_J, 0.002 * stored_J);
    EXPECT_NEAR(work_taken_J([](double, double) { return 1.78; }), 0.0, 0.002 * stored_J);
}

TEST(ElastomerFile, a_plant_may_have_it) {
    const quiesce::PlantModel model =
        quiesce::load_plant("sim_hil/data/plants/elastomer_mount.toml");
    EXPECT_EQ(model.dampers[0].damper->stiffest_N_m(1.0), kMount.stiffest_N_m(1.0));
    EXPECT_EQ(model.dampers[0].coil.rise_s, 0.002);
}

// Corrected matrices: with the elastomer's k between the masses, all of it is symmetric.
TEST(ElastomerFile, two_masses_have_it_between_them) {
    const quiesce::PlantModel model = quiesce::load_plant("sim_hil/data/plants/mrd_mre_2014.toml");
    ASSERT_EQ(model.dampers.size(), 2u);
    EXPECT_EQ(model.dampers[1].damper->stiffest_N_m(1.0), kMount.stiffest_N_m(1.0));
    EXPECT_EQ(model.dampers[1].coil.rise_s, 0.002);
    EXPECT_EQ(model.dampers[0].coil.rise_s, 0.010);
}

TEST(ElastomerFile, every_mistake_is_named_in_one_line) {
    const Mistake mistakes[] = {
        {"area", "area_m2 = 9.36e-4", "area_m2 = 0", "area_m2: expected"},
        {"thickness", "thickness_m = 0.003", "", "thickness_m: missing"},
        {"two_numbers", "[1.080, 0.7649, -0.1391]", "[1.080, 0.7649]", "storage_MPa: expected"},
        {"no_modulus", "[1.080, 0.7649, -0.1391]", "[0.0, 0.7649, -0.1391]",
         "storage_MPa: expected a modulus above 0"},
        {"softens", "[1.080, 0.7649, -0.1391]", "[1.0, -0.7649, 0.1]",
         "storage_MPa: expected a modulus above 0"},
        {"loss", "loss_factor = 0.2", "loss_factor = -0.2", "loss_factor: expected"},
        {"freq", "loss_freq_Hz = 48.0", "loss_freq_Hz = 0", "loss_freq_Hz: expected"},
        {"unknown", "loss_freq_Hz = 48.0", "loss_freq_Hz = 48.0\nk = 1", "k: unknown key"},
        {"model", "\"elastomer\"", "\"rubber\"", "model: expected one of"},
    };
    for (const Mistake &mistake : mistakes) {
        SCOPED_TRACE(mistake.name);
        quiesce::expect_message(spoilt(read(kFile), mistake), mistake.words, quiesce::load_damper);
    }
}

} // namespace
