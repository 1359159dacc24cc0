/// Board files in a build for one sensor, one body and one damper.
#include <gtest/gtest.h>

#include <string>

#include "board_file.h"
#include "file_mistakes.h"

namespace {

using quiesce::expect_message;
using quiesce::load_board;
using quiesce::read;

TEST(SmallBuild, serves_the_published_rig) {
    EXPECT_EQ(load_board("sim_hil/data/boards/squeeze_2012.toml").board.sensors, 1);
}

TEST(SmallBuild, says_what_it_serves) {
    const std::string good = read("sim_hil/data/boards/squeeze_2012.toml");
    const std::size_t damper = good.find("[[damper]]");
    ASSERT_NE(damper, std::string::npos);
    const std::string sensor = "[[sensor]]\nname = \"supply\"\nmeasures = \"supply_voltage\"\n"
                               "scale_mV = 1\nfull_scale_counts = 1000\n";
    expect_message(good + sensor, "sensor: this build serves 1 sensor, found 2", load_board);
    std::string two = good.substr(damper);
    two.replace(two.find("\"damper\""), 8, "\"other\"");
    expect_message(good + two, "damper: this build serves 1 damper, found 2", load_board);
    std::string bodies = good;
    bodies.replace(bodies.find("[\"mass\"]"), 8, "[\"mass\", \"top\"]");
    expect_message(bodies, "bodies: this build serves 1 body, found 2", load_board);
}

} // namespace
