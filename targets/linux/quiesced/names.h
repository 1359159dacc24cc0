/// Names of numbers, for logs and the status file.
#ifndef QUIESCED_NAMES_H
#define QUIESCED_NAMES_H

#include <cstdint>

#include "config.h"
#include "firmware.h"

namespace quiesced {

/// "?" for a number that has none.
const char *state_name(std::uint32_t state);
const char *fault_name(std::uint32_t fault);
const char *bus_state_name(can_bus_state_t state);

/// As the configuration has them.
const char *source_name(SensorSource source);
const char *output_name(CurrentOutput output);

/// "0.1.0"
const char *version();

} // namespace quiesced

#endif
