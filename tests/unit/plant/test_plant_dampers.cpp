/// Plants whose damper is a model of the library: from a file, in the plant file, with states.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "damper_section.h"
#include "excitation.h"
#include "file_mistakes.h"
#include "input_error.h"
#include "periodic_orbit.h"
#include "plant.h"
#include "plant_file.h"
#include "sine_segment.h"

namespace {

using quiesce::expect_message;
using quiesce::InputError;
using quiesce::Mistake;
using quiesce::PlantModel;
using quiesce::read;
using quiesce::spoilt;
using quiesce::TemporaryFile;

const char *const kPlant = "sim_hil/data/plants/suspended_mass.toml";
const char *const kNamed = "file = \"../dampers/rd1005_kwok_tanh_smooth.toml\"\n";
const char *const kBoucWen = R"(model = "normalised_bouc_wen"
stroke_m = 0.025
speed_m_s = 0.2
[damper.parameters]
c_N_s_m = [500.0, 300.0]
k_N_m = 0.0
kw_N = [60.0, 200.0]
rho_1_m = 2000.0
sigma = 0.6
n = 1.5
f0_N = 0.0
)";
constexpr int kTickRate_Hz = 1000;

/// The shipped plant with another text for its damper.
std::string with_damper(const std::string &keys) {
    return spoilt(read(kPlant), {"damper", kNamed, keys.c_str(), ""});
}

/// With the damper in this file.
std::string with_file(const std::string &file) {
    return with_damper("file = \"" + std::filesystem::absolute(file).string() + "\"\n");
}

PlantModel loaded(const std::string &text) {
    const TemporaryFile file(text);
    return quiesce::load_plant(file.path());
}

/// Of the last periods.
struct Steady {
    double lowest_m = 1e9;
    double highest_m = -1e9;
    double taken_J = 0.0; ///< by the damper
    double amplitude_m() const { return 0.5 * (highest_m - lowest_m); }
};

/// A sine for 8 s with a constant command; what happens in the last 2 s, a whole number of periods.
Steady shaken(const PlantModel &model, double freq_Hz, double current_A) {
    quiesce::Excitation excitation;
    excitation.append(std::make_unique<quiesce::SineSegment>(model.shaker, freq_Hz), 100.0);
    quiesce::Plant plant(model, excitation, kTickRate_Hz);
    Steady steady;
    for (int tick = 0; tick < 8 * kTickRate_Hz; ++tick) {
        plant.command(0, current_A, quiesce::ActuatorFault::none);
        for (const quiesce::PlantTruth &now : plant.advance()) {
            if (tick >= 6 * kTickRate_Hz) {
                steady.lowest_m = std::min(steady.lowest_m, now.displacement_m);
                steady.highest_m = std::max(steady.highest_m, now.displacement_m);
                steady.taken_J += now.damper_force_N * now.damper_velocity_m_s * plant.step_s();
            }
        }
    }
    return steady;
}

TEST(PlantDamper, current_reduces_the_motion_and_the_damper_takes_energy) {
    const PlantModel model = quiesce::load_plant(kPlant);
    double before_m = 1.0;
    for (const double current_A : {0.0, 0.1, 0.2, 0.4, 0.8, 1.88}) {
        SCOPED_TRACE(current_A);
        const Steady steady = shaken(model, 1.5, current_A);
        EXPECT_LT(steady.amplitude_m(), before_m);
        EXPECT_GT(steady.taken_J, 0.0);
        before_m = steady.amplitude_m();
    }
    EXPECT_LT(before_m, 1e-4) << "held";
}

TEST(PlantDamper, without_current_the_motion_is_that_of_the_linear_part) {
    const PlantModel model = loaded(with_damper(
        "model = \"modified_dahl\"\nstroke_m = 1.0\nspeed_m_s = 1.0\n[damper.parameters]\n"
        "k_N_m = 5000.0\nc0_N_s_m = 2000.0\nfd_N = 0.0\nsigma_1_m = 1000.0\nf0_N = 0.0\n"));
    const double w = 2.0 * 3.14159265358979323846 * 1.5;
    const double damping_N_s_m = 2.0 * 0.02 * 500.0 * w + 2000.0;
    const double stiffness_N_m = 5000.0; // the springs' own is balanced by the mass at 1.5 Hz
    const double expected_m = 300.0 / std::hypot(stiffness_N_m, damping_N_s_m * w);
    EXPECT_NEAR(shaken(model, 1.5, 0.0).amplitude_m() / expected_m, 1.0, 1e-3);
}

