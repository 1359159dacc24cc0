#include "options.h"

#include <map>

#include "input_error.h"

namespace quiesced {

const char *const kUsage =
    "usage: quiesced [--config FILE] [--ticks N]\n"
    "       quiesced [--config FILE] --check | --make-safe | --clear-fault | --lockstep\n"
    "\n"
    "Runs the vibration controller on this machine's peripherals and CAN bus.\n"
    "\n"
    "  --config FILE  configuration; otherwise /etc/quiesced/quiesced.toml\n"
    "  --check        explain what is wrong with the configuration, touch nothing\n"
    "  --make-safe    bring every output to its safe state, then end\n"
    "  --clear-fault  forget the latched fault that a stopped controller has left\n"
    "  --lockstep     serve a bench on the CAN bus, tick by tick, without peripherals\n"
    "  --ticks N      end after N control ticks\n"
    "  --version, --help\n"
    "\n"
    "SIGTERM and SIGINT end it, SIGHUP rereads [parameters] and [tables],\n"
    "SIGUSR1 writes the status file.\n"
    "Exit code: 0, 1 where --make-safe could not do all, 2 where it cannot start or the\n"
    "configuration is wrong.\n";

namespace {

const std::map<std::string, Mode> kModes = {
    {"--check", Mode::check},
    {"--make-safe", Mode::make_safe},
    {"--clear-fault", Mode::clear_fault},
    {"--lockstep", Mode::lockstep},
    {"--version", Mode::version},
    {"--help", Mode::help},
    {"-h", Mode::help},
};

std::uint64_t parse_ticks(const std::string &text) {
    constexpr std::size_t most_digits = 18;
    if (text.empty() || text.size() > most_digits ||
        text.find_first_not_of("0123456789") != std::string::npos || std::stoull(text) == 0) {
        throw quiesce::InputError("--ticks expects a number from 1 on, found \"" + text + "\"");
    }
    return std::stoull(text);
}

void set_mode(Options &options, const std::string &argument, Mode mode) {
    if (options.mode != Mode::run && options.mode != mode) {
        throw quiesce::InputError(argument + " does not go with another mode; see --help");
    }
    options.mode = mode;
}

} // namespace

Options parse_options(const std::vector<std::string> &arguments) {
    Options options;
    for (std::size_t i = 0; i < arguments.size(); ++i) {
        const std::string &argument = arguments[i];
        if (const auto mode = kModes.find(argument); mode != kModes.end()) {
            set_mode(options, argument, mode->second);
            continue;
        }
        if (argument != "--config" && argument != "--ticks") {
            throw quiesce::InputError("unknown argument \"" + argument + "\"; see --help");
        }
        if (i + 1 == arguments.size() || arguments[i + 1].empty()) {
            throw quiesce::InputError(argument + " expects a value; see --help");
        }
        const std::string &value = arguments[++i];
        if (argument == "--config") {
            options.config_file = value;
        } else {
            options.ticks = parse_ticks(value);
        }
    }
    if (options.ticks > 0 && options.mode != Mode::run) {
        throw quiesce::InputError("--ticks goes with no other mode; see --help");
    }
    return options;
}

} // namespace quiesced
