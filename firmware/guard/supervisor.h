/// Supervisor: one transition table; what the table does not allow does not happen. Output is
/// allowed in RUN and DEGRADED only.
///
/// States and faults are those of quiesce.h. A fault's class decides: clearing faults lead to SAFE
/// and back by themselves once the cause has gone; latched ones stay in FAULT, with the drivers
/// off, until the operator acknowledges (rising edge) with the cause gone. Final ones (PARAMETER,
/// MEMORY) never leave FAULT.
///
/// Armed: enable has risen in INIT or IDLE and has been held since. What is held at the start, over
/// a latched fault or through SAFE without having been armed starts nothing; it has to be let go
/// first. Bounded, about 50 instructions.
#ifndef SUPERVISOR_H
#define SUPERVISOR_H

#include "fixq.h"
#include "quiesce.h"

typedef struct {
    quiesce_fault_t clearing_fault; ///< present now, NONE if there is none
    quiesce_fault_t latched_fault;  ///< present now, NONE if there is none
    bool is_ready;                  ///< the sensor has been good for long enough
    bool is_limited;                ///< something has less than it should: DEGRADED, not RUN
    bool enable;
    bool fault_reset;
} supervisor_in_t;

/// Whole words: it is kept with its twin (base/twin.h).
typedef struct {
    uint8_t state; ///< quiesce_state_t
    uint8_t fault; ///< quiesce_fault_t that holds SAFE or FAULT, else NONE
    uint8_t is_armed;
    uint8_t last_inputs;  ///< bit 0: enable, bit 1: fault reset
    uint32_t fault_count; ///< entered since init, saturating
} supervisor_t;

/// first_fault: QUIESCE_FAULT_PARAMETER or QUIESCE_FAULT_MEMORY, else NONE. An enable or an
/// acknowledgement that the first tick finds counts as held before.
void supervisor_init(supervisor_t *self, quiesce_fault_t first_fault);

/// One tick. Returns true iff an acknowledgement was accepted (monitors forget their history).
bool supervisor_step(supervisor_t *self, const supervisor_in_t *in);

/// Whether a law's request may pass.
static inline bool supervisor_allows_output(const supervisor_t *self) {
    return self->state == QUIESCE_STATE_RUN || self->state == QUIESCE_STATE_DEGRADED;
}

/// Whether the drivers' output stages may be on.
static inline bool supervisor_allows_driver(const supervisor_t *self) {
    return self->state != QUIESCE_STATE_FAULT;
}

#endif
