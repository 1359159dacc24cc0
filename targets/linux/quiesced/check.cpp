#include "check.h"

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <fstream>

#include <unistd.h>

#include "board_fit.h"
#include "devices.h"
#include "fault_store.h"
#include "input_error.h"
#include "instance_lock.h"
#include "line_finder.h"
#include "names.h"
#include "read_config.h"
#include "start_tables.h"
#include "state_store.h"
#include "wiring_text.h"

namespace quiesced {

namespace {

namespace fs = std::filesystem;

void note(const std::string &line) {
    (void)std::printf("note: %s\n", line.c_str());
}

void note_access(const std::string &key, const std::string &path, int mode) {
    if (access(path.c_str(), mode) != 0) {
        note(key + ": " + path + ": " + std::strerror(errno));
    }
}

/// An IIO device by its folder's or its own name.
bool has_iio_device(const std::string &device, const fs::path &root) {
    std::error_code ignored;
    if (fs::exists(root / device, ignored)) {
        return true;
    }
    for (const auto &entry : fs::directory_iterator(root, ignored)) {
        std::string name;
        if (std::getline(std::ifstream(entry.path() / "name"), name) && name == device) {
            return true;
        }
    }
    return false;
}

void note_iio(const std::string &key, const std::string &device, const SystemFolders &folders) {
    if (!has_iio_device(device, folders.iio)) {
        note(key + ": no IIO device \"" + device + "\"");
    }
}

void note_can(const CanConfig &can) {
    if (can.is_serial()) {
        note_access("can.interface", can.interface.substr(std::strlen("slcan:")), R_OK | W_OK);
    } else {
        note_access("can.interface", "/sys/class/net/" + can.interface, F_OK);
    }
}

void note_line(const std::optional<LineConfig> &line, const char *key) {
    const std::string trouble = line ? line_trouble(line->line) : "";
    if (!trouble.empty()) {
        note(std::string(key) + ": \"" + line->line + "\": " + trouble);
    }
}

/// Where the line's pull resistor leads a wire that is broken.
bool is_pulled_active(const LineConfig &line) {
    return line.bias ==
           (line.is_active_low ? gpio_spec_t::GPIO_BIAS_PULL_DOWN : gpio_spec_t::GPIO_BIAS_PULL_UP);
}

/// "as-is" and "off": a resistor of the board, which nobody knows here.
void note_wires(const GpioConfig &gpio) {
    const auto has_pull = [](const LineConfig &line) {
        return line.bias == gpio_spec_t::GPIO_BIAS_PULL_UP ||
               line.bias == gpio_spec_t::GPIO_BIAS_PULL_DOWN;
    };
    if (gpio.estop_input && has_pull(*gpio.estop_input) && !is_pulled_active(*gpio.estop_input)) {
        note("gpio.estop_input: a broken wire reads as not pressed; use a normally closed contact "
             "and a pull to the active level");
    }
    if (gpio.enable_input && is_pulled_active(*gpio.enable_input)) {
        note("gpio.enable_input: a broken wire reads as enabled; use a contact that closes to "
             "enable and a pull to the inactive level");
    }
}

void note_sensor(const SensorConfig &sensor, const SystemFolders &folders) {
    if (sensor.source == SensorSource::iio) {
        note_iio(sensor.place.key("device"), sensor.device, folders);
    } else if (sensor.source == SensorSource::adxl355) {
        note_access(sensor.place.key("device"), sensor.device, R_OK | W_OK);
    }
}

void note_output(const OutputConfig &output, const SystemFolders &folders) {
    if (output.output == CurrentOutput::pwm) {
        note_access(output.place.key("chip"), folders.pwm + "/" + output.device, F_OK);
    } else if (output.output == CurrentOutput::dac) {
        note_iio(output.place.key("device"), output.device, folders);
    }
}

void note_peripherals(const Config &config) {
    for (const SensorConfig &sensor : config.sensors) {
        note_sensor(sensor, config.folders);
    }
    for (const OutputConfig &output : config.outputs) {
        note_output(output, config.folders);
    }
    note_line(config.gpio.enable_output, "gpio.enable_output");
    note_line(config.gpio.fault_output, "gpio.fault_output");
    note_line(config.gpio.estop_input, "gpio.estop_input");
    note_line(config.gpio.enable_input, "gpio.enable_input");
    note_line(config.gpio.data_ready_input, "gpio.data_ready_input");
    note_wires(config.gpio);
    if (config.watchdog) {
        note_access("watchdog.device", config.watchdog->device, W_OK);
    }
}

/// As much as the first start takes.
constexpr std::uintmax_t kRoom_B = 64U << 10U;

/// Why a start would refuse the state folder, or the folder that it is to be made in; "": it would
/// not.
std::string folder_trouble(const std::string &folder) {
    std::error_code error;
    const bool is_there = fs::exists(folder, error);
    const std::string place = is_there ? folder : fs::path(folder).parent_path().string();
    if (is_there && !fs::is_directory(folder, error)) {
        return folder + ": it is no folder";
    }
    if (access(place.c_str(), W_OK | X_OK) != 0) {
        return place + ": " + std::strerror(errno);
    }
    const fs::space_info space = fs::space(place, error);
    const bool has_room = error || space.available >= kRoom_B;
    return has_room ? "" : place + ": " + std::strerror(ENOSPC);
}

void note_state(const Config &config) {
    const std::string &folder = config.state.folder;
    const std::string trouble = folder_trouble(folder);
    if (!trouble.empty()) {
        note("state.folder: " + trouble);
    }
    if (const long pid = InstanceLock::holder(folder); pid != 0) {
        note("quiesced runs now, process " + std::to_string(pid));
    }
    std::string what;
    (void)start_params(config, StateStore(folder), what);
    if (!what.empty()) {
        note(what);
    }
    for (const std::string &line : find_tables(config).notes) {
        note(line);
    }
    (void)FaultStore(folder).load(what);
    if (!what.empty()) {
        note(what);
    }
    if (config.log.to.front() == '/') {
        const bool is_there = fs::exists(config.log.to);
        note_access("log.to",
                    is_there ? config.log.to : fs::path(config.log.to).parent_path().string(),
                    W_OK);
    }
}

void print_tables(const Config &config, const ConfiguredTables &tables) {
    for (const quiesce_owner_t owner : kOwners) {
        const TableWords &words = tables[owner];
        if (!words.empty()) {
            (void)std::printf("%s: %s, %zu words, CRC %08x: %s\n", road_name(owner),
                              quiesce_table_kind(words.front(), nullptr), words.size(),
                              static_cast<unsigned>(crc_of(words)), config.tables[owner].c_str());
        }
    }
}

/// By trying: this process ends afterwards.
void note_rights(const LoopConfig &loop) {
    const tick_thread_options_t options = {loop.priority, loop.cpu, loop.lock_memory};
    linux_error_t error{};
    if (!tick_linux_thread(&options, &error)) {
        note(std::string("loop: ") + error.text);
    }
}

} // namespace

int check(const std::string &config_file) {
    const ConfigReading reading = read_config(config_file, Needs::peripherals);
    for (const std::string &line : reading.problems) {
        (void)std::printf("%s\n", line.c_str());
    }
    if (!reading.problems.empty()) {
        return 2;
    }
    const Config &config = reading.config;
    ConfiguredTables tables;
    try {
        refuse_shared_outputs(config);
        tables = load_tables(config, config.wiring());
        require_fit(tables, config, config.wiring(), config.params);
    } catch (const quiesce::InputError &error) {
        (void)std::printf("%s: %s\n", config_file.c_str(), error.what());
        return 2;
    }
    (void)std::printf("%s: every key is right\n", config_file.c_str());
    (void)std::printf("%s", wiring_text(config).c_str());
    print_tables(config, tables);
    if (config.can) {
        note_can(*config.can);
    }
    note_peripherals(config);
    note_state(config);
    note_rights(config.loop);
    return 0;
}

} // namespace quiesced
