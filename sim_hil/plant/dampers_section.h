/// The dampers of a plant file: [damper], the only one, or 1 .. kMaxDampers tables [[damper]]
/// between places.
#ifndef QUIESCE_DAMPERS_SECTION_H
#define QUIESCE_DAMPERS_SECTION_H

#include <string>

#include "plant_model.h"
#include "toml_table.h"

namespace quiesce {

/// The file has [[damper]]: dampers with names and ends.
bool has_damper_ends(const TomlTable &root);

/// Fills model.dampers; its structure, places and driver must be there. at_damper: the stroke of
/// [damper]. Throws InputError naming the key that is wrong.
void read_dampers(TomlTable &root, const std::string &plant_file, const Eigen::VectorXd &at_damper,
                  PlantModel &model);

} // namespace quiesce

#endif
