/// A damper whose fluid warms up: its heat balance, what the temperature does to the force, files.
#include "warm_damper.h"

#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <string>
#include <vector>

#include "damper_section.h"
#include "excitation.h"
#include "file_mistakes.h"
#include "plant.h"
#include "plant_file.h"
#include "sine_segment.h"

namespace {

using quiesce::DamperInput;
using quiesce::expect_message;
using quiesce::PlantModel;
using quiesce::read;
using quiesce::spoilt;
using quiesce::TemporaryFile;

const char *const kPlant = "sim_hil/data/plants/suspended_mass.toml";
const char *const kNamed = "file = \"../dampers/rd1005_kwok_tanh_smooth.toml\"\n";
const char *const kBingham = R"(model = "bingham"
stroke_m = 0.05
speed_m_s = 1.0
[damper.parameters]
fc_N = [40.0, 300.0]
c_N_s_m = 800.0
f0_N = 60.0
eps_m_s = 0.005
)";
constexpr int kTickRate_Hz = 1000;
constexpr double kCoil_ohm = 5.0;
constexpr double kCapacity_J_K = 40.0;
constexpr double kConductance_W_K = 2.0;

const std::string kThermal = R"([damper.thermal]
heat_capacity_J_K = 40.0
conductance_W_K = 2.0
ambient_C = 20.0
start_C = 30.0
coil_ohm = 5.0
)";
const std::string kWeakens = "activation_K = 2000.0\nyield_1_K = 2e-3\nreference_C = 20.0\n";

std::string plant_text(const std::string &thermal) {
    return spoilt(read(kPlant), {"damper", kNamed, (kBingham + thermal).c_str(), ""});
}

PlantModel plant_with(const std::string &thermal) {
    const TemporaryFile file(plant_text(thermal));
    return quiesce::load_plant(file.path());
}

/// What went through the damper from the start on, from its true values at every tick.
struct Balance {
    double into_fluid_J = 0.0;
    double to_ambient_J = 0.0;
    double end_C = 0.0;
    double peak_m = 0.0; ///< of the displacement in the last second
};

Balance shaken(const PlantModel &model, double current_A, int seconds) {
    quiesce::Excitation excitation;
    excitation.append(std::make_unique<quiesce::SineSegment>(model.shaker, 1.5), 100.0);
    quiesce::Plant plant(model, excitation, kTickRate_Hz);
    const double dt_s = 1.0 / kTickRate_Hz;
    Balance sum;
    for (int tick = 0; tick < seconds * kTickRate_Hz; ++tick) {
        const quiesce::DamperTruth a = plant.damper(0);
        plant.command(0, current_A, quiesce::ActuatorFault::none);
        plant.advance();
        const quiesce::DamperTruth b = plant.damper(0);
        sum.into_fluid_J += 0.5 * dt_s *
                            (a.force_N * a.velocity_m_s + b.force_N * b.velocity_m_s +
                             kCoil_ohm * (a.coil_A * a.coil_A + b.coil_A * b.coil_A));
        sum.to_ambient_J += dt_s * kConductance_W_K * (0.5 * (*a.fluid_C + *b.fluid_C) - 20.0);
        sum.end_C = *b.fluid_C;
        if (tick >= (seconds - 1) * kTickRate_Hz) {
            sum.peak_m = std::max(sum.peak_m, std::abs(b.stroke_m));
        }
    }
    return sum;
}

TEST(WarmDamper, KeepsWhatTheStructureAndTheCoilGive) {
    for (const std::string &law : {std::string(), kWeakens}) {
        const Balance sum = shaken(plant_with(kThermal + law), 1.0, 20);
        const double kept_J = kCapacity_J_K * (sum.end_C - 30.0);
        EXPECT_GT(sum.into_fluid_J, 100.0);
        EXPECT_NEAR(kept_J, sum.into_fluid_J - sum.to_ambient_J, 2e-3 * sum.into_fluid_J);
    }
}

TEST(WarmDamper, CoolsToTheAmbientWithoutMotion) {
    PlantModel model = plant_with(kThermal);
    model.shaker.drive_V = 0.0;
    // A gas that pushes would move the mass.
    model.dampers[0].stroke.setConstant(1e-9);
    const Balance sum = shaken(model, 0.0, 20);
    EXPECT_NEAR(sum.end_C, 20.0 + 10.0 * std::exp(-20.0 * kConductance_W_K / kCapacity_J_K), 1e-6);
}

