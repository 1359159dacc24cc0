// A current in proportion to what the measured force falls short of the demand.
//
// tracker_gain_mA_kN (below 2^27) x mN (below 2^31) is below 2^58; the quotient is rounded to
// nearest and limited to 0 .. max_current_mA.
#include "track.h"

enum { mN_PER_kN = 1000000 };

static int32_t step(void *state, const track_setup_t *setup, const view_damper_t *damper,
                    int32_t demand_mN) {
    (void)state;
    const int32_t missing_mN = abs_i32(demand_mN) - abs_i32(damper->force_mN);
    if (!track_is_feasible(demand_mN, damper->force_mN) || missing_mN <= 0) {
        return 0;
    }
    const uint64_t product =
        (uint64_t)(uint32_t)setup->params->tracker_gain_mA_kN * (uint32_t)missing_mN;
    const uint64_t current_mA = (product + mN_PER_kN / 2) / mN_PER_kN;
    const uint32_t most_mA = (uint32_t)setup->params->max_current_mA;
    return (int32_t)(current_mA < most_mA ? current_mA : most_mA);
}

extern const track_t track_proportional;
const track_t track_proportional = {
    .name = "proportional",
    .needs = VIEW_EACH(VIEW_FORCE),
    .step = step,
};
