/// Parameters that the controller accepts and the configured board cannot do.
#ifndef QUIESCED_BOARD_FIT_H
#define QUIESCED_BOARD_FIT_H

#include <array>
#include <optional>
#include <string>

#include "config.h"
#include "state_store.h"

namespace quiesced {

struct Misfit {
    std::uint32_t index;            ///< of the parameter
    const char *section;            ///< of the configuration that it does not fit; lives as long
    std::size_t table;              ///< which of its tables
    const char *key;                ///< there
    std::array<char, 240> reason{}; ///< one line
};

/// A law that needs a signal which no sensor of the board provides; ticks that the sensor which
/// starts them does not have; a current beyond the output; a bus too full. Allocates nothing.
std::optional<Misfit> find_misfit(const Config &config, const quiesce_params_t &params);

/// The parameters to start with: those that were saved where they are used (StateStore::effective)
/// and fit, else those of the configuration. note: a line for the log, or empty.
quiesce_params_t start_params(const Config &config, const StateStore &store, std::string &note);

} // namespace quiesced

#endif
