// The kernels of one set of instructions. Compiled once for each, with QUIESCE_ISA as its name.
#include "group.h"
#include "kernels.h"
#include "wide.h"

namespace quiesce {
namespace QUIESCE_ISA {

/// Defined in a file of its own for each kernel (wide_run.cpp.in).
template <class Kernel>
void run(const GroupJob &job);

namespace {

#define QUIESCE_FUNCTION(Kernel) run<Kernel>,
const GroupFunction kFunctions[] = {QUIESCE_KERNELS(QUIESCE_FUNCTION)};
#undef QUIESCE_FUNCTION

} // namespace

GroupTable group_table();
GroupTable group_table() {
#define QUIESCE_TEXT(name) #name
#define QUIESCE_TEXT_OF(name) QUIESCE_TEXT(name)
    return {kFunctions, kLanes, QUIESCE_TEXT_OF(QUIESCE_ISA)};
}

} // namespace QUIESCE_ISA
} // namespace quiesce
