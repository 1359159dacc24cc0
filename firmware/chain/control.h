/// The law that runs, with the tracker of the forces that it may demand: their tables, their
/// states, and the currents that they ask for in a tick.
#ifndef CONTROL_H
#define CONTROL_H

#include "forces.h"
#include "law.h"
#include "sensing.h"

/// How long a law may be without what it needs, on the unlock current, before that is a fault.
#define CONTROL_BLIND_ms 100

typedef struct {
    const law_t *law;
    uint64_t needs;       ///< of law, tracker and table, of those that there are
    uint64_t fixed_needs; ///< those of law and tracker
    uint64_t provided;    ///< what the board's sensors can
    uint32_t bodies;      ///< of the board
    uint32_t dampers;
    law_setup_t setup;
    uint32_t blind_ticks; ///< in a row, with the output on
    uint32_t blind_most_ticks;
    forces_t forces;
    law_arena_t state;
} control_t;

/// VIEW_ bits that the law of these parameters and its tracker are served with: what they need, and
/// what a table of the law may need. Both are in their ranges.
uint64_t control_serves(const quiesce_params_t *params);

/// The law of the parameters, which have been checked, with the table that ships, from rest.
void control_init(control_t *self, const places_t *places, const quiesce_params_t *params);

/// Whether law or tracker takes words, whose CRC has just been found right where they are summed.
quiesce_table_verdict_t control_check(const control_t *self, const uint32_t *words, uint32_t count,
                                      bool is_summed);

/// Another table, of the law or of the tracker, which control_check accepts.
void control_use(control_t *self, const uint32_t *words);

/// As quiesce_table_drop and quiesce_table_in_use.
bool control_drop(control_t *self, quiesce_owner_t owner);
const uint32_t *control_table(const control_t *self, quiesce_owner_t owner);

/// As quiesce_lacks_table.
const char *control_lacks_table(const control_t *self);

/// Whether law and tracker see what they need, the tracker's table included.
bool control_sees(const control_t *self, const view_t *view);

/// Requests in mA for each damper. Where law or tracker does not see what it needs, or the law has
/// no demand: the unlock current. Returns false iff that has lasted for longer than it may.
bool control_step(control_t *self, const view_t *view, law_demand_t *out);

/// As quiesce_table_hash.
uint32_t control_table_hash(const control_t *self);

/// As quiesce_report, quiesce_learnt_save and quiesce_learnt_load.
void control_report(const control_t *self, int32_t word[QUIESCE_REPORT_WORDS]);
bool control_save(const control_t *self, quiesce_learnt_t *out);
bool control_load(control_t *self, const quiesce_learnt_t *in);

#endif
