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

struct LearnedModel {
    const char *name;
    /// keys: [parameters]. Throws InputError naming the key that is wrong.
    std::shared_ptr<const Damper> (*read)(TomlTable &keys, const MotionLimits &limits);
};

/// Sorted by name.
const std::vector<LearnedModel> &learned_models();

} // namespace quiesce

#endif
