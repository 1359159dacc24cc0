/// What is wired to what, for people: --check prints it.
#ifndef QUIESCED_WIRING_TEXT_H
#define QUIESCED_WIRING_TEXT_H

#include <string>

#include "config.h"

namespace quiesced {

/// A line for the board, each sensor and each damper, and one for the load of the bus.
std::string wiring_text(const Config &config);

} // namespace quiesced

#endif
