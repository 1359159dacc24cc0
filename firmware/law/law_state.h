/// State of all laws side by side: what law phase has learnt and the table that it uses can be
/// asked for, and set, whichever law runs.
#ifndef LAW_STATE_H
#define LAW_STATE_H

#include "law.h"
#include "phase_state.h"

struct law_state {
    int64_t selftune_mA_q20;
    phase_state_t phase;
};

/// Starts every law from rest. table: as in law_init_t.
void law_state_init(law_state_t *state, const quiesce_params_t *params, const uint32_t *table);

#endif
