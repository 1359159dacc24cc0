/// The [[mount]] tables of a plant file: what is not linear between two of its places.
#ifndef QUIESCE_MOUNTS_SECTION_H
#define QUIESCE_MOUNTS_SECTION_H

#include "plant_model.h"
#include "toml_table.h"

namespace quiesce {

/// Fills model.mounts, 0 .. kMaxMounts; its structure and places must be there. Throws InputError
/// naming the key that is wrong.
void read_mounts(TomlTable &root, PlantModel &model);

} // namespace quiesce

#endif
