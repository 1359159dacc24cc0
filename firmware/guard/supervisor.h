/// Supervisor: one transition table; what the table does not allow does not happen. Output is
/// allowed in RUN only.
///
/// States and faults are those of quiesce.h. A fault's class decides: clearing faults lead to SAFE
/// and back by themselves once the cause has gone; latched ones stay in FAULT until the operator
/// acknowledges (rising edge) with the cause gone. A refused parameter set never leaves FAULT.
/// Bounded, about 40 instructions.
#ifndef SUPERVISOR_H
#define SUPERVISOR_H

#include "fixq.h"
#include "quiesce.h"

typedef struct {
    quiesce_fault_t clearing_fault; ///< present now, NONE if there is none
    quiesce_fault_t latched_fault;  ///< present now, NONE if there is none
    bool is_ready;                  ///< the sensor has been good for long enough
    bool enable;
    bool fault_reset;
} supervisor_in_t;

typedef struct {
    quiesce_state_t state;
    quiesce_fault_t fault; ///< the one that holds SAFE or FAULT, else NONE
    uint32_t fault_count;  ///< entered since init, saturating
    bool last_fault_reset;
} supervisor_t;

/// first_fault: QUIESCE_FAULT_PARAMETER where the parameters were refused, else NONE.
void supervisor_init(supervisor_t *self, quiesce_fault_t first_fault);

/// One tick. Returns true iff an acknowledgement was accepted (monitors forget their history).
bool supervisor_step(supervisor_t *self, const supervisor_in_t *in);

/// Whether a law's request may pass.
static inline bool supervisor_allows_output(const supervisor_t *self) {
    return self->state == QUIESCE_STATE_RUN;
}

/// Whether a fault, while it holds FAULT, keeps the driver's output stage off.
static inline bool supervisor_switches_off(quiesce_fault_t fault) {
    return fault == QUIESCE_FAULT_ESTOP || fault == QUIESCE_FAULT_PARAMETER ||
           fault == QUIESCE_FAULT_DRIVER_FAILED;
}

/// Whether the driver's output stage may be on.
static inline bool supervisor_allows_driver(const supervisor_t *self) {
    return self->state != QUIESCE_STATE_FAULT || !supervisor_switches_off(self->fault);
}

#endif
