/// The [[place]] tables of a plant file.
#ifndef QUIESCE_PLACE_SECTION_H
#define QUIESCE_PLACE_SECTION_H

#include <string>
#include <vector>

#include "place.h"
#include "structure.h"
#include "toml_table.h"

namespace quiesce {

/// 0 .. kMaxPlaces places. Throws InputError naming the key that is wrong.
std::vector<Place> read_places(TomlTable &root, const Structure &structure);

/// A name of letters, digits and _, as boards, places, dampers and sensors have them.
bool is_identifier(const std::string &name);

/// Such a name that is not yet taken.
std::string read_identifier(TomlTable &section, const std::vector<std::string> &taken);

} // namespace quiesce

#endif
