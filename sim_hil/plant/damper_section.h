/// The [damper] section of a plant file: one line in damper_section.cpp adds a model.
#ifndef QUIESCE_DAMPER_SECTION_H
#define QUIESCE_DAMPER_SECTION_H

#include <memory>

#include "damper.h"
#include "toml_table.h"

namespace quiesce {

/// Makes the damper that the section describes. Throws InputError naming the key that is wrong.
std::shared_ptr<const Damper> read_damper(TomlTable section);

} // namespace quiesce

#endif
