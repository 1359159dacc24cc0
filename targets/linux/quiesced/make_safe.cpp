#include "make_safe.h"

#include <algorithm>
#include <cstdio>

#include "bus.h"
#include "clock.h"
#include "devices.h"
#include "fault_store.h"
#include "input_error.h"
#include "instance_lock.h"
#include "kept_config.h"
#include "read_config.h"
#include "signals.h"
#include "state_store.h"

namespace quiesced {

namespace {

constexpr int kFarewells = 5; // the first may repeat the alive counter that the driver saw last
constexpr int kPause_ms = 5;
constexpr int kPatience_ms = 1000;

void complain(const std::string &line) {
    (void)std::fprintf(stderr, "quiesced: %s\n", line.c_str());
}

/// Returns false, after a line, iff the step failed.
template <typename Step>
bool do_step(Step &&step) {
    try {
        std::forward<Step>(step)();
        return true;
    } catch (const std::exception &error) {
        complain(error.what());
        return false;
    }
}

void release_line(const std::optional<LineConfig> &line, const char *key) {
    if (line) {
        const Line output = open_output(*line, key); // inactive from its request on
        if (!gpio_set(output.get(), false)) {
            throw quiesce::InputError(std::string(key) + ": the kernel refuses to set it");
        }
    }
}

void release_driver(const OutputConfig &config, const SystemFolders &folders,
                    std::int32_t safe_mA) {
    const std::unique_ptr<CurrentDevice> device = open_current(config, folders);
    if (device != nullptr) {
        hal_current_write(&device->handle, safe_mA, false);
        if (device->failures() > 0) {
            throw quiesce::InputError(config.place.title + ": the output cannot be written");
        }
    }
}

void say_farewell(const Config &config, const quiesce_params_t &params) {
    const Bus bus = open_bus(*config.can, BusUse::controller);
    const auto node = std::make_unique<can_node_t>();
    can_node_init(node.get(), config.wiring(), &params);
    std::string note;
    if (FaultStore(config.state.folder).load(note) != QUIESCE_FAULT_NONE) {
        node->freeze.state = QUIESCE_STATE_FAULT;
    }
    for (int i = 0; i < kFarewells; ++i) {
        const auto most = std::min<std::size_t>(config.outputs.size(), QUIESCE_DAMPERS);
        for (std::uint32_t damper = 0; damper < most; ++damper) {
            can_frame_t frame{};
            can_node_farewell(node.get(), damper, safe_current_mA(config.wiring(), &params, damper),
                              &frame);
            if (!send_patiently(bus.get(), frame, kPatience_ms)) {
                throw quiesce::InputError("can.interface: " + config.can->interface +
                                          " does not take the farewell frame; is the bus up?");
            }
        }
        sleep_ms(kPause_ms);
    }
}

/// One that cannot be made safe does not keep the others from it.
bool release_drivers(const Config &config, const quiesce_params_t &params) {
    bool is_safe = true;
    for (std::uint32_t damper = 0; damper < config.outputs.size(); ++damper) {
        is_safe &= do_step([&] {
            release_driver(config.outputs[damper], config.folders,
                           safe_current_mA(config.wiring(), &params, damper));
        });
    }
    return is_safe;
}

bool release_outputs(const Config &config, const quiesce_params_t &params) {
    bool is_safe = true;
    is_safe &= do_step([&] { release_line(config.gpio.enable_output, "gpio.enable_output"); });
    is_safe &= release_drivers(config, params);
    is_safe &= do_step([&] { release_line(config.gpio.fault_output, "gpio.fault_output"); });
    if (config.can) {
        is_safe &= do_step([&] { say_farewell(config, params); });
    }
    return is_safe;
}

quiesce_params_t params_of(const Config &config, const std::string &state_folder) {
    std::string note;
    return StateStore(state_folder).effective(config.params, note);
}

bool has_line(const GpioConfig &gpio, const LineConfig &line) {
    return (gpio.enable_output && gpio.enable_output->line == line.line) ||
           (gpio.fault_output && gpio.fault_output->line == line.line);
}

void drop_lines(const GpioConfig &other, GpioConfig &gpio) {
    if (gpio.enable_output && has_line(other, *gpio.enable_output)) {
        gpio.enable_output.reset();
    }
    if (gpio.fault_output && has_line(other, *gpio.fault_output)) {
        gpio.fault_output.reset();
    }
}

void complain_about(const ConfigReading &reading) {
    for (const std::string &line : reading.problems) {
        complain(line);
    }
}

/// What the last controller ran with.
bool release_kept(const KeptConfig &store, const ConfigReading &kept,
                  const std::string &state_folder) {
    complain_about(kept);
    const auto params = store.load_params();
    return release_outputs(kept.config, params ? *params : params_of(kept.config, state_folder)) &&
           kept.problems.empty();
}

} // namespace

Config other_outputs(const Config &config, const Config &other) {
    Config left = config;
    drop_lines(other.gpio, left.gpio);
    for (OutputConfig &mine : left.outputs) {
        const bool has_it = std::any_of(
            other.outputs.begin(), other.outputs.end(), [&mine](const OutputConfig &theirs) {
                return mine.output == theirs.output && mine.device == theirs.device &&
                       mine.channel == theirs.channel;
            });
        if (has_it) {
            mine.output = CurrentOutput::can; // there is nothing to write
        }
    }
    // The other has told its own dampers only.
    if (config.can && other.can && config.can->interface == other.can->interface &&
        config.outputs.size() <= other.outputs.size()) {
        left.can.reset();
    }
    return left;
}

namespace {

int make_outputs_safe(ConfigReading &today, const std::string &folder,
                      const SystemFolders &folders) {
    today.config.folders = folders;
    complain_about(today);
    const KeptConfig store(folder);
    auto kept = store.load();
    if (kept) {
        kept->config.folders = folders;
    }
    bool is_safe = kept ? release_kept(store, *kept, folder) : today.problems.empty();
    const Config left = kept ? other_outputs(today.config, kept->config) : today.config;
    is_safe &= release_outputs(left, params_of(today.config, folder));
    return is_safe ? 0 : 1;
}

} // namespace

int make_outputs_safe(const std::string &config_file, const std::string &state_folder,
                      const SystemFolders &folders) {
    ConfigReading today = read_config(config_file, Needs::peripherals);
    return make_outputs_safe(today, state_folder, folders);
}

int make_safe(const std::string &config_file, const SystemFolders &folders) {
    install_signals(); // a SIGTERM does not stop it half-way
    ConfigReading today = read_config(config_file, Needs::peripherals);
    const std::string folder = today.is_toml ? today.config.state.folder : fallback_state_folder();
    if (const long pid = InstanceLock::holder(folder); pid != 0) {
        complain("process " + std::to_string(pid) + " controls the outputs; stop it first");
        return 1;
    }
    return make_outputs_safe(today, folder, folders);
}

} // namespace quiesced
