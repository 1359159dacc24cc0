/// The controller itself: everything opened, the loop, everything closed.
#ifndef QUIESCED_RUN_H
#define QUIESCED_RUN_H

#include <cstdint>
#include <string>

namespace quiesced {

/// Returns 0 after a stop was requested or the ticks (0: no end) are done. Throws InputError where
/// it cannot start; nothing is switched on then.
int run_controller(const std::string &config_file, std::uint64_t ticks);

} // namespace quiesced

#endif
