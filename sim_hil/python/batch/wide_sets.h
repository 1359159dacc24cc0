/// The compiled sets of instructions that this processor runs.
#ifndef QUIESCE_WIDE_SETS_H
#define QUIESCE_WIDE_SETS_H

#include <vector>

#include "group.h"

namespace quiesce {

/// The fastest first; none where this build is of another processor.
std::vector<GroupTable> wide_sets();

} // namespace quiesce

#endif
