/// A kernel over a motion, many candidates side by side. Compiled once for every kernel and set of
/// instructions: a file of wide_run.cpp.in each.
#ifndef QUIESCE_WIDE_RUN_H
#define QUIESCE_WIDE_RUN_H

#include "run_group.h"
#include "wide.h"

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

template <class Kernel>
void run(const GroupJob &job) {
    GroupRun<Kernel, Wide>{job}();
}

} // namespace QUIESCE_ISA
} // namespace quiesce

#endif
