// The paper's first stage: the rule base's current as it is.
#include "law.h"

static int32_t step(law_state_t *state, const quiesce_params_t *params, const law_in_t *in) {
    (void)state;
    (void)params;
    return in->base_mA;
}

const law_t law_fuzzy = {.name = "fuzzy", .step = step, .uses_rules = true};