/// Within half a second from x = 0.
double farthest_m(const PlantModel &model, double freq_Hz, double current_A) {
    quiesce::Excitation excitation;
    excitation.append(std::make_unique<quiesce::SineSegment>(model.shaker, freq_Hz), 100.0);
    quiesce::Plant plant(model, excitation, kTickRate_Hz);
    double most_m = 0.0;
    while (plant.tick() < kTickRate_Hz / 2) {
        plant.command(0, current_A, quiesce::ActuatorFault::none);
        plant.advance(); // throws where the motion is not finite
        most_m = std::max(most_m, std::abs(plant.truth().displacement_m));
    }
    return most_m;
}

TEST(PlantDamper, every_usable_published_set_runs_in_a_plant) {
    int count = 0;
    for (const auto &entry : std::filesystem::directory_iterator("sim_hil/data/dampers")) {
        const std::string file = entry.path().string();
        if (entry.path().extension() != ".toml" ||
            read(file).find("usable = false") != std::string::npos) {
            continue;
        }
        SCOPED_TRACE(file);
        PlantModel model = quiesce::load_plant(kPlant);
        model.dampers[0].damper = quiesce::load_damper(file).damper;
        model.shaker.drive_V = 1.0;
        model.max_step_s = std::min(5e-4, quiesce::longest_safe_step_s(model));
        const double most_m = farthest_m(model, 3.0, 0.4);
        EXPECT_GT(most_m, 0.0);
        EXPECT_LT(most_m, 5e-3);
        ++count;
    }
    EXPECT_GE(count, 20);
}

TEST(PlantDamper, takes_the_coil_of_its_file_unless_it_has_one) {
    const std::string file = "sim_hil/data/dampers/spencer_prototype.toml";
    const std::string coil = "[coil]\nrise_s = 0.010\nfall_s = 0.010\n";
    const std::string volts = file + "\"\ncommand_unit = \"V";
    const std::string with_both = with_file(volts) + "\n[integration]\nmax_step_us = 30\n";
    EXPECT_EQ(loaded(with_both).dampers[0].coil.rise_s, 0.010);
    EXPECT_EQ(loaded(spoilt(with_both, {"coil", coil.c_str(), "", ""})).dampers[0].coil.rise_s,
              5.263e-3);
    const std::string without = with_file("sim_hil/data/dampers/rd1005_kwok_tanh.toml");
    expect_message(spoilt(without, {"coil", coil.c_str(), "", ""}), "coil: missing",
                   quiesce::load_plant);
}

TEST(PlantDamper, is_asked_about_volts_currents_and_use) {
    const std::string volts = "sim_hil/data/dampers/spencer_prototype.toml";
    expect_message(with_file(volts), "its command is a voltage", quiesce::load_plant);
    const std::string kwok = "sim_hil/data/dampers/rd1005_kwok_tanh_smooth.toml";
    expect_message(with_file(kwok + "\"\ncommand_unit = \"V"), "a current, not a voltage",
                   quiesce::load_plant);
    expect_message(with_file("sim_hil/data/dampers/rd8040_modified_bouc_wen_0.6A.toml"),
                   "not usable", quiesce::load_plant);
    expect_message(
        spoilt(with_file(kwok), {"driver", "max_current_A = 1.88", "max_current_A = 5.0", ""}),
        "is beyond the 1.88", quiesce::load_plant);
}

class DamperMistakes : public testing::TestWithParam<Mistake> {};

TEST_P(DamperMistakes, are_named) {
    expect_message(spoilt(read(kPlant), GetParam()), GetParam().words, quiesce::load_plant);
}

const Mistake kMistakes[] = {
    {"file_is_no_text", "file = \"../dampers/rd1005_kwok_tanh_smooth.toml\"", "file = 3",
     "damper.file: expected a text"},
    {"no_model", kNamed, "", "damper.model: missing"},
    {"no_parameters", kNamed, "model = \"modified_dahl\"\nstroke_m = 1.0\nspeed_m_s = 1.0\n",
     "damper.parameters: missing"},
    {"no_speed", kNamed, "model = \"modified_dahl\"\nstroke_m = 1.0\n",
     "damper.speed_m_s: missing"},
};
INSTANTIATE_TEST_SUITE_P(PlantFile, DamperMistakes, testing::ValuesIn(kMistakes),
                         [](const auto &test) { return std::string(test.param.name); });

