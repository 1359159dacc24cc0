// Passive damper at one current.
#include "law.h"

static int32_t step(law_state_t *state, const quiesce_params_t *params, const law_in_t *in) {
    (void)state;
    (void)in;
    return params->constant_current_mA;
}

const law_t law_constant = {.name = "constant", .step = step};
