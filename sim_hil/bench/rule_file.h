/// Rule tables for the controller, as `quiesce rules compile` writes them.
#ifndef QUIESCE_RULE_FILE_H
#define QUIESCE_RULE_FILE_H

#include <cstdint>
#include <string>
#include <vector>

#include "firmware.h"

namespace quiesce {

/// Words of a file with one hexadecimal number a line. Throws InputError where the file cannot be
/// read, holds anything else or nothing, or where the controller refuses the table.
std::vector<std::uint32_t> load_rules(const std::string &file);

/// Makes a controller use them. Throws InputError where it refuses.
void use_rules(quiesce_t &controller, const std::vector<std::uint32_t> &words);

} // namespace quiesce

#endif
