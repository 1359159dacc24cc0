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
    const char *section;            ///< of the configuration that it does not fit
    const char *key;                ///< there
    std::array<char, 160> reason{}; ///< one line
};

/// Allocates nothing.
std::optional<Misfit> find_misfit(const Config &config, const quiesce_params_t &params);

/// The parameters to start with: those that were saved where they are used (StateStore::effective)
/// and fit, else those of the configuration. note: a line for the log, or empty.
quiesce_params_t start_params(const Config &config, const StateStore &store, std::string &note);

} // namespace quiesced

#endif
