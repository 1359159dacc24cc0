// Open loop: the damper stays without current.
#include "law.h"

static int32_t step(law_state_t *state, const quiesce_params_t *params, const law_in_t *in) {
    (void)state;
    (void)params;
    (void)in;
    return 0;
}

const law_t law_off = {.name = "off", .step = step};
