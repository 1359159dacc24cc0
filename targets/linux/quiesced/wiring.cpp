#include "wiring.h"

#include <algorithm>

namespace quiesced {

namespace {

constexpr std::int64_t kMaxCurrent_mA = QUIESCE_HIGHEST_CURRENT_mA;
constexpr std::int64_t kMaxCode = 0xFFFFFF;

using Names = std::vector<std::string>;

// Channels

bool is_channel_part(char c) {
    return (c >= 'a' && c <= 'z') || (c >= '0' && c <= '9') || c == '_' || c == '-';
}

/// "voltage0" of "voltage0" or "in_voltage0_raw".
std::string short_channel(std::string name) {
    const std::string before = "in_";
    const std::string after = "_raw";
    if (name.rfind(before, 0) == 0) {
        name.erase(0, before.size());
    }
    if (name.size() > after.size() && name.substr(name.size() - after.size()) == after) {
        name.resize(name.size() - after.size());
    }
    return name;
}

void read_channel(Section &section, SensorConfig &sensor) {
    section.text("channel", sensor.channel);
    const std::string name = short_channel(sensor.channel);
    if (!std::all_of(name.begin(), name.end(), is_channel_part)) {
        section.wrong("channel",
                      "expected a channel (\"voltage0\" or \"in_voltage0_raw\"), found \"" +
                          sensor.channel + "\"");
    }
    sensor.channel = name;
    for (const char *key : {"use_buffer", "trigger"}) {
        if (!name.empty() && section.has(key)) {
            section.wrong(key, "a channel is read by itself, without buffer and trigger");
        }
    }
}

// One sensor, one output

void read_iio(Section &section, bool has_channel, SensorConfig &sensor) {
    section.text("device", sensor.device, true);
    section.boolean("use_buffer", sensor.use_buffer);
    section.text("trigger", sensor.trigger);
    if (has_channel) {
        read_channel(section, sensor);
    }
}

/// has_channel: it may be another sensor than an accelerometer.
void read_source(Section &section, bool has_channel, SensorConfig &sensor) {
    section.choice("source", {"can", "iio", "adxl355"}, sensor.source, true);
    if (sensor.source == SensorSource::iio) {
        read_iio(section, has_channel, sensor);
    } else if (sensor.source == SensorSource::adxl355) {
        section.text("device", sensor.device, true);
        section.integer("clock_Hz", 100000, 10000000, sensor.clock_Hz);
        section.one_of("range_g", {2, 4, 8}, sensor.range_g);
        section.one_of("rate_Hz", {500, 1000, 2000, 4000}, sensor.rate_Hz);
    }
}

void read_output(Section &section, OutputConfig &output) {
    section.choice("output", {"can", "pwm", "dac"}, output.output, true);
    if (output.output == CurrentOutput::can) {
        return;
    }
    const bool is_pwm = output.output == CurrentOutput::pwm;
    section.text(is_pwm ? "chip" : "device", output.device, true);
    if (output.device.find('/') != std::string::npos) {
        section.wrong(is_pwm ? "chip" : "device",
                      "expected a name without '/'; found '" + output.device + "'");
    }
    section.integer("channel", 0, 63, output.channel);
    section.integer("full_scale_mA", 1, kMaxCurrent_mA, output.full_scale_mA, true);
    if (is_pwm) {
        section.integer("period_ns", 1000, 1000000000, output.period_ns, true);
        section.boolean("is_inverted", output.is_inverted);
        return;
    }
    section.integer("zero_code", -kMaxCode, kMaxCode, output.zero_code, true);
    section.integer("full_scale_code", -kMaxCode, kMaxCode, output.full_scale_code, true);
    if (section.has("full_scale_code") && output.zero_code == output.full_scale_code) {
        section.wrong("full_scale_code", "expected another code than zero_code");
    }
}

// Tables by the names of the board

std::string listed(const Names &names) {
    std::string out;
    for (const std::string &name : names) {
        out += (out.empty() ? "" : ", ") + name;
    }
    return out;
}

/// The number of a part on the board, from the names there; none, and told, where it has none or
/// another table has it.
template <typename Part>
std::optional<std::size_t> settle(Section &section, const Names &names, const Part &part,
                                  const std::vector<Part> &parts) {
    const Place &place = part.place;
    if (place.name.empty()) { // told already
        return std::nullopt;
    }
    const auto found = std::find(names.begin(), names.end(), place.name);
    const auto number = static_cast<std::size_t>(found - names.begin());
    if (found == names.end()) {
        section.wrong("name", "the board has no " + place.section + " \"" + place.name +
                                  "\"; expected one of: " + listed(names));
        return std::nullopt;
    }
    if (!parts[number].place.name.empty()) {
        section.wrong("name", "\"" + place.name + "\" has a table before this one");
        return std::nullopt;
    }
    return number;
}

/// One table for each name, in the order of the names, then those that belong to none: wrong, and
/// still to be made safe. read: the keys of one; check: of one that is settled.
template <typename Part, typename Read, typename Check>
std::vector<Part> read_parts(Section &root, const char *name, const Names &names, Read &&read,
                             Check &&check) {
    std::vector<Part> parts(names.size());
    for (Part &part : parts) {
        part.place = {name, 0, "", ""};
    }
    std::vector<Part> strays;
    std::size_t table = 0;
    root.read(name, false, [&] {
        for (TomlTable &one : root.table().tables(name)) {
            Section section(one, root.problems());
            Part part;
            part.place = {name, table++, "", ""};
            section.text("name", part.place.name, true);
            part.place.title = std::string(name) + " " + part.place.name;
            read(section, part);
            section.end();
            const auto number = settle(section, names, part, parts);
            if (number) {
                check(section, part, *number);
                parts[*number] = part;
            } else {
                strays.push_back(part);
            }
        }
    });
    for (std::size_t i = 0; i < names.size(); ++i) {
        if (parts[i].place.name.empty()) {
            root.wrong(name, "the board's " + std::string(name) + " \"" + names[i] +
                                 "\" has no table [[" + name + "]]");
        }
    }
    parts.insert(parts.end(), strays.begin(), strays.end());
    return parts;
}

// What does not go with the board, or with each other

void check_source(Section &section, const SensorConfig &sensor,
                  const quiesce_board_sensor_t &wired) {
    if (wired.sense == QUIESCE_SENSE_ACCEL || sensor.source == SensorSource::can) {
        return;
    }
    if (sensor.source == SensorSource::adxl355) {
        section.wrong("source", "the board's " + sensor.place.name +
                                    " measures no acceleration; expected can or iio");
    } else if (sensor.channel.empty()) {
        section.wrong("channel", "missing; the board's " + sensor.place.name +
                                     " measures no acceleration: name its channel (\"voltage0\")");
    }
}

void check_output(Section &section, const OutputConfig &output,
                  const quiesce_board_damper_t &wired) {
    if (output.output != CurrentOutput::can && section.has("full_scale_mA") &&
        output.full_scale_mA < wired.ceiling_mA) {
        section.wrong("full_scale_mA", "found " + std::to_string(output.full_scale_mA) +
                                           ", the board's ceiling_mA is " +
                                           std::to_string(wired.ceiling_mA) +
                                           "; the output must be able to give it");
    }
}

bool is_same_device(const SensorConfig &a, const SensorConfig &b) {
    const bool is_shared = a.source == SensorSource::iio && (!a.channel.empty() || !a.use_buffer) &&
                           (!b.channel.empty() || !b.use_buffer) && // single reads
                           (a.channel != b.channel || a.channel.empty());
    return a.source == b.source && a.source != SensorSource::can && a.device == b.device &&
           !a.device.empty() && !is_shared;
}

bool is_same_device(const OutputConfig &a, const OutputConfig &b) {
    return a.output == b.output && a.output != CurrentOutput::can && a.device == b.device &&
           !a.device.empty() && a.channel == b.channel;
}

/// Each needs a device of its own; of a sensor single reads of one may be several's.
template <typename Part>
void check_devices(Section &root, const std::vector<Part> &parts) {
    for (std::size_t i = 1; i < parts.size(); ++i) {
        for (std::size_t k = 0; k < i; ++k) {
            if (is_same_device(parts[i], parts[k])) {
                const Place &place = parts[i].place;
                root.wrong(place.section.c_str(), place.name + " has the device of " +
                                                      parts[k].place.name +
                                                      "; expected one of its own");
            }
        }
    }
}

// Board

/// Told now, so that the control loop does not have to make a text.
std::vector<std::string> missing_signals(const quiesce::BoardFile &board, std::int32_t law) {
    std::vector<std::string> out;
    quiesce_params_t params{};
    quiesce_params_default(&params);
    params.law = law;
    for (params.tracker = 0; quiesce_params_check(&params, nullptr); ++params.tracker) {
        quiesce_signal_t signal{};
        const bool is_missing = quiesce_missing(&board.board, &params, &signal);
        out.push_back(is_missing ? quiesce::told(board, signal) : "");
    }
    return out;
}

std::vector<std::vector<std::string>> missing_signals(const quiesce::BoardFile &board) {
    std::vector<std::vector<std::string>> out;
    for (std::int32_t law = 0; quiesce_report_words(law) != nullptr; ++law) {
        out.push_back(missing_signals(board, law));
    }
    return out;
}

void read_board(Section &root, const std::string &board_file, Config &config) {
    root.read("board", true, [&] {
        Section section(root.table().table("board"), root.problems());
        std::string file;
        section.text("file", file, true);
        section.end();
        if (!file.empty()) {
            file = board_file.empty() ? config.beside(file) : board_file;
            quiesce::BoardFile board = quiesce::load_board(file);
            auto missing = missing_signals(board);
            config.board = {file, std::move(board), std::move(missing)};
        }
    });
}

/// Without knowing the board its outputs are still made safe: at most as many as there may be.
Names names_in(Section &root, const char *name, std::size_t most) {
    Names names;
    attempt(root.problems(), [&] {
        for (TomlTable &one : root.table().tables(name)) {
            attempt(root.problems(), [&] { names.push_back(one.text("name")); });
        }
    });
    names.resize(std::min(names.size(), most));
    return names;
}

void read_of_board(Section &root, const std::string &board_file, Config &config) {
    read_board(root, board_file, config);
    const quiesce_board_t *wired = config.wiring();
    for (const char *key : {"accel", "current"}) {
        root.table().accept(key);
        if (root.has(key)) {
            root.wrong(key,
                       "not with a board, whose sensors and dampers have tables [[sensor]] and "
                       "[[damper]]");
        }
    }
    const Names sensors =
        wired != nullptr ? config.board->board.sensors : names_in(root, "sensor", QUIESCE_SENSORS);
    config.sensors = read_parts<SensorConfig>(
        root, "sensor", sensors,
        [](Section &section, SensorConfig &sensor) { read_source(section, true, sensor); },
        [&](Section &section, const SensorConfig &sensor, std::size_t number) {
            if (wired != nullptr) {
                check_source(section, sensor, wired->sensor[number]);
            }
        });
    config.sensors.resize(sensors.size()); // one that belongs to none is of no use
    config.outputs = read_parts<OutputConfig>(
        root, "damper",
        wired != nullptr ? config.board->board.dampers : names_in(root, "damper", QUIESCE_DAMPERS),
        read_output, [&](Section &section, const OutputConfig &output, std::size_t number) {
            if (wired != nullptr) {
                check_output(section, output, wired->damper[number]);
            }
        });
    check_devices(root, config.sensors);
    check_devices(root, config.outputs);
}

/// One sensor, one output.
void read_alone(Section &root, bool is_required, Config &config) {
    with_section(root, "accel", is_required,
                 [&](Section &section) { read_source(section, false, config.sensors.front()); });
    with_section(root, "current", is_required,
                 [&](Section &section) { read_output(section, config.outputs.front()); });
}

} // namespace

bool has_board(const Section &root) {
    return root.has("board");
}

void read_wiring(Section &root, bool is_required, const std::string &board_file, Config &config) {
    if (has_board(root)) {
        read_of_board(root, board_file, config);
    } else {
        read_alone(root, is_required, config);
    }
}

} // namespace quiesced
