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

/// What 1 of each mode gives the stroke between the keys a and b, places or the ground; the model's
/// structure and places must be there. Throws InputError naming the key that is wrong.
Eigen::VectorXd read_stroke(TomlTable &section, const PlantModel &model);

/// Fills model.dampers; its structure, places and driver must be there. at_damper: the stroke of
/// [damper]. Throws InputError naming the key that is wrong.
void read_dampers(TomlTable &root, const Eigen::VectorXd &at_damper, PlantModel &model);

} // namespace quiesce

#endif
