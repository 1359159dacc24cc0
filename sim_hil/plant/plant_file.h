/// Plant files: TOML, schema "quiesce-plant" version 1. docs/howto/describe-a-plant.md has the
/// table of keys.
#ifndef QUIESCE_PLANT_FILE_H
#define QUIESCE_PLANT_FILE_H

#include <string>

#include "plant_model.h"

namespace quiesce {

/// Throws InputError naming file, line, key, what is wrong and what is allowed.
PlantModel load_plant(const std::string &file);

} // namespace quiesce

#endif
