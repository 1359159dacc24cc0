// The paper's first stage: the rule base's current as it is.
#include "rule_base.h"

#include <stddef.h>

_Static_assert(sizeof(rule_base_t) <= LAW_STATE_BYTES, "the arena is too small");

static bool step(void *state, const law_setup_t *setup, const view_t *view, law_demand_t *out) {
    const int32_t base_mA = rule_base_step(state, setup->table, &view->tone);
    law_demand_all(out, rule_base_or_unlock_mA(setup, view, base_mA));
    return true;
}

extern const law_t law_fuzzy;
const law_t law_fuzzy = {
    .name = "fuzzy",
    .needs = VIEW_RMS,
    .kind = &rule_base_kind,
    .reports = rule_base_reports,
    .retable = rule_base_retable,
    .step = step,
    .report = rule_base_report,
};
