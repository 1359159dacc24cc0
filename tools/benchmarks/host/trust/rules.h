/// What must hold in every tick, whatever the inputs: seen from outside, through quiesce.h alone.
#ifndef RULES_H
#define RULES_H

#include "quiesce.h"
#include "rig.h"

typedef enum {
    RULE_RANGE,  ///< a command is between 0 and what parameters and board allow; none is unused
    RULE_SLEW,   ///< while it runs, a command changes by no more than the slew limit
    RULE_SAFE,   ///< while it does not run, each damper has its safe current
    RULE_DRIVER, ///< e-stop, a failed driver and every latched fault keep the drivers off
    RULE_STOP,   ///< e-stop is FAULT in that very tick
    RULE_LATCH,  ///< FAULT is left on a rising edge of the acknowledgement, with no cause present
    RULE_ARMING, ///< running begins after a rising edge of enable since start, e-stop, latched
                 ///< fault
    RULES
} rule_t;

extern const char *const rule_names[RULES];

typedef struct {
    const rig_t *rig;
    quiesce_out_t last;
    bool last_enable;
    bool last_reset;
    bool is_armed; ///< an edge was seen
    bool has_ticked;
    uint64_t ticks;
    uint64_t running_ticks;
    uint64_t starts; ///< times that it began to run
    uint64_t stops;  ///< latched faults entered
    uint64_t broken[RULES];
} rules_t;

/// Whether a law's request passes in a state. The one place that names those states.
static inline bool rules_is_running(uint32_t state) {
    return state == QUIESCE_STATE_RUN || state == QUIESCE_STATE_DEGRADED;
}

/// A controller was started with a rig, which stays the caller's; counts go on.
void rules_start(rules_t *self, const rig_t *rig);

/// Judges a tick. Returns the first rule that is broken, or RULES.
rule_t rules_tick(rules_t *self, const quiesce_in_t *in, const quiesce_out_t *out);

#endif
