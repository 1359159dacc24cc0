/// [thermal] of damper files and of a plant's damper: what the fluid's heat does
/// (docs/reference/damper-models.md).
#ifndef QUIESCE_THERMAL_SECTION_H
#define QUIESCE_THERMAL_SECTION_H

#include <optional>

#include "fluid_law.h"
#include "toml_table.h"
#include "warm_damper.h"

namespace quiesce {

struct Thermal {
    HeatParams heat;
    FluidLaw law;
};

/// The table `thermal` of a damper's section, if it has one. Throws InputError naming the key that
/// is wrong.
std::optional<Thermal> read_thermal(TomlTable &section);

/// Throws InputError where the law changes a force that the model does not have.
void require_followed(TomlTable &section, const FluidLaw &law, bool has_viscous, bool has_yielding);

} // namespace quiesce

#endif
