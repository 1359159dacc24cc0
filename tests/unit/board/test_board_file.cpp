/// Board files: what is read, and what every mistake of boards.toml is answered with.
#include "board_file.h"

#include <gtest/gtest.h>

#include <cstring>
#include <filesystem>
#include <string>
#include <vector>

#include <toml++/toml.h>

#include "board_keys.h"
#include "file_mistakes.h"
#include "input_error.h"

namespace {

using quiesce::BoardFile;
using quiesce::expect_message;
using quiesce::InputError;
using quiesce::load_board;
using quiesce::read;
using quiesce::TemporaryFile;

const char *const kEveryKey = "tools/benchmarks/quiesce_benchmarks/controller/every_key.toml";
const char *const kMistakes = "tools/benchmarks/quiesce_benchmarks/controller/boards.toml";
const char *const kDefault = "sim_hil/data/boards/squeeze_2012.toml";
const char *const kTwoStoreys = "sim_hil/data/boards/two_storeys.toml";

/// A good text with its only `from` replaced.
std::string spoilt(const std::string &good, const std::string &from, const std::string &to) {
    const std::size_t at = good.find(from);
    EXPECT_NE(at, std::string::npos) << "the good file lost: " << from;
    EXPECT_EQ(good.find(from, at + 1), std::string::npos) << "more than once: " << from;
    return good.substr(0, at) + to + good.substr(at + from.size());
}

TEST(BoardFile, every_mistake_is_named_in_one_line) {
    const std::string good = read(kEveryKey);
    const toml::table mistakes = toml::parse_file(kMistakes);
    ASSERT_GE(mistakes["cases"].as_table()->size(), 120u);
    for (const auto &[name, node] : *mistakes["cases"].as_table()) {
        SCOPED_TRACE(std::string(name.str()));
        const auto text = [&node = node](std::size_t i) {
            return node.as_array()->get(i)->value<std::string>().value();
        };
        expect_message(spoilt(good, text(0), text(1)), text(2), load_board);
    }
}

/// Accepted, or refused in one line that begins with the file.
void expect_sane(const std::string &text) {
    const TemporaryFile file(text);
    try {
        const BoardFile board = load_board(file.path());
        EXPECT_TRUE(quiesce_board_check(&board.board, nullptr));
    } catch (const InputError &error) {
        const std::string message = error.what();
        EXPECT_EQ(message.rfind(file.path() + ":", 0), 0u) << message;
        EXPECT_EQ(message.find('\n'), std::string::npos) << message;
    }
}

TEST(BoardFile, no_damage_of_one_byte_or_line_is_too_much) {
    const std::string good = read(kEveryKey);
    const std::string bytes("\0\n\r\"[]=.-9a\x80\xff", 13);
    for (std::size_t i = 0; i < good.size(); ++i) {
        std::string damaged = good;
        damaged[i] = bytes[i % bytes.size()];
        expect_sane(damaged);
        expect_sane(good.substr(0, i));
        if (good[i] == '\n') {
            const std::size_t end = good.find('\n', i + 1);
            expect_sane(good.substr(0, i) + (end == std::string::npos ? "" : good.substr(end)));
        }
    }
}

void expect_same(const quiesce_board_t &a, const quiesce_board_t &b) {
    EXPECT_EQ(std::memcmp(&a, &b, sizeof a), 0);
}

TEST(BoardFile, the_published_rig_is_the_default_board) {
    quiesce_board_t expected;
    quiesce_board_default(&expected);
    const BoardFile file = load_board(kDefault);
    expect_same(file.board, expected);
    EXPECT_EQ(file.name, "squeeze_2012");
    EXPECT_EQ(file.bodies, std::vector<std::string>{"mass"});
}

TEST(BoardFile, what_is_left_out_has_the_default) {
    quiesce_board_t expected;
    quiesce_board_default(&expected);
    const quiesce_board_sensor_t accelerometer = expected.sensor[0];
    const quiesce_board_damper_t damper = expected.damper[0];
    expected.sensors = 3;
    expected.bodies = 2;
    expected.dampers = 2;
    expected.tracked = 1;
    expected.sensor[1] = expected.sensor[2] = accelerometer;
    expected.sensor[1].at = 1;
    expected.sensor[2].sense = QUIESCE_SENSE_STROKE;
    expected.sensor[2].at = 1;
    expected.sensor[2].scale = 1000000;
    expected.sensor[2].full_scale_counts = 32767;
    expected.damper[1] = damper;
    for (int i = 0; i < 2; ++i) {
        expected.damper[i].ceiling_mA = expected.damper[i].continuous_mA = 2000;
    }
    expected.damper[1].end_a = 1;
    expected.damper[1].end_b = 0;
    expect_same(load_board(kTwoStoreys).board, expected);
}

TEST(BoardFile, every_key_reaches_its_field) {
    quiesce_board_t expected = {};
    expected.sensors = 5;
    expected.bodies = 2;
    expected.dampers = 2;
    expected.tracked = 1;
    expected.bus_latency_us = 500;
    expected.sensor[0] = {
        QUIESCE_SENSE_ACCEL, 0, 0, -1, 57751, 12, 8388607, 4000, 20000, 300000, 3, 40, 1500, 250};
    expected.sensor[1] = {
        QUIESCE_SENSE_ACCEL, 1, 2, 1, 60000, 0, 524287, 0, 10000, 250000, 0, 50, 0, 0};
    expected.sensor[2] = {
        QUIESCE_SENSE_STROKE, 1, 2, 1, 1000000, 0, 32767, 0, 10000, 250000, 0, 50, 0, 0};
    expected.sensor[3] = {
        QUIESCE_SENSE_SUPPLY, 0, 2, 1, 12500, 0, 4095, 0, 10000, 250000, 0, 50, 0, 0};
    expected.sensor[4] = {
        QUIESCE_SENSE_VOLTAGE, 0, 2, 1, 10000, 0, 4095, 0, 10000, 250000, 0, 50, 0, 0};
    expected.damper[0] = {0, QUIESCE_GROUND, 2000, 100, 1500, 45, 2500, 1000, 1, 6000, 2200};
    expected.damper[1] = {1, 0, 1800, 0, 1800, 60, 0, 0, 0, 5000, 0};
    const BoardFile file = load_board(kEveryKey);
    expect_same(file.board, expected);
    const std::vector<std::string> sensors = {"floor_accel", "roof_accel", "upper_stroke", "supply",
                                              "lower_voltage"};
    EXPECT_EQ(file.sensors, sensors);
    EXPECT_EQ(file.dampers, (std::vector<std::string>{"lower", "upper"}));
}

/// A board whose sensor measures this; the first one is an accelerometer.
std::string with_sense(const quiesce::Sense &sense) {
    const std::string of = sense.owner == quiesce::Owner::Body     ? "of = \"roof\"\n"
                           : sense.owner == quiesce::Owner::Damper ? "of = \"upper\"\n"
                                                                   : "";
    return spoilt(read(kTwoStoreys), "[[damper]]\nname = \"lower\"",
                  "[[sensor]]\nname = \"added\"\nmeasures = \"" + std::string(sense.name) + "\"\n" +
                      of + sense.scale_key +
                      " = 0.25\nfull_scale_counts = 1000\n[[damper]]\nname = \"lower\"");
}

TEST(BoardFile, each_kind_of_sensor_has_its_number_and_place) {
    ASSERT_EQ(quiesce::senses().size(), static_cast<std::size_t>(QUIESCE_SENSES));
    for (std::size_t i = 0; i < quiesce::senses().size(); ++i) {
        const quiesce::Sense &sense = quiesce::senses()[i];
        SCOPED_TRACE(sense.name);
        if (i == QUIESCE_SENSE_ACCEL || i == QUIESCE_SENSE_STROKE) {
            continue; // in the files above
        }
        const TemporaryFile text(with_sense(sense));
        const quiesce_board_sensor_t sensor = load_board(text.path()).board.sensor[3];
        EXPECT_EQ(sensor.sense, static_cast<std::int32_t>(i));
        EXPECT_EQ(sensor.at, sense.owner == quiesce::Owner::Board ? 0 : 1);
        EXPECT_EQ(sensor.scale, 250);
    }
}

TEST(BoardFile, a_scale_is_rounded_to_a_thousandth) {
    const std::string good = read(kTwoStoreys);
    const TemporaryFile file(spoilt(good, "scale_nm = 1000.0", "scale_nm = 57.7506"));
    EXPECT_EQ(load_board(file.path()).board.sensor[2].scale, 57751);
}

TEST(BoardFile, line_ends_of_other_systems_are_read) {
    std::string text = read(kTwoStoreys);
    for (std::size_t at = 0; (at = text.find('\n', at)) != std::string::npos; at += 2) {
        text.insert(at, "\r");
    }
    const TemporaryFile file(text);
    expect_same(load_board(file.path()).board, load_board(kTwoStoreys).board);
}

TEST(BoardFile, missing_file_and_folder_are_told) {
    const std::string folder = std::filesystem::temp_directory_path().string();
    for (const auto &[file, words] :
         {std::pair<std::string, const char *>{"none.toml", "cannot be read"},
          {folder, "is a folder, not a file"}}) {
        try {
            load_board(file);
            FAIL() << "accepted: " << file;
        } catch (const InputError &error) {
            EXPECT_EQ(std::string(error.what()).rfind(file + ": ", 0), 0u) << error.what();
            EXPECT_NE(std::string(error.what()).find(words), std::string::npos) << error.what();
        }
    }
}

TEST(BoardFile, signals_are_told_by_the_names_of_the_file) {
    const BoardFile file = load_board(kTwoStoreys);
    EXPECT_EQ(quiesce::told(file, {"velocity", 1}), "velocity of roof");
    EXPECT_EQ(quiesce::told(file, {"stroke velocity", 1}), "stroke velocity of upper");
    EXPECT_EQ(quiesce::told(file, {"supply voltage", -1}), "supply voltage");
}

} // namespace
