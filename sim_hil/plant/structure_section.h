/// The [structure] section of a plant file: modes at three points, modes over named nodes, or mass,
/// damping and stiffness matrices.
#ifndef QUIESCE_STRUCTURE_SECTION_H
#define QUIESCE_STRUCTURE_SECTION_H

#include <string>
#include <vector>

#include "place.h"
#include "structure.h"
#include "toml_table.h"

namespace quiesce {

struct StructureSection {
    Structure structure;
    /// Stroke that 1 of each mode gives the plant's only damper; empty where dampers have ends.
    Eigen::VectorXd at_damper;
    std::vector<Place> nodes; ///< of modes over nodes; else none
};

/// has_ends: the dampers say where they are, so the structure must not. Throws InputError naming
/// the key, or the file and line, that is wrong.
StructureSection read_structure(TomlTable section, bool has_ends);

} // namespace quiesce

#endif
