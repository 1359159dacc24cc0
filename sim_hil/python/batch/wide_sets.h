/// The compiled sets of instructions that this processor runs.
#ifndef QUIESCE_WIDE_SETS_H
#define QUIESCE_WIDE_SETS_H

#include <vector>

#include "group.h"

namespace quiesce {

/// The fastest first; the last one runs on every processor of this architecture.
std::vector<GroupTable> wide_sets();

} // namespace quiesce

#endif
