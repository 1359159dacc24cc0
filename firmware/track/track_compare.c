// Clipped on and off (Dyke, Spencer, Sain and Carlson): all current while the measured force has
// the demand's sign and falls short of it, else none. Within 1 % of the demand the last decision
// stands: a force that sits on its demand must not make the coil rattle.
#include "track.h"

// mN. Both magnitudes are below 2^31 and the force's below 2^30: no difference overflows.
enum { BAND_PARTS = 100 };

static int32_t step(void *state, const track_setup_t *setup, const view_damper_t *damper,
                    int32_t demand_mN) {
    bool *is_on = state;
    const int32_t size_mN = abs_i32(demand_mN);
    const int32_t missing_mN = size_mN - abs_i32(damper->force_mN);
    const int32_t band_mN = size_mN / BAND_PARTS;
    if (!track_is_feasible(demand_mN, damper->force_mN) || missing_mN < -band_mN) {
        *is_on = false;
    } else if (missing_mN > band_mN) {
        *is_on = true;
    }
    return *is_on ? setup->params->max_current_mA : 0;
}

extern const track_t track_compare;
const track_t track_compare = {
    .name = "compare",
    .needs = VIEW_EACH(VIEW_FORCE),
    .step = step,
};
