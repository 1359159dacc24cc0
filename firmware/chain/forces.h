/// From the forces that a law demands to currents: the tracker, its table, its state for each
/// damper.
#ifndef FORCES_H
#define FORCES_H

#include "law.h"
#include "track.h"

typedef struct {
    const track_t *track;  ///< NULL: the law demands currents
    const uint32_t *table; ///< NULL: none, or none yet
    uint32_t dampers;
    uint64_t state[QUIESCE_DAMPERS][TRACK_STATE_BYTES / sizeof(uint64_t)];
} forces_t;

/// VIEW_ bits that the tracker needs; none where the law demands currents. Parameters have been
/// checked.
uint64_t forces_need(const law_t *law, const quiesce_params_t *params);

/// Whether a table of the tracker may need more.
bool forces_may_need_more(const law_t *law, const quiesce_params_t *params);

/// The tracker of the parameters, if the law needs one, from rest and without a table.
void forces_init(forces_t *self, const law_t *law, const quiesce_params_t *params,
                 uint32_t dampers);

/// The kind of the tracker's table. NULL: no tracker, or it needs none.
const track_table_kind_t *forces_kind(const forces_t *self);

/// Takes words of that kind, which have been checked; NULL: none from now on. The tracker starts
/// from rest.
void forces_use(forces_t *self, const uint32_t *table);

/// VIEW_ bits that words of that kind need, which have been checked; none of NULL.
uint64_t forces_table_needs(const forces_t *self, const uint32_t *table);

/// Whether no table of a tracker is missing.
bool forces_are_ready(const forces_t *self);

/// Makes currents of the forces of all dampers, in place; once they are ready.
void forces_step(forces_t *self, const quiesce_params_t *params, const view_t *view,
                 law_demand_t *demand);

#endif
