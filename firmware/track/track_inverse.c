// The current whose force, on the damper's map, is the demand at the present velocity. No force is
// measured.
#include "force_map.h"
#include "track.h"

static int32_t step(void *state, const track_setup_t *setup, const view_damper_t *damper,
                    int32_t demand_mN) {
    (void)state;
    return track_is_feasible(demand_mN, damper->velocity_um_s)
               ? force_map_current_mA(setup->table, damper->velocity_um_s, demand_mN)
               : 0;
}

static const track_table_kind_t map = {.magic = FORCE_MAP_MAGIC, .check = quiesce_force_map_check};

extern const track_t track_inverse;
const track_t track_inverse = {
    .name = "inverse",
    .needs = VIEW_EACH(VIEW_STROKE_VELOCITY),
    .kind = &map,
    .step = step,
};
