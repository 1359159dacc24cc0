/// One small interface for every control law. A law turns what is known of the vibration into a
/// requested coil current; the guard has the last word. To add one: a file with its law_t, a line
/// in law.c, a label in parameters.toml.
#ifndef LAW_H
#define LAW_H

#include "fixq.h"
#include "quiesce_params.h"

typedef struct {
    int64_t velocity_um_s_q32;
    int32_t accel_um_s2;
    int32_t freq_uHz;   ///< last dominant frequency
    bool freq_is_valid; ///< or was, less than track_hold_ms ago
    int32_t base_mA;    ///< the rule base's current, or unlock_current_mA while freq is not valid
} law_in_t;

/// State of any law: caller-owned, cleared by reset.
typedef struct {
    int64_t current_mA_q20;
} law_state_t;

/// Request in mA, 0 .. params->max_current_mA + whatever the guard will clip.
typedef int32_t (*law_step_t)(law_state_t *state, const quiesce_params_t *params,
                              const law_in_t *in);

typedef struct {
    const char *name; ///< its label in parameters.toml
    law_step_t step;
} law_t;

extern const law_t law_off;
extern const law_t law_constant;
extern const law_t law_fuzzy;
extern const law_t law_fuzzy_selftune;

/// Law by the value of parameter law. Returns NULL iff there is none.
const law_t *law_find(int32_t index);

#endif
