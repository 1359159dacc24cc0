/// The contract of every tracker: from the force that a law demands of a damper to its current.
///
/// To add one: a file with its track_t and a label of parameter tracker in parameters.toml. What a
/// damper cannot do is judged here, once: a demand that it cannot meet gets the nearest that it can
/// do, no current or the largest.
#ifndef TRACK_H
#define TRACK_H

#include "table.h"
#include "view.h"

/// Bytes for the state of a tracker, for each damper.
#define TRACK_STATE_BYTES 56u

/// What a tracker works with.
typedef struct {
    const quiesce_params_t *params; ///< checked
    const uint32_t *table;          ///< words that the kind's check accepts; NULL without a kind
    uint32_t damper;                ///< its number
} track_setup_t;

typedef struct {
    const char *name;         ///< value of parameter tracker
    uint64_t needs;           ///< VIEW_ bits; while they are not all valid it is not stepped
    const table_kind_t *kind; ///< none ships: maps are of users' dampers; NULL: it has none
    /// One damper, one tick. Returns the current, mA, any value: what follows limits it. *state is
    /// 0 from rest and with another table. demand_mN: any value, > 0 resists a stroke that grows.
    int32_t (*step)(void *state, const track_setup_t *setup, const view_damper_t *damper,
                    int32_t demand_mN);
} track_t;

/// The semi-active condition: a damper takes power and never gives any, so that a demand has to
/// have the sign of what the damper does already, its force or its velocity. At rest (way 0) either
/// sign will do.
static inline bool track_is_feasible(int32_t demand_mN, int32_t way) {
    return demand_mN != 0 && (way == 0 || (demand_mN > 0) == (way > 0));
}

/// Tracker by the value of parameter tracker. Returns NULL iff there is none in this
/// build.
const track_t *track_find(int32_t index);

#endif
