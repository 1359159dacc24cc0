/// Plant and scenario files: what is read, and what every kind of mistake is answered with.
#include <gtest/gtest.h>

#include <filesystem>
#include <string>

#include "file_mistakes.h"
#include "input_error.h"
#include "plant_file.h"
#include "scenario.h"

namespace {

using quiesce::expect_message;
using quiesce::InputError;
using quiesce::Mistake;
using quiesce::read;
using quiesce::spoilt;

const char *const kModesPlant = "sim_hil/data/plants/squeeze_2012.toml";
const char *const kMatricesPlant = "sim_hil/data/plants/frame_3dof.toml";

class ModesPlantMistakes : public testing::TestWithParam<Mistake> {};
class MatricesPlantMistakes : public testing::TestWithParam<Mistake> {};
class ScenarioMistakes : public testing::TestWithParam<Mistake> {};

TEST_P(ModesPlantMistakes, are_named) {
    expect_message(spoilt(read(kModesPlant), GetParam()), GetParam().words, quiesce::load_plant);
}

TEST_P(MatricesPlantMistakes, are_named) {
    expect_message(spoilt(read(kMatricesPlant), GetParam()), GetParam().words, quiesce::load_plant);
}

TEST_P(ScenarioMistakes, are_named) {
    expect_message(spoilt(read("sim_hil/data/scenarios/step_10_20Hz.toml"), GetParam()),
                   GetParam().words, quiesce::load_scenario);
}

const Mistake kModesPlantMistakes[] = {
    {"not_toml", "[structure]", "[structure", "expected"},
    {"other_schema", "\"quiesce-plant\"", "\"quiesce-scenario\"",
     "schema: expected one of: quiesce-plant; found 'quiesce-scenario'"},
    {"newer_version", "version = 1", "version = 2", "version: expected an integer in 1 .. 1"},
    {"version_text", "version = 1", "version = \"1\"", "version: expected an integer in 1 .. 1"},
    {"no_name", "name = \"squeeze_2012\"", "", "name: missing"},
    {"empty_name", "\"squeeze_2012\"", "\"\"", "name: expected a text"},
    {"unknown_root_key", "name =", "colour = 1\nname =", "colour: unknown key; expected one of:"},
    {"unknown_kind", "kind = \"modes\"", "kind = \"fem\"",
     "structure.kind: expected one of: modes, nodes, matrices; found 'fem'"},
    {"no_frequency", "freq_Hz = 11.5", "", "structure.mode[1].freq_Hz: missing"},
    {"zero_frequency", "freq_Hz = 96.0", "freq_Hz = 0",
     "structure.mode[2].freq_Hz: expected a number in 0.001 .. 10000 (Hz), found 0"},
    {"frequency_nan", "freq_Hz = 96.0", "freq_Hz = nan", "structure.mode[2].freq_Hz: expected"},
    {"frequency_inf", "freq_Hz = 96.0", "freq_Hz = inf", "structure.mode[2].freq_Hz: expected"},
    {"negative_damping", "damping_ratio = 0.014375", "damping_ratio = -0.01",
     "structure.mode[2].damping_ratio: expected a number in 0 .. 2"},
    {"shape_text", "at_force = 0.1727", "at_force = \"0.1727\"",
     "structure.mode[1].at_force: expected a number"},
    {"base_text", "base_participation = 0.190", "base_participation = \"0.19\"",
     "structure.mode[1].base_participation: expected a number"},
    {"misspelt_mode_key", "at_force = 0.1727", "at_force = 0.1727\nat_frce = 1",
     "structure.mode[1].at_frce: unknown key"},
    {"mode_is_a_number", "kind = \"modes\"\n", "kind = \"modes\"\nmodes = 2\n",
     "structure.modes: unknown key"},
    {"no_damper", "[damper]", "[dampr]",
     "damper: missing; is 'dampr' meant for it? expected a table [damper]"},
    {"unknown_damper", "\"squeeze_biviscosity\"", "\"sponge\"",
     "viscous, viscous_dahl, zhang_tanh; found 'sponge'"},
    {"zero_gap", "gap_m = 0.002", "gap_m = 0", "damper.gap_m: expected a number in 1e-06 .. 0.1"},
    {"gap_in_millimetres", "gap_m = 0.002", "gap_m = 2.0", "damper.gap_m: expected a number"},
    {"min_gap_above_gap", "gap_m = 0.002", "gap_m = 0.002\nmin_gap_m = 0.003",
     "damper.min_gap_m: expected less than gap_m"},
    {"ratio_above_one", "viscosity_ratio = 3e-5", "viscosity_ratio = 1.5",
     "damper.viscosity_ratio: expected a number in 1e-12 .. 1"},
    {"ratio_zero", "viscosity_ratio = 3e-5", "viscosity_ratio = 0.0", "damper.viscosity_ratio:"},
    {"negative_yield", "yield_coefficient = 0.160", "yield_coefficient = -0.1",
     "damper.yield_coefficient:"},
    {"no_turns", "coil_turns = 1000", "", "damper.coil_turns: missing"},
    {"misspelt_damper_key", "force_scale = 4.74e-5", "force_scal = 4.74e-5",
     "damper.force_scal: unknown key; is 'force_scale' meant? expected one of: coil_radius_m, "
     "coil_turns, force_scale"},
    {"misspelt_needed_key", "coil_turns = 1000", "coil_turn = 1000",
     "damper.coil_turns: missing; is 'coil_turn' meant for it? expected"},
    {"two_unknown_keys",
     "name =", "colour = 1\nmaker = \"x\"\nname =", "colour: unknown key; expected one of:"},
    {"unknown_keys_are_counted",
     "name =", "colour = 1\nmaker = \"x\"\nnotes = 1\nname =", "(and 2 more unknown keys)"},
    {"unstable_force_scale", "force_scale = 4.74e-5", "force_scale = 1.0",
     "too long for this plant's fastest motion; set integration.max_step_us to"},
    {"zero_max_current", "max_current_A = 5.0", "max_current_A = 0.0", "driver.max_current_A:"},
    {"fractional_bits", "bits = 12", "bits = 12.5", "driver.bits: expected an integer in 4 .. 24"},
    {"negative_rise", "rise_s = 0.005", "rise_s = -0.005", "coil.rise_s: expected a number in 0"},
    {"no_rise", "rise_s = 0.005", "", "coil.rise_s: missing"},
    {"remanence", "rise_s = 0.005", "rise_s = 0.005\nremanence = 0.6",
     "coil.remanence: expected a number in 0 .. 0.5"},
    {"no_drive", "drive_V = 0.10", "", "shaker.drive_V: missing"},
    {"both_gains", "drive_V = 0.10", "drive_V = 0.10\ngain_m_s2_V = 1.0",
     "shaker.gain_N_V: unknown key"},
    {"drive_bool", "drive_V = 0.10", "drive_V = true", "shaker.drive_V: expected a number"},
    {"sensor_bits", "bits = 24", "bits = 32", "sensor.bits: expected an integer in 8 .. 24"},
    {"sensor_offset", "noise_mg = 0.5", "offset_counts = 9000000", "sensor.offset_counts:"},
    {"integration_is_a_number",
     "name =", "integration = 5\nname =", "integration: expected a table [integration]"},
};
INSTANTIATE_TEST_SUITE_P(PlantFile, ModesPlantMistakes, testing::ValuesIn(kModesPlantMistakes),
                         [](const auto &test) { return std::string(test.param.name); });

const Mistake kMatricesPlantMistakes[] = {
    {"short_row", "[2.0, 0.0, 0.0]", "[2.0, 0.0]",
     "structure.mass_kg: expected an array of 3 numbers, found 2"},
    {"missing_row", "    [0.0, 0.0, 1.0],\n", "",
     "structure.mass_kg: expected 3 rows of 3 numbers, found 2 rows"},
    {"text_in_matrix", "[2.0, 0.0, 0.0]", "[2.0, \"0.0\", 0.0]",
     "structure.mass_kg: expected a number"},
    {"massless", "[2.0, 0.0, 0.0]", "[0.0, 0.0, 0.0]",
     "structure.mass_kg: expected a positive definite matrix"},
    {"asymmetric_stiffness", "[9000.0, -4000.0, 0.0]", "[9000.0, -4000.0, 1.0]",
     "structure.stiffness_N_m: expected a symmetric matrix"},
    {"unstable_stiffness", "[9000.0, -4000.0, 0.0]", "[-9000.0, -4000.0, 0.0]",
     "structure.stiffness_N_m: expected no negative eigenvalue"},
    {"active_damping", "[4.0, -0.5, 0.0]", "[-4.0, -0.5, 0.0]",
     "structure.damping_N_s_m: expected no negative eigenvalue"},
    {"no_stiffness", "stiffness_N_m", "stiffnes_N_m", "structure.stiffness_N_m: missing"},
    {"sensor_length", "sensor = [0.0, 0.0, 1.0]", "sensor = [0.0, 1.0]",
     "structure.sensor: expected an array of 3 numbers, found 2"},
    {"force_empty", "force = [0.0, 0.0, 1.0]", "force = []",
     "structure.force: expected an array of numbers, found 0"},
    {"base_length", "sensor = [0.0, 0.0, 1.0]", "sensor = [0.0, 0.0, 1.0]\nbase = [1.0]",
     "structure.base: expected an array of 3 numbers, found 1"},
    {"too_many_modes", "sensor = [0.0, 0.0, 1.0]", "sensor = [0.0, 0.0, 1.0]\nmode_count = 4",
     "structure.mode_count: expected an integer in 1 .. 3, found 4"},
    {"no_switched_stiffness", "\"viscous\"", "\"switched_stiffness\"", "damper.base_N_m: missing"},
    {"stiffness_below_0", "model = \"viscous\"",
     "model = \"switched_stiffness\"\nbase_N_m = 1\nper_A_N_m = -1",
     "damper.per_A_N_m: expected a number in 0"},
    {"stiffness_too_fast", "model = \"viscous\"",
     "model = \"switched_stiffness\"\nbase_N_m = 1\nper_A_N_m = 1e9",
     "too long for this plant's fastest motion"},
    {"no_stroke", "stroke_m = 0.01", "", "damper.stroke_m: missing"},
};
INSTANTIATE_TEST_SUITE_P(PlantFile, MatricesPlantMistakes,
                         testing::ValuesIn(kMatricesPlantMistakes),
                         [](const auto &test) { return std::string(test.param.name); });

const Mistake kScenarioMistakes[] = {
    {"other_schema", "\"quiesce-scenario\"", "\"quiesce-plant\"", "schema: expected one of"},
    {"no_plant", "plant = \"../plants/squeeze_2012.toml\"", "", "plant: missing"},
    {"zero_duration", "duration_s = 10.0", "duration_s = 0.0", "duration_s: expected a number"},
    {"no_duration", "duration_s = 10.0", "", "duration_s: missing"},
    {"negative_noise", "noise_mg = 0.5", "noise_mg = -1", "noise_mg: expected a number in 0"},
    {"negative_seed", "noise_mg = 0.5", "seed = -1", "seed: expected an integer in 0"},
    {"feed_current_text", "noise_mg = 0.5", "feed_current = \"yes\"",
     "feed_current: expected true or false, found 'yes'"},
    {"unknown_key", "noise_mg = 0.5", "noise_g = 0.5", "noise_g: unknown key"},
    {"unknown_segment", "kind = \"sine\"", "kind = \"square\"",
     "segment[1].kind: expected one of: sine, chirp, tones, random, impulse, record, base_tones; "
     "found "
     "'square'"},
    {"no_frequency", "freq_Hz = 20", "", "segment[2].freq_Hz: missing"},
    {"chirp_without_end", "kind = \"sine\"", "kind = \"chirp\"", "segment[1].end_freq_Hz: missing"},
    {"sine_with_end", "freq_Hz = 20", "freq_Hz = 20\nend_freq_Hz = 30",
     "segment[2].end_freq_Hz: unknown key"},
    {"open_segment_first", "duration_s = 4.0", "", "segment[1].duration_s: missing"},
    {"not_covered", "freq_Hz = 20", "freq_Hz = 20\nduration_s = 1.0",
     "segment: the segments end at 5.000000 s, before duration_s"},
    {"window_backwards", "end_s = 4.0", "end_s = 1.0", "window[1].end_s: expected a number in 2"},
    {"window_past_the_end", "end_s = 10.0", "end_s = 11.0", "window[2].end_s: expected a number"},
    {"transient_too_late", "disp_end_s = 6.0", "disp_end_s = 60.0", "transient.disp_end_s:"},
    {"unknown_fault", "[transient]",
     "[[fault]]\nkind = \"fire\"\nt_s = 1\nduration_s = 1\n[transient]",
     "fault[1].kind: expected one of: dropout, stuck, saturate, range, estop, fault_reset, "
     "disable, lost_tick, coil_open, driver_stuck; found 'fire'"},
    {"fault_after_the_end", "[transient]",
     "[[fault]]\nkind = \"stuck\"\nt_s = 20\nduration_s = 1\n[transient]", "fault[1].t_s:"},
    {"fault_without_duration", "[transient]", "[[fault]]\nkind = \"stuck\"\nt_s = 2\n[transient]",
     "fault[1].duration_s: missing"},
};
INSTANTIATE_TEST_SUITE_P(ScenarioFile, ScenarioMistakes, testing::ValuesIn(kScenarioMistakes),
                         [](const auto &test) { return std::string(test.param.name); });

TEST(ScenarioFile, without_segments_is_refused) {
    expect_message("schema = \"quiesce-scenario\"\nversion = 1\nname = \"x\"\nplant = "
                   "\"p.toml\"\nduration_s = 1\n",
                   "segment: expected at least one table [[segment]]", quiesce::load_scenario);
}

TEST(ScenarioFile, a_plant_that_is_not_there_is_named_with_file_and_key) {
    const quiesce::TemporaryFile file(
        spoilt(read("sim_hil/data/scenarios/step_10_20Hz.toml"),
               {"", "../plants/squeeze_2012.toml", "no/such.toml", ""}));
    const quiesce::Scenario scenario = quiesce::load_scenario(file.path());
    try {
        quiesce::plant_of(scenario);
        FAIL() << "it was found";
    } catch (const InputError &error) {
        const std::string message = error.what();
        EXPECT_NE(message.find(file.path() + ": plant: there is no file "), std::string::npos)
            << message;
        EXPECT_NE(message.find("no/such.toml"), std::string::npos) << message;
    }
}

TEST(ScenarioFile, takes_eight_windows_and_no_more) {
    const std::string good = read("sim_hil/data/scenarios/step_10_20Hz.toml");
    std::string six;
    for (int i = 0; i < 6; ++i) {
        six += "[[window]]\nstart_s = 1\nend_s = 2\n";
    }
    const quiesce::TemporaryFile file(good + six);
    EXPECT_EQ(quiesce::load_scenario(file.path()).windows.size(), 8u);
    expect_message(good + six + "[[window]]\nstart_s = 1\nend_s = 2\n",
                   "window: expected at most 8", quiesce::load_scenario);
}

TEST(ScenarioFile, empty_or_missing_is_refused) {
    expect_message("", "schema: missing", quiesce::load_scenario);
    EXPECT_THROW(quiesce::load_scenario("no/such/file.toml"), InputError);
    EXPECT_THROW(quiesce::load_plant("tests"), InputError) << "a folder";
}

TEST(ScenarioFile, reads_what_it_says) {
    const quiesce::Scenario scenario =
        quiesce::load_scenario("sim_hil/data/scenarios/step_10_20Hz.toml");
    EXPECT_EQ(scenario.plant_file, "sim_hil/data/plants/squeeze_2012.toml");
    EXPECT_EQ(scenario.duration_s, 10.0);
    EXPECT_EQ(scenario.seed, 1u);
    EXPECT_EQ(scenario.noise_mg, 0.5);
    EXPECT_FALSE(scenario.feed_current);
    ASSERT_EQ(scenario.segments.size(), 2u);
    EXPECT_EQ(scenario.segments[0].duration_s, 4.0);
    ASSERT_EQ(scenario.windows.size(), 2u);
    EXPECT_EQ(scenario.windows[1].start_s, 8.0);
    EXPECT_EQ(scenario.transient->disp_end_s, 6.0);
}

TEST(ScenarioFile, every_shipped_scenario_and_its_plant_load) {
    int count = 0;
    for (const auto &entry : std::filesystem::directory_iterator("sim_hil/data/scenarios")) {
        if (read(entry.path().string()).find("\"quiesce-scenario\"") == std::string::npos) {
            continue; // tables of reference figures live beside the scenarios
        }
        const quiesce::Scenario scenario = quiesce::load_scenario(entry.path().string());
        EXPECT_EQ(scenario.name, entry.path().stem().string());
        EXPECT_FALSE(quiesce::load_plant(scenario.plant_file).name.empty());
        ++count;
    }
    EXPECT_GE(count, 7);
}

TEST(PlantFile, the_frozen_plant_is_the_frozen_plant) {
    const quiesce::PlantModel model = quiesce::load_plant(kModesPlant);
    EXPECT_EQ(model.structure.mode_count(), 2);
    EXPECT_NEAR(model.structure.damping_1_s(0, 0), 10.87, 0.005);
    EXPECT_NEAR(model.structure.damping_1_s(1, 1), 17.34, 0.005);
    EXPECT_LT(model.structure.at_sensor[1], 0.0) << "the corrected sign";
    EXPECT_EQ(model.structure.base_participation[0], 0.190);
    EXPECT_EQ(model.structure.base_participation[1], 0.095);
    EXPECT_EQ(model.structure.base_at_sensor, 1.0);
    EXPECT_NEAR(model.dampers[0].damper->stiffest_N_s_m(5.0), 15.3, 0.05);
    EXPECT_NEAR(model.dampers[0].damper->stiffest_N_s_m(0.0), 4.6e-4, 0.05e-4);
    EXPECT_DOUBLE_EQ(model.max_step_s, 500e-6);
}

TEST(PlantFile, the_example_frame_has_coupled_modes) {
    const quiesce::PlantModel model = quiesce::load_plant(kMatricesPlant);
    EXPECT_EQ(model.structure.mode_count(), 3);
    EXPECT_FALSE(model.structure.is_proportional);
}

} // namespace
