/// The law that runs: its table, its state, and what it asks for in a tick.
#ifndef CONTROL_H
#define CONTROL_H

#include "law.h"

typedef struct {
    const law_t *law;
    law_setup_t setup;
    uint64_t state[LAW_STATE_BYTES / sizeof(uint64_t)];
} control_t;

/// The law of the parameters, which have been checked, with the table that ships, from rest.
void control_init(control_t *self, const quiesce_params_t *params);

/// Another table; NULL: the one that ships. A table that is refused changes nothing.
quiesce_table_verdict_t control_use(control_t *self, const uint32_t *words, uint32_t count);

/// Requests in mA for each damper. Where the law does not see what it needs, or has no demand: the
/// unlock current.
void control_step(control_t *self, const view_t *view, law_demand_t *out);

/// As quiesce_report, quiesce_learnt_save and quiesce_learnt_load.
void control_report(const control_t *self, int32_t word[QUIESCE_REPORT_WORDS]);
bool control_save(const control_t *self, quiesce_learnt_t *out);
bool control_load(control_t *self, const quiesce_learnt_t *in);

#endif
