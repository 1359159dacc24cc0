/// One small interface for every control law. A law turns what is known of the vibration into a
/// requested coil current; the guard has the last word. To add one: a file with its law_t, its
/// state in law_state.h, a line in law.c, a label in parameters.toml.
#ifndef LAW_H
#define LAW_H

#include "fixq.h"
#include "harmonics.h"
#include "quiesce_params.h"

/// The component that is locked on to.
typedef struct {
    bool is_on;
    uint32_t phase_turn;         ///< of its acceleration, a = amp x cos(phase), at this tick
    uint32_t step_turn;          ///< a tick
    const harmonic_sums_t *half; ///< half a cycle whose sums became known in this tick, else NULL
} law_lock_t;

typedef struct {
    int64_t velocity_um_s_q32;
    int32_t accel_um_s2;
    int32_t freq_uHz;   ///< last dominant frequency
    bool freq_is_valid; ///< or was, less than track_hold_ms ago
    int32_t base_mA;    ///< the rule base's current, or unlock_current_mA while freq is not valid
    law_lock_t lock;    ///< off for laws that do not use it
    bool is_output_on;  ///< in the last tick: what was requested passed the guard
} law_in_t;

/// State of all laws (law_state.h), caller-owned; each looks at its own.
typedef struct law_state law_state_t;

/// Starts from rest. table: the words that ship for the laws that have a table, checked; they must
/// stay.
typedef void (*law_init_t)(law_state_t *state, const quiesce_params_t *params,
                           const uint32_t *table);

/// Request in mA, 0 .. params->max_current_mA + whatever the guard will clip.
typedef int32_t (*law_step_t)(law_state_t *state, const quiesce_params_t *params,
                              const law_in_t *in);

typedef struct {
    const char *name; ///< its label in parameters.toml
    law_init_t init;  ///< NULL: it starts with zeros
    law_step_t step;
    bool uses_rules; ///< base_mA; else the rule base rests
    bool uses_lock;  ///< lock; else nothing is locked on to
} law_t;

extern const law_t law_off;
extern const law_t law_constant;
extern const law_t law_fuzzy;
extern const law_t law_fuzzy_selftune;
extern const law_t law_phase;

/// Law by the value of parameter law. Returns NULL iff there is none.
const law_t *law_find(int32_t index);

#endif
