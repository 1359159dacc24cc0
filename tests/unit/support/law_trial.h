// A law with its tracker alone, on pictures of structures that no plant would show, and what must
// hold whatever it sees. The same on every target: laws come from the registry, tables from whoever
// calls.
#ifndef LAW_TRIAL_H
#define LAW_TRIAL_H

#include "forces.h"
#include "guard.h"
#include "law.h"

enum {
    LAW_TRIAL_SIGNALS = 6 * QUIESCE_MAX_BODIES + 8 * QUIESCE_MAX_DAMPERS, // at most
};

// Bits: a demand against what the damper does got a current; a current is beyond max_current_mA, or
// below 0, behind the guard, or a tracker's beyond what any driver takes.
enum { LAW_TRIAL_ENERGISED = 1, LAW_TRIAL_BEYOND = 2 };

// How a signal goes on for a while.
typedef struct {
    uint32_t kind;
    int32_t size;
    uint32_t freq_mHz;
} law_trial_way_t;

typedef struct {
    const law_t *law;
    law_setup_t setup;
    forces_t forces;
    law_arena_t state;
    view_t view;
    law_demand_t demand;  // of the law
    law_demand_t current; // of the tracker, of the law where that demands currents; mA
    law_demand_t command; // behind the guard, mA
    guard_t guard[QUIESCE_DAMPERS];
    bool has_demand; // in this tick
    uint32_t seed;
    uint32_t tick;
    uint32_t left_ticks; // before the signals change their ways
    law_trial_way_t way[LAW_TRIAL_SIGNALS];
} law_trial_t;

// The law and the tracker of the parameters, which are good, from rest. Words of its table and of
// its tracker's; NULL: those that ship, or none. Returns false iff a table is missing or refused.
bool law_trial_start(law_trial_t *self, const quiesce_params_t *params, const uint32_t *table,
                     uint32_t count, const uint32_t *map, uint32_t map_count, uint32_t seed);

// The next picture: every quantity of every body and damper, each quiet, a tone, noise, steps or at
// its limits, of any size below 2^30.
void law_trial_look(law_trial_t *self);

// Law and tracker, once; then the guard.
void law_trial_step(law_trial_t *self);
void law_trial_guard(law_trial_t *self);

// LAW_TRIAL_ bits of the last step.
uint32_t law_trial_breaks(const law_trial_t *self);

// Bytes of the law's state up to the last one that is not 0.
uint32_t law_trial_state_bytes(const law_trial_t *self);

// Spoils some words of a table behind its head and makes the head right again: the rest is for its
// kind's check to find.
void law_trial_spoil(uint32_t *words, uint32_t count, uint32_t *seed);

// Number of words and CRC-32 anew.
void law_trial_seal(uint32_t *words, uint32_t count);

#endif
