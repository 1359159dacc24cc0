/// Places, several dampers and noise in plant files: what is read, and what mistakes are answered
/// with.
#include <gtest/gtest.h>

#include <string>

#include "excitation.h"
#include "file_mistakes.h"
#include "plant.h"
#include "plant_file.h"
#include "sine_segment.h"

namespace {

using quiesce::expect_message;
using quiesce::Mistake;
using quiesce::PlantModel;
using quiesce::read;
using quiesce::spoilt;
using quiesce::TemporaryFile;

const char *const kTwoStoreys = "sim_hil/data/plants/two_storeys.toml";
const char *const kFrame = "sim_hil/data/plants/frame_3dof.toml";
const char *const kModes = "sim_hil/data/plants/squeeze_2012.toml";

PlantModel loaded(const std::string &text) {
    const TemporaryFile file(text);
    return quiesce::load_plant(file.path());
}

/// A good file with its first `from` as `to`.
PlantModel changed(const char *file, const char *from, const char *to) {
    return loaded(spoilt(read(file), {"", from, to, ""}));
}

TEST(PlaceFile, the_example_has_two_places_and_two_dampers) {
    const PlantModel model = quiesce::load_plant(kTwoStoreys);
    ASSERT_EQ(model.places.size(), 2u);
    EXPECT_EQ(model.places[0].name, "floor");
    EXPECT_EQ(model.places[1].name, "roof");
    EXPECT_EQ(model.places[1].shape, model.structure.at_sensor);
    EXPECT_EQ(model.places[0].base, 1.0);
    ASSERT_EQ(model.dampers.size(), 2u);
    EXPECT_EQ(model.dampers[0].name, "lower");
    EXPECT_EQ(model.dampers[0].stroke, model.places[0].shape);
    EXPECT_EQ(model.dampers[1].name, "upper");
    EXPECT_EQ(model.dampers[1].stroke, model.places[1].shape - model.places[0].shape);
    EXPECT_EQ(model.dampers[1].coil.fall_s, 0.006);
    EXPECT_EQ(model.dampers[1].coil.rise_s, 0.010);
    EXPECT_TRUE(model.structure.is_proportional);
    EXPECT_NEAR(std::sqrt(model.structure.omega2_rad2_s2[0]) / 6.283185307, 3.0, 0.01);
    EXPECT_NEAR(std::sqrt(model.structure.omega2_rad2_s2[1]) / 6.283185307, 7.85, 0.01);
    EXPECT_TRUE(model.noise.empty());
}

TEST(PlaceFile, a_damper_with_ends_is_bit_for_bit_the_damper_of_the_structure) {
    std::string text = spoilt(read(kFrame), {"", "damper = [1.0, 0.0, 0.0]\n", "", ""});
    text = spoilt(text,
                  {"", "[damper]", "[[damper]]\nname = \"d\"\na = \"first\"\nb = \"ground\"", ""});
    const PlantModel with_ends = loaded(text + "[[place]]\nname = \"first\"\nat = [1, 0, 0]\n");
    const PlantModel plain = quiesce::load_plant(kFrame);
    EXPECT_EQ(with_ends.dampers[0].stroke, plain.dampers[0].stroke);
    quiesce::Excitation excitation;
    excitation.append(std::make_unique<quiesce::SineSegment>(plain.shaker, 5.0), 1e5);
    quiesce::Plant a(plain, excitation, 1000);
    quiesce::Plant b(with_ends, excitation, 1000);
    for (int tick = 0; tick < 500; ++tick) {
        a.command(0, 1.0, quiesce::ActuatorFault::none);
        b.command(0, 1.0, quiesce::ActuatorFault::none);
        a.advance();
        b.advance();
        ASSERT_EQ(a.truth().accel_m_s2, b.truth().accel_m_s2) << tick;
        ASSERT_EQ(a.truth().damper_force_N, b.truth().damper_force_N) << tick;
    }
    EXPECT_NE(a.truth().damper_force_N, 0.0);
}

TEST(PlaceFile, a_plant_with_one_plain_damper_may_have_places) {
    const PlantModel model = changed(
        kModes, "[driver]", "[[place]]\nname = \"tip\"\nat = [4.4086, -2.5316]\n\n[driver]");
    ASSERT_EQ(model.places.size(), 1u);
    EXPECT_EQ(model.places[0].shape, model.structure.at_sensor);
    EXPECT_EQ(model.places[0].base, 1.0) << "of modes, where nothing else is said";
    EXPECT_EQ(model.dampers[0].name, "damper");
    const PlantModel still = changed(
        kModes, "[driver]", "[[place]]\nname = \"tip\"\nat = [1, 2]\nbase = 0.25\n\n[driver]");
    EXPECT_EQ(still.places[0].base, 0.25);
}

TEST(PlaceFile, a_place_moves_with_the_base_as_its_degrees_of_freedom_do) {
    const PlantModel model =
        changed(kTwoStoreys, "sensor = [0.0, 1.0]", "sensor = [0.0, 1.0]\nbase = [0.5, 0.75]");
    EXPECT_EQ(model.places[0].base, 0.5);
    EXPECT_EQ(model.places[1].base, 0.75);
}

TEST(PlaceFile, a_dampers_own_coil_is_before_the_plants) {
    const PlantModel model = changed(kTwoStoreys, "[driver]",
                                     "[damper.coil]\nrise_s = 0.002\nremanence = 0.1\n\n[driver]");
    EXPECT_EQ(model.dampers[0].coil.rise_s, 0.010);
    EXPECT_EQ(model.dampers[1].coil.rise_s, 0.002);
    EXPECT_EQ(model.dampers[1].coil.fall_s, 0.002);
    EXPECT_EQ(model.dampers[1].coil.remanence, 0.1);
}

TEST(PlaceFile, noise_is_a_number_for_each_sensor) {
    const PlantModel model =
        loaded(read(kTwoStoreys) + "\n[noise]\nroof_accel = 500.0\nupper_stroke = 0\n");
    const std::map<std::string, double> expected = {{"roof_accel", 500.0}, {"upper_stroke", 0.0}};
    EXPECT_EQ(model.noise, expected);
}

class PlaceMistakes : public testing::TestWithParam<Mistake> {};

TEST_P(PlaceMistakes, are_named) {
    expect_message(spoilt(read(kTwoStoreys), GetParam()), GetParam().words, quiesce::load_plant);
}

const char *const kThreeMorePlaces = "[[place]]\nname = \"p3\"\nat = [1, 1]\n"
                                     "[[place]]\nname = \"p4\"\nat = [1, 2]\n"
                                     "[[place]]\nname = \"p5\"\nat = [1, 3]\n"
                                     "[driver]";
const char *const kTwoPlaces = "[[place]]\nname = \"floor\"\nat = [1.0, 0.0]\n\n"
                               "[[place]]\nname = \"roof\"\nat = [0.0, 1.0]\n";

const Mistake kMistakes[] = {
    {"place_is_a_table", kTwoPlaces, "[place]\nname = \"floor\"\nat = [1, 0]\n",
     "place: expected tables [[place]], found a table"},
    {"place_without_name", "name = \"floor\"\n", "", "place[1].name: missing"},
    {"place_name_empty", "name = \"floor\"", "name = \"\"", "place[1].name: expected a text"},
    {"place_name_a_number", "name = \"floor\"", "name = 1", "place[1].name: expected a text"},
    {"place_name_with_a_space", "name = \"floor\"", "name = \"my floor\"",
     "place[1].name: expected a letter, then at most 31 letters, digits or _, found "
     "'my floor'"},
    {"place_name_begins_with_a_digit", "name = \"roof\"", "name = \"2nd\"",
     "place[2].name: expected a letter"},
    {"place_name_too_long", "name = \"roof\"", "name = \"a23456789_123456789_123456789_123\"",
     "place[2].name: expected a letter"},
    {"place_is_ground", "name = \"floor\"", "name = \"ground\"",
     "place[1].name: expected a name that nothing else has, found 'ground'"},
    {"place_twice", "name = \"roof\"", "name = \"floor\"",
     "place[2].name: expected a name that nothing else has, found 'floor'"},
    {"place_nowhere", "at = [1.0, 0.0]\n", "", "place[1].at: missing"},
    {"place_at_a_number", "at = [1.0, 0.0]", "at = 1.0", "place[1].at: expected an array of 2"},
    {"place_at_too_few", "at = [1.0, 0.0]", "at = [1.0]",
     "place[1].at: expected an array of 2 numbers, found 1"},
    {"place_at_nan", "at = [1.0, 0.0]", "at = [1.0, nan]", "place[1].at: expected a number"},
    {"place_base_of_matrices", "at = [1.0, 0.0]", "at = [1.0, 0.0]\nbase = 1.0",
     "place[1].base: unknown key; expected one of: at, name"},
    {"place_with_another_key", "at = [1.0, 0.0]", "at = [1.0, 0.0]\nfloor = 1",
     "place[1].floor: unknown key"},
    {"five_places", "[driver]", kThreeMorePlaces,
     "place: expected at most 4 tables [[place]], found 5"},
    {"damper_without_name", "name = \"lower\"\n", "", "damper[1].name: missing"},
    {"damper_name_with_a_dot", "name = \"lower\"", "name = \"lo.wer\"",
     "damper[1].name: expected a letter"},
    {"damper_twice", "name = \"upper\"", "name = \"lower\"",
     "damper[2].name: expected a name that nothing else has, found 'lower'"},
    {"damper_without_a", "a = \"floor\"\n", "",
     "damper[1].a: missing; expected one of: ground, floor, roof"},
    {"damper_without_b", "b = \"ground\"\n", "", "damper[1].b: missing"},
    {"damper_at_an_unknown_place", "a = \"roof\"", "a = \"attic\"",
     "damper[2].a: expected one of: ground, floor, roof; found 'attic'"},
    {"damper_in_one_place", "b = \"floor\"", "b = \"roof\"",
     "damper[2].b: expected another end than a, found 'roof'"},
    {"damper_in_the_ground", "a = \"floor\"", "a = \"ground\"",
     "damper[1].b: expected another end than a, found 'ground'"},
    {"damper_without_stroke", "at = [0.0, 1.0]", "at = [1.0, 0.0]",
     "damper[2].b: roof and floor move alike, so there is no stroke between them"},
    {"damper_without_model", "model = \"bingham\"\n", "", "damper[1].model: missing"},
    {"damper_with_another_key", "b = \"floor\"", "b = \"floor\"\nc = \"roof\"",
     "damper[2].c: unknown key"},
    {"damper_with_a_wrong_parameter", "fc_N = [1.0, 3.0]", "fc_N = \"much\"",
     "damper[1].parameters.fc_N: expected a number"},
    {"damper_coil_without_rise", "[driver]", "[damper.coil]\nfall_s = 0.01\n[driver]",
     "damper[2].coil.rise_s: missing"},
    {"damper_coil_a_number", "name = \"upper\"", "name = \"upper\"\ncoil = 0.01",
     "damper[2].coil: expected a table"},
    {"no_coil_at_all", "[coil]\nrise_s = 0.010\nfall_s = 0.006\n", "", "coil: missing"},
    {"damper_of_the_structure_too", "sensor = [0.0, 1.0]",
     "sensor = [0.0, 1.0]\ndamper = [1.0, 0.0]",
     "structure.damper: with [[damper]] the ends a and b say where a damper is; leave it out"},
    {"step_too_long_for_the_second", "eps_m_s = 0.005\n\n[driver]", "eps_m_s = 1e-6\n\n[driver]",
     "too long for this plant's fastest motion"},
    {"noise_is_a_number",
     "schema =", "noise = 3\nschema =", "noise: expected a table [noise], found 3"},
    {"noise_below_0", "[driver]", "[noise]\nroof = -1.0\n[driver]",
     "noise.roof: expected a number in 0 .. 1e+09 (RMS per sample), found -1"},
    {"noise_above_its_range", "[driver]", "[noise]\nroof = 2e9\n[driver]",
     "noise.roof: expected a number in 0 .. 1e+09"},
    {"noise_a_text", "[driver]", "[noise]\nroof = \"much\"\n[driver]",
     "noise.roof: expected a number"},
    {"noise_of_no_name", "[driver]", "[noise]\n\"roof accel\" = 1.0\n[driver]",
     "noise.roof accel: expected a letter, then"},
};
INSTANTIATE_TEST_SUITE_P(PlantFile, PlaceMistakes, testing::ValuesIn(kMistakes),
                         [](const auto &test) { return std::string(test.param.name); });

std::string with_dampers(std::size_t count) {
    std::string text = read(kTwoStoreys);
    for (std::size_t i = 2; i < count; ++i) {
        text += "\n[[damper]]\nname = \"d" + std::to_string(i) +
                "\"\na = \"roof\"\nb = \"ground\"\nmodel = \"viscous\"\nbase_N_s_m = 1\n"
                "per_A_N_s_m = 1\nstroke_m = 1\n";
    }
    return text;
}

TEST(PlaceFile, takes_four_dampers_and_no_more) {
    EXPECT_EQ(loaded(with_dampers(4)).dampers.size(), 4u);
    expect_message(with_dampers(5), "damper: expected at most 4 tables [[damper]], found 5",
                   quiesce::load_plant);
}

TEST(PlaceFile, an_empty_list_of_dampers_is_refused) {
    const std::string without =
        spoilt(read(kFrame), {"",
                              "[damper]\nmodel = \"viscous\"\nbase_N_s_m = 5.0\nper_A_N_s_m = "
                              "40.0\nstroke_m = 0.01\n",
                              "", ""});
    expect_message("damper = []\n" + spoilt(without, {"", "damper = [1.0, 0.0, 0.0]\n", "", ""}),
                   "damper: expected tables [[damper]], found an array", quiesce::load_plant);
}

TEST(PlaceFile, the_only_damper_has_no_name_and_no_ends) {
    for (const char *key : {"name = \"d\"", "a = \"x\"", "b = \"ground\"", "coil = {rise_s = 1}"}) {
        expect_message(
            spoilt(read(kFrame), {"", "[damper]", (std::string("[damper]\n") + key).c_str(), ""}),
            "unknown key", quiesce::load_plant);
    }
}

TEST(PlaceFile, modes_of_a_plant_with_ends_have_no_damper) {
    std::string text = spoilt(read(kModes), {"", "[damper]", "[[damper]]", ""});
    expect_message(text, "structure.mode[1].at_damper: with [[damper]] the ends a and b say",
                   quiesce::load_plant);
    text = spoilt(text, {"", "at_damper = 4.4086\n", "", ""});
    text = spoilt(text, {"", "at_damper = -2.5316\n", "", ""});
    text =
        spoilt(text, {"", "model =", "name = \"film\"\na = \"tip\"\nb = \"ground\"\nmodel =", ""});
    text += "[[place]]\nname = \"tip\"\nat = [4.4086, -2.5316]\n";
    EXPECT_EQ(loaded(text).dampers[0].stroke, quiesce::load_plant(kModes).dampers[0].stroke);
}

TEST(PlaceFile, an_only_damper_may_be_on_a_lever_too) {
    const std::string text =
        spoilt(read(kModes), {"", "[damper]\n", "[damper]\nratio = 0.5\n", ""});
    const quiesce::PlantDamper damper = loaded(text).dampers[0];
    EXPECT_EQ(damper.ratio, 0.5);
    EXPECT_EQ(damper.stroke, 0.5 * quiesce::load_plant(kModes).dampers[0].stroke);
    expect_message(spoilt(text, {"", "0.5\n", "0\n", ""}),
                   "damper.ratio: expected a number in 0.01", quiesce::load_plant);
}

TEST(PlaceFile, a_drivers_current_holds_for_the_file_of_every_damper) {
    const std::string text =
        spoilt(read(kTwoStoreys),
               {"",
                "model = \"bingham\"\nstroke_m = 0.04\nspeed_m_s = 1.0\n[damper.parameters]\n"
                "fc_N = [1.0, 3.0]\nc_N_s_m = [5.0, 5.0]\nf0_N = 0.0\neps_m_s = 0.005\n\n[driver]",
                "file = \"FILE\"\n\n[driver]", ""});
    const std::string file =
        std::filesystem::absolute("sim_hil/data/dampers/rd1005_kwok_tanh_smooth.toml").string();
    expect_message(spoilt(text, {"", "FILE", file.c_str(), ""}),
                   "driver.max_current_A: 2 is beyond the 1.88 up to which the file of the damper "
                   "upper holds",
                   quiesce::load_plant);
}

} // namespace
