// Compiled once for every instruction set, with QUIESCE_ISA as its name.
#include "wide.h"

#include "kernels.h"
#include "run_group.h"

namespace quiesce {

template <>
struct LaneAccess<QUIESCE_ISA::Wide> {
    static QUIESCE_ISA::Wide load(const double *values, std::size_t index) {
        QUIESCE_ISA::Wide out;
        __builtin_memcpy(&out, values + index * QUIESCE_ISA::kLanes, sizeof out);
        return out;
    }
    static void store(double *values, std::size_t row, const QUIESCE_ISA::Wide &value) {
        __builtin_memcpy(values + row * QUIESCE_ISA::kLanes, &value, sizeof value);
    }
};

namespace QUIESCE_ISA {

namespace {

template <class Kernel>
void run(const GroupJob &job) {
    GroupRun<Kernel, Wide>{job}();
}

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
