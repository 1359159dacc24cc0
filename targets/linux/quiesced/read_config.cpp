#include "read_config.h"

#include <algorithm>
#include <map>

#include "board_fit.h"
#include "names.h"
#include "parameter_section.h"
#include "section.h"
#include "wiring.h"

namespace quiesced {

namespace {

constexpr std::uint32_t kMaxAdxl355Rate_Hz = 4000;
constexpr std::size_t kInterfaceNameBytes = 15; // IFNAMSIZ - 1

void read_loop(Section &section, LoopConfig &loop) {
    section.integer("priority", 0, 99, loop.priority);
    section.integer("cpu", -1, 1023, loop.cpu);
    section.boolean("lock_memory", loop.lock_memory);
}

bool is_interface_name(const std::string &name) {
    const auto is_bad = [](unsigned char c) { return c <= ' ' || c == '/' || c == ':'; };
    return name.size() <= kInterfaceNameBytes && std::none_of(name.begin(), name.end(), is_bad);
}

void check_interface(Section &section, const CanConfig &can) {
    if (can.is_serial() ? can.interface.find("slcan:/") != 0 : !is_interface_name(can.interface)) {
        section.wrong("interface",
                      "expected an interface (\"can0\") or \"slcan:\" and the absolute "
                      "path of a serial line, found \"" +
                          can.interface + "\"");
    }
}

void read_can(Section &section, CanConfig &can) {
    section.text("interface", can.interface, true);
    section.boolean("fd", can.use_fd);
    section.integer("restart_ms", 1, 10000, can.restart_ms);
    section.integer("serial_baud", 0, 4000000, can.serial_baud);
    section.integer("bitrate", 0, 1000000, can.bitrate);
    section.integer("data_bitrate", 0, 10000000, can.data_bitrate);
    if (can.interface.empty()) {
        return;
    }
    check_interface(section, can);
    if (can.is_serial() && can.use_fd) {
        section.wrong("fd", "an SLCAN adapter has no CAN FD; expected false");
    }
    if (!can.is_serial() && section.has("serial_baud")) {
        section.wrong("serial_baud", "only for an SLCAN adapter; 'ip link' sets up an interface");
    }
    if (!can.use_fd && section.has("data_bitrate")) {
        section.wrong("data_bitrate", "only with fd = true");
    }
}

void read_line(Section &gpio, const char *key, std::optional<LineConfig> &line) {
    with_section(gpio, key, false, [&](Section &section) {
        line.emplace();
        section.text("line", line->line, true);
        section.boolean("active_low", line->is_active_low);
        section.choice("bias", {"as-is", "pull-up", "pull-down", "off"}, line->bias);
    });
}

/// The kernel would refuse the second one with a less helpful message. A name and a place may still
/// be the same line.
void check_lines(Section &gpio) {
    std::map<std::string, std::string> users;
    TomlTable table = gpio.table();
    for (const std::string &key : table.keys()) {
        Problems told_before;
        attempt(told_before, [&] {
            const std::string line = table.table(key).text("line");
            const auto [user, is_new] = users.emplace(line, key);
            if (!is_new) {
                gpio.wrong(key.c_str(), "\"" + line + "\" is the line of " + user->second +
                                            "; expected another one");
            }
        });
    }
}

void read_gpio(Section &section, GpioConfig &gpio) {
    read_line(section, "enable_output", gpio.enable_output);
    read_line(section, "fault_output", gpio.fault_output);
    read_line(section, "estop_input", gpio.estop_input);
    read_line(section, "enable_input", gpio.enable_input);
    read_line(section, "data_ready_input", gpio.data_ready_input);
    check_lines(section);
}

bool is_absolute(const std::string &path) {
    return path.front() == '/';
}

void read_state(Section &section, StateConfig &state) {
    section.text("folder", state.folder);
    section.integer("status_s", 1, 3600, state.status_s);
    if (!is_absolute(state.folder)) {
        section.wrong("folder", "expected an absolute path, found \"" + state.folder + "\"");
    }
}

void read_log(Section &section, LogConfig &log) {
    section.text("to", log.to);
    section.choice("level", {"error", "warning", "info", "debug"}, log.level);
    if (log.to != "journal" && log.to != "stderr" && !is_absolute(log.to)) {
        section.wrong("to", "expected \"journal\", \"stderr\" or the absolute path of a file, "
                            "found \"" +
                                log.to + "\"");
    }
}

/// Of what the files hold nothing is known here: --make-safe does without them.
void read_tables(Section &section, Config &config) {
    for (const quiesce_owner_t owner : kOwners) {
        std::string named;
        section.text(owner_name(owner), named);
        config.tables[owner] = named.empty() ? "" : config.beside(named);
    }
}

/// What needs [can] without having it; "": nothing.
std::string bus_user(const Section &root, const Config &config) {
    for (const SensorConfig &sensor : config.sensors) {
        if (root.has(sensor.place.section.c_str()) && sensor.source == SensorSource::can) {
            return sensor.place.key("source");
        }
    }
    for (const OutputConfig &output : config.outputs) {
        if (root.has(output.place.section.c_str()) && output.output == CurrentOutput::can) {
            return output.place.key("output");
        }
    }
    return config.enable_from != NODE_ENABLE_BOARD ? "operator.enable" : "";
}

void check_bus(Section &root, const Config &config) {
    const std::string user = bus_user(root, config);
    if (!user.empty() && !root.has("can")) {
        root.wrong("can", "missing; " + user + " needs a table [can]");
    }
}

/// What is always enabled never has the edge that arms.
void check_operator(Section &root, const Config &config) {
    if (config.enable_from != NODE_ENABLE_CAN && !config.gpio.enable_input) {
        root.wrong("operator",
                   "enable is \"board\" or \"both\", and gpio.enable_input is missing: its "
                   "edge arms the controller");
    }
}

/// As fast as the ticks that it starts. Beside a timer twice as fast, so that each tick finds a new
/// sample.
std::uint32_t default_rate_Hz(const Config &config) {
    const auto tick_rate_Hz = static_cast<std::uint32_t>(config.params.tick_rate_Hz);
    return config.gpio.data_ready_input ? tick_rate_Hz
                                        : std::min(2 * tick_rate_Hz, kMaxAdxl355Rate_Hz);
}

/// The table of the file that is to be mended.
TomlTable table_of(Section &root, const Misfit &misfit) {
    const std::string section = misfit.section;
    const bool is_one_of_many = section == "sensor" || section == "damper";
    return is_one_of_many ? root.table().tables(section)[misfit.table]
                          : root.table().table(section);
}

void check_fit(Section &root, const Config &config) {
    const std::optional<Misfit> misfit = find_misfit(config, config.params);
    if (misfit && root.has(misfit->section)) {
        Section section(table_of(root, *misfit), root.problems());
        section.wrong(misfit->key, misfit->reason.data());
    } else if (misfit) {
        root.wrong(misfit->section, misfit->reason.data());
    }
}

void read_root(Section &root, Needs needs, const std::string &board_file, Config &config) {
    const bool has_peripherals = needs == Needs::peripherals;
    with_section(root, "loop", false, [&](Section &s) { read_loop(s, config.loop); });
    with_section(root, "can", !has_peripherals,
                 [&](Section &s) { read_can(s, config.can.emplace()); });
    read_wiring(root, has_peripherals, board_file, config);
    with_section(root, "gpio", false, [&](Section &s) { read_gpio(s, config.gpio); });
    config.enable_from = config.gpio.enable_input ? NODE_ENABLE_BOARD : NODE_ENABLE_CAN;
    with_section(root, "operator", false, [&](Section &s) {
        s.choice("enable", {"board", "can", "both"}, config.enable_from);
    });
    with_section(root, "watchdog", false, [&](Section &s) {
        s.text("device", config.watchdog.emplace().device, true);
        s.integer("timeout_s", 1, 3600, config.watchdog->timeout_s);
    });
    with_section(root, "state", false, [&](Section &s) { read_state(s, config.state); });
    with_section(root, "log", false, [&](Section &s) { read_log(s, config.log); });
    with_section(root, "tables", false, [&](Section &s) { read_tables(s, config); });
    with_section(root, "parameters", false,
                 [&](Section &s) { config.params = read_parameters(s, has_board(root)); });
    root.end();
    for (SensorConfig &sensor : config.sensors) {
        if (sensor.rate_Hz == 0) {
            sensor.rate_Hz = default_rate_Hz(config);
        }
    }
    if (has_peripherals) {
        check_bus(root, config);
        check_operator(root, config);
    }
    if (has_peripherals && root.problems().empty()) {
        check_fit(root, config);
    }
}

} // namespace

ConfigReading read_config(const std::string &file, Needs needs, const std::string &board_file) {
    ConfigReading out;
    out.config.file = file;
    quiesce_params_default(&out.config.params);
    attempt(out.problems, [&] {
        const quiesce::TomlFile toml(file);
        out.is_toml = true;
        Section root(toml.root(), out.problems);
        read_root(root, needs, board_file, out.config);
    });
    return out;
}

Config require_config(const std::string &file, Needs needs) {
    ConfigReading reading = read_config(file, needs);
    if (!reading.problems.empty()) {
        const std::size_t more = reading.problems.size() - 1;
        throw InputError(reading.problems.front() +
                         (more > 0 ? " (and " + std::to_string(more) + " more: --check)" : ""));
    }
    return std::move(reading.config);
}

} // namespace quiesced
