// Full-scale steps of the current loop that ships on every coil and supply that it is for, a line
// of JSON each.
#include <cstdio>

#include "current_run.h"

int main() {
    constexpr std::uint64_t SEED = 20261128;
    for (const quiesce::CoilCircuitParams &coil : quiesce::all_coils()) {
        const quiesce::CurrentStep step = quiesce::full_scale_step(coil, SEED);
        std::printf("{\"supply_V\": %g, \"resistance_ohm\": %g, \"inductance_mH\": %g, "
                    "\"is_possible\": %s, \"step_ms\": %g, \"bound_ms\": %g, "
                    "\"overshoot_pct\": %g, \"steady_pct\": %g}\n",
                    coil.supply_V, coil.resistance_ohm, coil.inductance_H * 1000.0,
                    step.is_possible ? "true" : "false", step.time_ms, step.bound_ms,
                    step.overshoot_pct, step.steady_pct);
    }
    return 0;
}
