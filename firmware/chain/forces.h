/// From the forces that a law demands to currents: the tracker and its table. Its states lie where
/// the law's does, and are handed in.
#ifndef FORCES_H
#define FORCES_H

#include "law.h"
#include "track.h"

typedef struct {
    const track_t *track;  ///< NULL: the law demands currents
    const uint32_t *table; ///< NULL: none, or none yet
} forces_t;

/// Of the tracker, for each damper; all 0: at rest.
typedef struct {
    uint64_t of[QUIESCE_DAMPERS][TRACK_STATE_BYTES / sizeof(uint64_t)];
} forces_state_t;

/// A law that demands currents has all of it; one that demands forces leaves the rest to a tracker.
typedef union {
    uint64_t law[LAW_STATE_BYTES / sizeof(uint64_t)];
    struct {
        uint64_t law[LAW_FORCE_STATE_BYTES / sizeof(uint64_t)];
        forces_state_t track;
    } force;
} law_arena_t;

_Static_assert(sizeof(law_arena_t) == LAW_STATE_BYTES, "trackers need more than laws leave them");

/// VIEW_ bits that the tracker needs; none where the law demands currents. Parameters have been
/// checked.
uint64_t forces_need(const law_t *law, const quiesce_params_t *params);

/// Whether a table of the tracker may need more.
bool forces_may_need_more(const law_t *law, const quiesce_params_t *params);

/// The tracker of the parameters, if the law needs one, without a table.
void forces_init(forces_t *self, const law_t *law, const quiesce_params_t *params);

/// The kind of the tracker's table. NULL: no tracker, or it needs none.
const table_kind_t *forces_kind(const forces_t *self);

/// Takes words of that kind, which have been checked; NULL: none from now on. The tracker starts
/// from rest.
void forces_use(forces_t *self, forces_state_t *state, const uint32_t *table);

/// VIEW_ bits that words of that kind need, which have been checked; none of NULL.
uint64_t forces_table_needs(const forces_t *self, const uint32_t *table);

/// Whether no table of a tracker is missing.
bool forces_are_ready(const forces_t *self);

/// What a tick's forces become currents with.
typedef struct {
    const quiesce_params_t *params;
    const view_t *view;
    uint32_t dampers; ///< that there are; the others get no current
} forces_in_t;

/// Makes currents of the forces of all dampers, in place; once they are ready.
void forces_step(const forces_t *self, forces_state_t *state, const forces_in_t *in,
                 law_demand_t *demand);

#endif
