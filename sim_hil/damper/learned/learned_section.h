/// Learned models in files: what the keys of [parameters] mean
/// (docs/explanation/learned-dampers.md).
#ifndef QUIESCE_LEARNED_SECTION_H
#define QUIESCE_LEARNED_SECTION_H

#include <memory>
#include <vector>

#include "damper.h"
#include "toml_table.h"

namespace quiesce {

/// Where a model ends: at -stroke_m, and at the largest speed that is expected. Both > 0.
struct MotionLimits {
    double stroke_m;
    double speed_m_s;
};

/// Any damper, by the `model` and keys of a table: what a learned model may stand on.
using ReadDamper = std::shared_ptr<const Damper> (*)(TomlTable &section);

/// What a model is told beside its keys.
struct LearnedContext {
    MotionLimits limits;
    ReadDamper read_damper;
};

struct LearnedModel {
    const char *name;
    /// keys: [parameters]. Throws InputError naming the key that is wrong.
    std::shared_ptr<const Damper> (*read)(TomlTable &keys, const LearnedContext &context);
};

/// Sorted by name.
const std::vector<LearnedModel> &learned_models();

} // namespace quiesce

#endif