TEST(WarmDamper, ChangesNothingWhereTheForceDoesNotFollow) {
    const PlantModel cold = plant_with("");
    const PlantModel warm = plant_with(kThermal);
    quiesce::Excitation excitation;
    excitation.append(std::make_unique<quiesce::SineSegment>(cold.shaker, 1.5), 100.0);
    quiesce::Plant without(cold, excitation, kTickRate_Hz);
    quiesce::Plant with(warm, excitation, kTickRate_Hz);
    for (int tick = 0; tick < 2000; ++tick) {
        for (quiesce::Plant *plant : {&without, &with}) {
            plant->command(0, 1.0, quiesce::ActuatorFault::none);
            plant->advance();
        }
        ASSERT_EQ(without.truth().accel_m_s2, with.truth().accel_m_s2);
    }
    EXPECT_FALSE(without.damper(0).fluid_C.has_value());
    EXPECT_NE(*with.damper(0).fluid_C, 30.0);
}

TEST(WarmDamper, WeakensViscousAndYieldForceButNotTheOffset) {
    const PlantModel model = plant_with(kThermal + kWeakens);
    const quiesce::Damper &damper = *model.dampers[0].damper;
    const auto force = [&damper](double velocity_m_s, double temperature_C) {
        const double state = temperature_C - 30.0;
        double rate = 0.0;
        return damper.force_N({velocity_m_s, 0.0, 1.0}, &state, &rate);
    };
    const double viscous = std::exp(2000.0 * (1.0 / 343.15 - 1.0 / 293.15));
    // Far above eps the friction is fc sgn(v).
    EXPECT_NEAR(force(1.0, 20.0), 60.0 + 800.0 + 340.0, 1.0);
    EXPECT_NEAR(force(1.0, 70.0), 60.0 + viscous * 800.0 + 0.9 * 340.0, 1.0);
    EXPECT_NEAR(force(0.0, 70.0), 60.0, 1e-9);
    // At 1000 C above the reference nothing of the yield force is left, and none beyond.
    EXPECT_NEAR(force(1.0, 1020.0), 60.0, 10.0);
    // The coldest that the fluid can be, the ambient, decides the steps.
    EXPECT_GE(damper.stiffest_N_s_m(0.0), 800.0 + 40.0 / 0.005);
}

TEST(WarmDamper, FilmWeakensLikeItsViscosityAndYieldStress) {
    const auto film = [](const std::string &thermal) {
        const std::string text = read("sim_hil/data/dampers/squeeze_2012_film.toml") + thermal;
        const TemporaryFile file(text);
        return quiesce::load_damper(file.path()).damper;
    };
    const auto plain = film("");
    const auto warm = film("\n[thermal]\nheat_capacity_J_K = 1.0\nconductance_W_K = 0.0\n"
                           "activation_K = 2000.0\nyield_1_K = 2e-3\nstart_C = 75.0\n");
    double state = 0.0;
    double rate = 0.0;
    const DamperInput off{1e-3, 0.0, 0.0};
    const double viscous = std::exp(2000.0 * (1.0 / 348.15 - 1.0 / 298.15));
    EXPECT_NEAR(warm->force_N(off, &state, &rate) / plain->force_N(off, nullptr, nullptr), viscous,
                1e-12);
    const DamperInput on{1e-2, 0.0, 2.0}; // beyond yield: both count
    const double ratio = warm->force_N(on, &state, &rate) / plain->force_N(on, nullptr, nullptr);
    EXPECT_GT(ratio, viscous);
    EXPECT_LT(ratio, 1.0);
    state = -50.0; // at the reference
    EXPECT_EQ(warm->force_N(on, &state, &rate), plain->force_N(on, nullptr, nullptr));
}

TEST(WarmDamper, FilesAreRefusedInOneLine) {
    const auto load = [](const std::string &file) { quiesce::load_plant(file); };
    const std::string table = "[damper.thermal]\nheat_capacity_J_K = ";
    expect_message(plant_text(table + "1.0\n"), "conductance_W_K", load);
    expect_message(plant_text(table + "0.0\nconductance_W_K = 1.0\n"), "heat_capacity_J_K", load);
    expect_message(plant_text(kThermal + "activation_K = -1.0\n"), "activation_K", load);
    expect_message(plant_text(kThermal + "warmth = 1.0\n"), "warmth", load);
    const std::string viscous =
        "model = \"viscous\"\nbase_N_s_m = 5.0\nper_A_N_s_m = 40.0\nstroke_m = 0.1\n" + kThermal;
    expect_message(spoilt(read(kPlant), {"", kNamed, (viscous + kWeakens).c_str(), ""}),
                   "activation_K", load);
    expect_message(spoilt(plant_text(kThermal), {"", "[coil]", "[coil]\nremanence = 0.05", ""}),
                   "coil_ohm", load);
}

} // namespace
