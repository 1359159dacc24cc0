/// The [structure] section of a plant file: modes, or mass, damping and stiffness matrices.
#ifndef QUIESCE_STRUCTURE_SECTION_H
#define QUIESCE_STRUCTURE_SECTION_H

#include "structure.h"
#include "toml_table.h"

namespace quiesce {

/// Throws InputError naming the key that is wrong.
Structure read_structure(TomlTable section);

} // namespace quiesce

#endif
