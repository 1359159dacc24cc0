/// The contract of every control law: from what is known of the structure to a current, or a force,
/// for each damper. The tracker makes a force a current; the guard has the last word.
///
/// To add one: a file with its law_t and a label in parameters.toml. Numbers, rules, pulses, gains
/// that it works with are a table: words that its check accepts, loaded on the road of all tables.
#ifndef LAW_H
#define LAW_H

#include "table.h"
#include "view.h"

/// Bytes for the state of the law that runs; its file asserts that they are enough.
#define LAW_STATE_BYTES 816u

/// The same where the law demands forces; the rest is its tracker's.
#define LAW_FORCE_STATE_BYTES 592u

/// What a law works with; lives beside its state.
typedef struct {
    quiesce_params_t params; ///< checked
    const uint32_t *table;   ///< words that the kind's check accepts; NULL without a kind
} law_setup_t;

typedef enum {
    LAW_DEMANDS_CURRENT, ///< mA
    LAW_DEMANDS_FORCE,   ///< mN, > 0 resists a stroke that grows; a tracker makes it a current
} law_demand_kind_t;

/// For each damper, any value: what follows limits it.
typedef struct {
    int32_t value[QUIESCE_DAMPERS];
} law_demand_t;

/// The same for every damper.
static inline void law_demand_all(law_demand_t *out, int32_t value) {
    for (uint32_t i = 0; i < QUIESCE_DAMPERS; i++) {
        out->value[i] = value;
    }
}

/// What a law demands while it knows no frequency: unlock_current_mA; of a structure at rest, where
/// that would heat the coil for nothing, safe_current_mA.
static inline int32_t law_unlock_mA(const quiesce_params_t *params, const view_t *view) {
    return view->is_at_rest ? params->safe_current_mA : params->unlock_current_mA;
}

/// The lock on the dominant component (chain/dominant_lock.h). A law that works with it names it
/// here, and a build in which none does holds none of it.
typedef struct dominant_lock dominant_lock_t;
extern const dominant_lock_t dominant_lock;

typedef struct {
    const char *name;              ///< value of parameter law
    uint64_t needs;                ///< VIEW_ bits; while they are not all valid it is not stepped
    const table_kind_t *kind;      ///< of its table; NULL: it has none
    uint8_t demands;               ///< law_demand_kind_t
    const dominant_lock_t *lock;   ///< &dominant_lock: the dominant component is to be locked on to
    const quiesce_word_t *reports; ///< QUIESCE_REPORT_WORDS of them, the last ones without a name
    /// From rest; all of *state is 0 before. NULL: that is all.
    void (*init)(void *state, const law_setup_t *setup);
    /// Another table is in use. NULL: as init, from rest.
    void (*retable)(void *state, const law_setup_t *setup);
    /// One tick. Returns false iff it has no demand: the fallback acts.
    bool (*step)(void *state, const law_setup_t *setup, const view_t *view, law_demand_t *out);
    /// What it has to tell. NULL: nothing. On request only, not in every tick.
    void (*report)(const void *state, const law_setup_t *setup, int32_t word[QUIESCE_REPORT_WORDS]);
    /// What it has learnt, at most QUIESCE_LEARNT_MAX_WORDS words; returns their number. NULL: it
    /// learns nothing.
    uint32_t (*save)(const void *state, const law_setup_t *setup, uint32_t *words);
    /// Puts that back; count 0: forgets it. Returns false, and changes nothing, iff it does not
    /// belong here.
    bool (*load)(void *state, const law_setup_t *setup, const uint32_t *words, uint32_t count);
} law_t;

/// Law by the value of parameter law. Returns NULL iff there is none in this build.
const law_t *law_find(int32_t index);

#endif
