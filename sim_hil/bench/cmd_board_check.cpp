/// board-check: a board file as the controller has it, and what laws would see with it, as JSON.
#include <cstring>
#include <iostream>

#include "arguments.h"
#include "board_crc.h"
#include "board_file.h"
#include "board_keys.h"
#include "commands.h"
#include "firmware.h"
#include "json.h"

namespace quiesce {

namespace {

using Names = std::vector<std::string>;

const char *name_of(const Names &names, std::int32_t number) {
    return names[static_cast<std::size_t>(number)].c_str();
}

const char *body_name(const BoardFile &file, std::int32_t number) {
    return number == QUIESCE_GROUND ? "ground" : name_of(file.bodies, number);
}

template <class Part>
void add_numbers(Json &out, const std::vector<NumberKey<Part>> &keys, const Part &part) {
    for (const NumberKey<Part> &key : keys) {
        out.set(key.key, part.*key.field);
    }
}

Json of_sensor(const BoardFile &file, const quiesce_board_sensor_t &sensor) {
    const Sense &sense = senses()[static_cast<std::size_t>(sensor.sense)];
    switch (sense.owner) {
    case Owner::Body:
        return name_of(file.bodies, sensor.at);
    case Owner::Damper:
        return name_of(file.dampers, sensor.at);
    default:
        return nullptr;
    }
}

Json describe_sensor(const BoardFile &file, std::size_t number) {
    const quiesce_board_sensor_t &sensor = file.board.sensor[number];
    const Sense &sense = senses()[static_cast<std::size_t>(sensor.sense)];
    Json out = {{"name", file.sensors[number]},  {"measures", sense.name},
                {"of", of_sensor(file, sensor)}, {"unit", sense.unit},
                {"sense", sensor.sense},         {"at", sensor.at},
                {"axis", sensor.axis},           {"scale", sensor.scale}};
    add_numbers(out, sensor_keys(), sensor);
    return out;
}

Json describe_damper(const BoardFile &file, std::size_t number) {
    const quiesce_board_damper_t &damper = file.board.damper[number];
    Json out = {{"name", file.dampers[number]},
                {"from", body_name(file, damper.end_a)},
                {"to", body_name(file, damper.end_b)},
                {"end_a", damper.end_a},
                {"end_b", damper.end_b},
                {"measures_current", damper.measures_current}};
    add_numbers(out, damper_keys(), damper);
    return out;
}

template <class Describe>
Json each(const BoardFile &file, std::size_t count, Describe describe) {
    Json out = Json::array();
    for (std::size_t i = 0; i < count; ++i) {
        out.push_back(describe(file, i));
    }
    return out;
}

Json signals(const BoardFile &file) {
    Json out = Json::array();
    quiesce_signal_t signal;
    for (std::uint32_t i = 0; quiesce_provided(&file.board, i, &signal); ++i) {
        out.push_back(told(file, signal));
    }
    return out;
}

void add_law(Json &out, const BoardFile &file, std::int32_t law, const char *name) {
    quiesce_params_t params;
    quiesce_params_default(&params);
    params.law = law;
    quiesce_signal_t missing;
    const bool lacks = quiesce_missing(&file.board, &params, &missing);
    out.set(name, lacks ? Json(told(file, missing)) : Json());
}

/// Of each law: the first signal that it lacks, or null; with the default tracker.
Json laws(const BoardFile &file) {
    Json out = Json::object();
#define LAW(number, name) add_law(out, file, QUIESCE_LAW_##number, #name);
    QUIESCE_EACH_LAW(LAW)
#undef LAW
    return out;
}

/// The whole board, word by word.
std::vector<std::int32_t> words_of(const quiesce_board_t &board) {
    static_assert(sizeof board % sizeof(std::int32_t) == 0, "a board is words");
    std::vector<std::int32_t> words(sizeof board / sizeof(std::int32_t));
    std::memcpy(words.data(), &board, sizeof board);
    return words;
}

} // namespace

int cmd_board_check(const std::vector<std::string> &words) {
    const Arguments arguments("board-check", words, {});
    const BoardFile file = load_board(arguments.only_positional("FILE"));
    const quiesce_board_t &board = file.board;
    const Json out = {{"name", file.name},
                      {"bodies", file.bodies},
                      {"tracked", board.tracked},
                      {"bus_latency_us", board.bus_latency_us},
                      {"sensors", each(file, file.sensors.size(), describe_sensor)},
                      {"dampers", each(file, file.dampers.size(), describe_damper)},
                      {"signals", signals(file)},
                      {"laws", laws(file)},
                      {"crc32", board_crc32(board)},
                      {"words", words_of(board)}};
    std::cout << out.dump(1) << '\n';
    return 0;
}

} // namespace quiesce
