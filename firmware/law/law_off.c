// Open loop: the dampers stay without current.
#include "law.h"

static bool step(void *state, const law_setup_t *setup, const view_t *view, law_demand_t *out) {
    (void)state;
    (void)setup;
    (void)view;
    *out = (law_demand_t){{0}};
    return true;
}

extern const law_t law_off;
const law_t law_off = {.name = "off", .step = step};
