/// Names in files: of a board's bodies, dampers and sensors, and of a plant's places and dampers,
/// which meet by name.
#ifndef QUIESCE_IDENTIFIER_H
#define QUIESCE_IDENTIFIER_H

#include <string>

#include "toml_table.h"

namespace quiesce {

/// Name of what does not move; nothing else may have it.
inline const char *const kGround = "ground";

/// Throws InputError for that key unless name is a letter, then at most 31 letters, digits or _.
void require_identifier(const TomlTable &table, const std::string &key, const std::string &name);

} // namespace quiesce

#endif
