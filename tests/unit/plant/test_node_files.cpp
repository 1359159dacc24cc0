/// Plants whose modes are given over named nodes.
#include <gtest/gtest.h>

#include <string>

#include "excitation.h"
#include "file_mistakes.h"
#include "plant.h"
#include "plant_file.h"
#include "sine_segment.h"

namespace {

using quiesce::Mistake;
using quiesce::PlantModel;
using quiesce::read;
using quiesce::spoilt;
using quiesce::TemporaryFile;

const char *const kThreePoints = "sim_hil/data/plants/squeeze_2012.toml";

/// squeeze_2012_nodes.toml without its sensor files, whose paths lead nowhere from elsewhere.
std::string nodes() {
    const std::string all = read("sim_hil/data/plants/squeeze_2012_nodes.toml");
    return all.substr(0, all.find("[sensor]")) + "[sensor]\nfull_scale_g = 49.4\nbits = 24\n";
}

PlantModel loaded(const std::string &text) {
    const TemporaryFile file(text);
    return quiesce::load_plant(file.path());
}

PlantModel changed(const char *from, const char *to) {
    return loaded(spoilt(nodes(), {"", from, to, ""}));
}

TEST(NodeFile, five_nodes_are_bit_for_bit_the_plant_of_three_points) {
    const PlantModel three = quiesce::load_plant(kThreePoints);
    const PlantModel five = loaded(nodes());
    quiesce::Excitation excitation;
    excitation.append(std::make_unique<quiesce::SineSegment>(three.shaker, 10.0), 1e5);
    quiesce::Plant a(three, excitation, 1000);
    quiesce::Plant b(five, excitation, 1000);
    for (int tick = 0; tick < 500; ++tick) {
        a.command(0, 2.0, quiesce::ActuatorFault::none);
        b.command(0, 2.0, quiesce::ActuatorFault::none);
        a.advance();
        b.advance();
        ASSERT_EQ(a.truth().accel_m_s2, b.truth().accel_m_s2) << tick;
        ASSERT_EQ(a.truth().damper_force_N, b.truth().damper_force_N) << tick;
        ASSERT_EQ(b.truth().accel_m_s2, b.place(4).accel_m_s2) << tick;
    }
    EXPECT_NE(a.truth().damper_force_N, 0.0);
}

TEST(NodeFile, each_node_is_a_place) {
    const PlantModel model = loaded(nodes());
    ASSERT_EQ(model.places.size(), 5u);
    EXPECT_EQ(model.places[2].name, "node3");
    EXPECT_EQ(model.places[2].shape, Eigen::Vector2d(1.7753, 5.9253));
    EXPECT_EQ(model.places[4].shape, Eigen::Vector2d(4.4086, -2.5316));
    EXPECT_EQ(model.places[4].base, 1.0);
}

TEST(NodeFile, sensor_and_damper_may_be_at_any_node) {
    EXPECT_EQ(changed("sensor = \"node5\"", "sensor = \"node2\"").structure.at_sensor,
              Eigen::Vector2d(0.7728, 5.2380));
    EXPECT_EQ(changed("damper = \"node5\"", "damper = \"node3\"").dampers[0].stroke,
              Eigen::Vector2d(1.7753, 5.9253));
    EXPECT_EQ(changed("force = \"node1\"", "force = \"node4\"").structure.at_force,
              Eigen::Vector2d(3.2263, 3.9048));
}

TEST(NodeFile, dampers_and_places_between_nodes) {
    std::string text = spoilt(nodes(), {"", "damper = \"node5\"\n", "", ""});
    text = spoilt(text,
                  {"", "[damper]", "[[damper]]\nname = \"d\"\na = \"node5\"\nb = \"node3\"", ""});
    const PlantModel model =
        loaded(text + "[[place]]\nname = \"middle\"\nat = [0, 0, 0, 0.5, 0.5]\n"
                      "[integration]\nmax_step_us = 250\n");
    EXPECT_EQ(model.dampers[0].stroke, model.places[4].shape - model.places[2].shape);
    ASSERT_EQ(model.places.size(), 6u);
    EXPECT_EQ(model.places[5].shape, 0.5 * (model.places[3].shape + model.places[4].shape));
    EXPECT_EQ(model.places[5].base, 1.0);
}

TEST(NodeFile, every_mistake_is_named_in_one_line) {
    const Mistake mistakes[] = {
        {"too_few", "shape = [0.1727, ", "shape = [", "structure.mode[1].shape: expected"},
        {"too_many", "shape = [0.1727, ", "shape = [0, 0.1727, ", "mode[1].shape: expected"},
        {"no_shape", "shape = [0.1727, 0.7728, 1.7753, 3.2263, 4.4086]", "",
         "mode[1].shape: missing"},
        {"text", "shape = [0.1727", "shape = [\"a\"", "mode[1].shape: expected"},
        {"still", "shape = [0.1727, 0.7728, 1.7753, 3.2263, 4.4086]", "shape = [0, 0, 0, 0, 0]",
         "mode[1].shape: expected one that moves some node"},
        {"huge", "shape = [0.1727", "shape = [1e7", "mode[1].shape: expected"},
        {"three_points", "shape = [0.1727", "at_force = 1\nshape = [0.1727",
         "mode[1].at_force: unknown key"},
        {"unknown_sensor", "sensor = \"node5\"", "sensor = \"tip\"",
         "structure.sensor: expected one of: node1, node2, node3, node4, node5; found 'tip'"},
        {"unknown_damper", "damper = \"node5\"", "damper = \"ground\"",
         "structure.damper: expected"},
        {"no_force", "force = \"node1\"\n", "", "structure.force: missing"},
        {"twice", "\"node2\"", "\"node1\"", "structure.nodes: expected names that differ"},
        {"ground", "\"node2\"", "\"ground\"", "structure.nodes: expected names that differ"},
        {"bad_name", "\"node2\"", "\"node 2\"", "structure.nodes: expected"},
        {"no_nodes", "nodes = [\"node1\", \"node2\", \"node3\", \"node4\", \"node5\"]\n", "",
         "structure.nodes: missing"},
        {"a_place_of_that_name", "[driver]",
         "[[place]]\nname = \"node3\"\nat = [0, 0, 0, 0, 1]\n[driver]", "place[1].name: expected"},
        {"base_of_a_place", "[driver]",
         "[[place]]\nname = \"p\"\nat = [0, 0, 0, 0, 1]\nbase = 1.0\n[driver]",
         "place[1].base: unknown key"},
    };
    for (const Mistake &mistake : mistakes) {
        SCOPED_TRACE(mistake.name);
        quiesce::expect_message(spoilt(nodes(), mistake), mistake.words, quiesce::load_plant);
    }
}

} // namespace
