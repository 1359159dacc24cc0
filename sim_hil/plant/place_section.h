/// The [[place]] tables of a plant file.
#ifndef QUIESCE_PLACE_SECTION_H
#define QUIESCE_PLACE_SECTION_H

#include <string>
#include <vector>

#include "place.h"
#include "structure.h"
#include "toml_table.h"

namespace quiesce {

/// The structure's nodes, then 0 .. kMaxPlaces places. Throws InputError naming the key that is
/// wrong.
std::vector<Place> read_places(TomlTable &root, const Structure &structure,
                               std::vector<Place> nodes);

/// The name of a place or damper, which is not yet taken.
std::string read_name(TomlTable &section, const std::vector<std::string> &taken);

} // namespace quiesce

#endif
