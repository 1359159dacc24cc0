// Passive dampers at one current.
#include "law.h"

static bool step(void *state, const law_setup_t *setup, const view_t *view, law_demand_t *out) {
    (void)state;
    (void)view;
    law_demand_all(out, setup->params.constant_current_mA);
    return true;
}

extern const law_t law_constant;
const law_t law_constant = {.name = "constant", .step = step};
