/// Supervisor: one transition table; what the table does not allow does not happen. Output is
/// allowed in RUN and DEGRADED only. The drivers are off until a self-test has passed: from the
/// start, and from an acknowledgement on, until all has been ready once.
///
/// States and faults are those of quiesce.h. A fault's class decides: clearing faults lead to SAFE
/// and back by themselves once the cause has gone; latched ones stay in FAULT, with the drivers
/// off, until the operator acknowledges (rising edge) with the cause gone. Final ones (PARAMETER,
/// MEMORY) never leave FAULT.
///
/// Armed: enable has risen in INIT, SELF_TEST or IDLE and has been held since. What is held at the
/// start, over a latched fault or through SAFE without having been armed starts nothing; it has to
/// be let go first. Bounded, about 50 instructions.
#ifndef SUPERVISOR_H
#define SUPERVISOR_H

#include "fixq.h"
#include "quiesce.h"

typedef struct {
    quiesce_fault_t clearing_fault; ///< present now, NONE if there is none
    quiesce_fault_t latched_fault;  ///< present now, NONE if there is none
    bool is_ready; ///< sensors have been good for long enough; while supervisor_is_tested is false
                   ///< drivers that are off have been without current, too
    bool is_limited; ///< something has less than it should: DEGRADED, not RUN
    bool enable;
    bool fault_reset;
} supervisor_in_t;

/// Whole words: it is kept with its twin (base/twin.h).
typedef struct {
    uint8_t state; ///< quiesce_state_t
    uint8_t fault; ///< quiesce_fault_t that holds SAFE or FAULT, else NONE
    uint8_t flags; ///< SUPERVISOR_x
    uint8_t spare;
    uint32_t fault_count; ///< entered since init, saturating
} supervisor_t;

#define SUPERVISOR_ARMED 1u
#define SUPERVISOR_TESTED 2u      ///< the self-test has passed
#define SUPERVISOR_WAS_ENABLED 4u ///< enable was on in the last tick
#define SUPERVISOR_WAS_RESET 8u   ///< likewise fault reset

/// first_fault: QUIESCE_FAULT_PARAMETER or QUIESCE_FAULT_MEMORY, else NONE. An enable or an
/// acknowledgement that the first tick finds counts as held before.
void supervisor_init(supervisor_t *self, quiesce_fault_t first_fault);

/// One tick. Returns true iff an acknowledgement was accepted (monitors forget their history).
bool supervisor_step(supervisor_t *self, const supervisor_in_t *in);

/// Whether a law's request may pass.
static inline bool supervisor_allows_output(const supervisor_t *self) {
    return self->state == QUIESCE_STATE_RUN || self->state == QUIESCE_STATE_DEGRADED;
}

static inline bool supervisor_is_armed(const supervisor_t *self) {
    return (self->flags & SUPERVISOR_ARMED) != 0u;
}

/// Whether the self-test has passed since the start or the last acknowledgement.
static inline bool supervisor_is_tested(const supervisor_t *self) {
    return (self->flags & SUPERVISOR_TESTED) != 0u;
}

/// Whether the drivers' output stages may be on.
static inline bool supervisor_allows_driver(const supervisor_t *self) {
    return supervisor_is_tested(self) && self->state != QUIESCE_STATE_FAULT;
}

#endif
