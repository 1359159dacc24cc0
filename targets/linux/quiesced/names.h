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
const char *owner_name(quiesce_owner_t owner); ///< of [tables]

/// "the law's table", .. by road; where it came from; why one is refused.
const char *road_name(std::uint32_t road);
const char *table_source_name(std::uint32_t source);
const char *verdict_text(quiesce_table_verdict_t verdict);
const char *record_state_name(std::uint32_t state); ///< keeper_state_t

/// "0.1.0"
const char *version();

} // namespace quiesced

#endif
