/// Dampers in files: the [damper] section of a plant file and damper files (schema quiesce-damper).
/// A kernel is found by its name (kernel_models.h), a learned model likewise (learned_section.h);
/// one line in damper_section.cpp adds a model of another kind.
#ifndef QUIESCE_DAMPER_SECTION_H
#define QUIESCE_DAMPER_SECTION_H

#include <memory>
#include <optional>
#include <string>

#include "coil.h"
#include "damper.h"
#include "toml_table.h"

namespace quiesce {

/// A damper and, where its file says so, the lag that was identified with it.
struct DamperChoice {
    std::shared_ptr<const Damper> damper;
    std::optional<CoilParams> coil;
    /// Up to which its file says that it holds: A, or V where the command is a voltage.
    std::optional<double> max_current_A;
    bool is_in_volts = false;
    bool is_warmed_by_coil = false; ///< [thermal] has a coil_ohm
    bool is_usable = true;          ///< false: published, but of no use (its file says why)
};

/// The damper that a table of a plant describes, either by `model` and its keys or by `file`, a
/// path from its own folder. Models that ask for the acceleration get an estimate of it.
/// Throws InputError naming the key that is wrong.
DamperChoice read_damper(TomlTable section);

/// The same from a damper file, as it is: without the estimate.
DamperChoice load_damper(const std::string &file);

/// `model` and its keys in any table; other keys are left to the caller.
std::shared_ptr<const Damper> read_damper_model(TomlTable &section);

/// Lag of coil and driver, and remanence: [coil] of plants and dampers.
CoilParams read_coil(TomlTable section);

} // namespace quiesce

#endif
