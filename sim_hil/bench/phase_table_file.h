/// Tables of pulses for law phase, as `quiesce tune` writes them.
#ifndef QUIESCE_PHASE_TABLE_FILE_H
#define QUIESCE_PHASE_TABLE_FILE_H

#include <cstdint>
#include <string>
#include <vector>

#include "firmware.h"

namespace quiesce {

/// Words of a binary file, little-endian. Throws InputError where the file cannot be read, does not
/// hold whole words, or where the controller refuses the table.
std::vector<std::uint32_t> load_phase_table(const std::string &file);

/// Makes a controller use them. Throws InputError where it refuses.
void use_phase_table(quiesce_t &controller, const std::vector<std::uint32_t> &words);

} // namespace quiesce

#endif