/// One line: the plant's section, then this file's name and what is wrong in it.
void expect_named(const std::string &plant, const std::string &file, const std::string &words) {
    try {
        loaded(plant);
        FAIL() << "accepted; expected a message with: " << words;
    } catch (const InputError &error) {
        const std::string message = error.what();
        const std::size_t named = message.find(std::filesystem::path(file).filename().string());
        EXPECT_NE(named, std::string::npos) << message;
        EXPECT_LT(message.find("damper.file: "), named) << message;
        EXPECT_NE(message.find(words), std::string::npos) << message;
        EXPECT_EQ(message.find('\n'), std::string::npos) << "one line: " << message;
    }
}

TEST(PlantDamper, a_damper_file_that_is_missing_or_wrong_is_named) {
    expect_named(with_file("sim_hil/data/dampers/none.toml"), "none.toml", "");
    expect_named(with_file(kPlant), kPlant, "schema: expected one of: quiesce-damper");
    const std::string good = read("sim_hil/data/dampers/rd1005_kwok_tanh.toml");
    const Mistake mistakes[] = {
        {"text", "[parameters]", "[parameters", "expected"},
        {"missing", "beta_s_m = 100.0\n", "", "parameters.beta_s_m: missing"},
        {"unit", "beta_s_m = 100.0", "beta_s_m = -100.0", "parameters.beta_s_m: expected a number"},
        {"nan", "x_s_m = 0.0", "x_s_m = nan", "parameters.x_s_m: expected a number"},
        {"key", "name =", "colour = 1\nname =", "colour: unknown key"},
    };
    for (const Mistake &mistake : mistakes) {
        const TemporaryFile damper(spoilt(good, mistake), "_damper.toml");
        expect_named(with_file(damper.path()), damper.path(), mistake.words);
    }
}

TEST(PlantDamper, is_a_file_or_a_model_not_both) {
    const std::string file = std::filesystem::absolute("sim_hil/data/dampers/rd1005_bingham.toml");
    expect_message(with_damper("file = \"" + file + "\"\nmodel = \"viscous\"\n"),
                   "damper.model: unknown key", quiesce::load_plant);
}

TEST(PlantDamper, with_hysteresis_too_long_a_step_is_refused_with_the_one_to_set) {
    // 5 um of pre-yield travel at 0.2 m/s: 2 / (1.5 x 0.2 m/s / 5 um) is 33 us.
    const std::string stiff = spoilt(with_damper(kBoucWen), {"", "2000.0", "200000.0", ""});
    expect_message(stiff,
                   "500 us is too long for this plant's fastest motion; set "
                   "integration.max_step_us to 33.3333 or less",
                   quiesce::load_plant);
    const std::string shorter = stiff + "\n[integration]\nmax_step_us = ";
    EXPECT_DOUBLE_EQ(loaded(shorter + "33").max_step_s, 33e-6);
    expect_message(shorter + "34", "integration.max_step_us: 34 us is too long",
                   quiesce::load_plant);
}

TEST(PlantDamper, with_hysteresis_converges_with_the_step) {
    PlantModel model = loaded(with_damper(kBoucWen));
    const double expected_m = shaken(model, 2.0, 0.5).amplitude_m();
    model.max_step_s = 2e-5;
    EXPECT_NEAR(shaken(model, 2.0, 0.5).amplitude_m() / expected_m, 1.0, 1e-4);
}

TEST(PlantDamper, with_hysteresis_has_a_periodic_solution) {
    PlantModel model = loaded(with_damper(kBoucWen));
    model.driver.bits = 24; // orbits know no rounding of the current
    quiesce::PeriodicOrbit orbit(model, {2.0, model.shaker.drive_V, 8, true});
    orbit.solve(std::vector<double>(8, 0.5).data(), nullptr);
    const Eigen::VectorXd &disp_m = orbit.period().disp_m;
    const Steady steady = shaken(model, 2.0, 0.5);
    EXPECT_LT(orbit.residual(), 1e-9);
    EXPECT_NEAR(disp_m.maxCoeff() / steady.highest_m, 1.0, 1e-3);
    EXPECT_NEAR(disp_m.minCoeff() / steady.lowest_m, 1.0, 1e-3);
}

} // namespace
