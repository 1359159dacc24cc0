// QUIESCE_SET_...: those that were compiled (CMakeLists.txt).
#include "wide_sets.h"

namespace quiesce {

namespace isa_base {
GroupTable group_table();
}
namespace isa_v3 {
GroupTable group_table();
}
namespace isa_v4 {
GroupTable group_table();
}

std::vector<GroupTable> wide_sets() {
    std::vector<GroupTable> sets;
#ifdef QUIESCE_SET_v4
    if (__builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512dq") &&
        __builtin_cpu_supports("avx512bw") && __builtin_cpu_supports("avx512vl")) {
        sets.push_back(isa_v4::group_table());
    }
#endif
#ifdef QUIESCE_SET_v3
    if (__builtin_cpu_supports("avx2") && __builtin_cpu_supports("bmi2")) {
        sets.push_back(isa_v3::group_table());
    }
#endif
#ifdef QUIESCE_SET_base
    sets.push_back(isa_base::group_table());
#endif
    return sets;
}

} // namespace quiesce
