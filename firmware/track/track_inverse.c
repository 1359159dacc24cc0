// The current whose force, on the damper's map, is the demand at the present velocity, or the
// present stroke where the map is a spring's. No force is measured.
#include <stddef.h>

#include "force_map.h"
#include "sections.h"
#include "track.h"

static int32_t step(void *state, const track_setup_t *setup, const view_damper_t *damper,
                    int32_t demand_mN) {
    (void)state;
    const uint32_t *section = force_map_section(setup->table, setup->damper);
    if (section == NULL) {
        return 0;
    }
    const int32_t place = force_map_place(section, damper);
    return track_is_feasible(demand_mN, place) ? force_map_current_mA(section, place, demand_mN)
                                               : 0;
}

static const table_kind_t map = {
    .name = "map",
    .magic = FORCE_MAP_MAGIC,
    .least_words = SECTIONS_FIRST,
    .check = force_map_check,
    .needs = force_map_needs,
};

extern const track_t track_inverse;
const track_t track_inverse = {
    .name = "inverse",
    .needs = VIEW_EACH(VIEW_STROKE_VELOCITY),
    .kind = &map,
    .step = step,
};
