/// The program's command line.
#ifndef QUIESCED_OPTIONS_H
#define QUIESCED_OPTIONS_H

#include <cstdint>
#include <string>
#include <vector>

namespace quiesced {

enum class Mode { run, check, make_safe, clear_fault, lockstep, version, help };

struct Options {
    Mode mode = Mode::run;
    std::string config_file = "/etc/quiesced/quiesced.toml";
    std::uint64_t ticks = 0; ///< of mode run; 0: no end
};

/// Throws InputError for what it does not know.
Options parse_options(const std::vector<std::string> &arguments);

extern const char *const kUsage;

} // namespace quiesced

#endif
