/// Reads the configuration of the controller program: one TOML file.
#ifndef QUIESCED_READ_CONFIG_H
#define QUIESCED_READ_CONFIG_H

#include <string>
#include <vector>

#include "config.h"

namespace quiesced {

/// What a mode needs of the file: the lock-step server has no peripherals.
enum class Needs { peripherals, bus_only };

/// A file as far as it could be read, and every line that says what is wrong with it.
struct ConfigReading {
    Config config;
    bool is_toml = false; ///< else nothing could be read
    std::vector<std::string> problems;
};

/// Never throws for what a file may contain. board_file: instead of the one that it names, "":
/// that.
ConfigReading read_config(const std::string &file, Needs needs, const std::string &board_file = "");

/// The same, for programs that cannot go on with a wrong one. Throws InputError: the first line,
/// and how many more there are.
Config require_config(const std::string &file, Needs needs);

} // namespace quiesced

#endif
