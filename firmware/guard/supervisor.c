#include "supervisor.h"

// In last_inputs.
#define WAS_ENABLED 1u
#define WAS_RESET 2u

typedef enum {
    EVENT_NOTHING, // not healthy for long enough
    EVENT_READY,   // healthy for long enough
    EVENT_ARMED,   // armed, not healthy for long enough
    EVENT_GO,      // armed and healthy for long enough
    EVENT_LIMITED, // likewise, but something has less than it should
    EVENT_CLEARING_FAULT,
    EVENT_LATCHED_FAULT, // also one that is not acknowledged
    EVENTS
} event_t;

#define INIT QUIESCE_STATE_INIT
#define IDLE QUIESCE_STATE_IDLE
#define ARMED QUIESCE_STATE_ARMED
#define RUN QUIESCE_STATE_RUN
#define DEGRADED QUIESCE_STATE_DEGRADED
#define SAFE QUIESCE_STATE_SAFE
#define FAULT QUIESCE_STATE_FAULT

// next[state][event]. Every entry is written out: a new state or event shows its gaps here.
static const uint8_t next[QUIESCE_STATE_COUNT][EVENTS] = {
    // Columns: nothing, ready, armed, go, limited, clearing fault, latched fault. FAULT is left
    // disarmed.
    [INIT] = {INIT, IDLE, INIT, ARMED, ARMED, SAFE, FAULT},
    [IDLE] = {IDLE, IDLE, ARMED, ARMED, ARMED, SAFE, FAULT},
    [ARMED] = {IDLE, IDLE, ARMED, RUN, DEGRADED, SAFE, FAULT},
    [RUN] = {IDLE, IDLE, RUN, RUN, DEGRADED, SAFE, FAULT},
    [DEGRADED] = {IDLE, IDLE, DEGRADED, RUN, DEGRADED, SAFE, FAULT},
    [SAFE] = {SAFE, IDLE, SAFE, ARMED, ARMED, SAFE, FAULT},
    [FAULT] = {INIT, INIT, FAULT, FAULT, FAULT, SAFE, FAULT},
};

void supervisor_init(supervisor_t *self, quiesce_fault_t first_fault) {
    const bool is_refused = first_fault != QUIESCE_FAULT_NONE;
    *self = (supervisor_t){
        .state = is_refused ? FAULT : INIT,
        .fault = (uint8_t)first_fault,
        .fault_count = is_refused ? 1u : 0u,
        .last_inputs = WAS_ENABLED | WAS_RESET,
    };
}

static bool is_final(uint32_t fault) {
    return fault == QUIESCE_FAULT_PARAMETER || fault == QUIESCE_FAULT_MEMORY;
}

// The operator's inputs of this tick. Returns true iff enable has risen.
static bool follow_inputs(supervisor_t *self, const supervisor_in_t *in, bool *is_acknowledged) {
    const bool has_risen = in->enable && (self->last_inputs & WAS_ENABLED) == 0u;
    *is_acknowledged = in->fault_reset && (self->last_inputs & WAS_RESET) == 0u;
    self->last_inputs =
        (uint8_t)((in->enable ? WAS_ENABLED : 0u) | (in->fault_reset ? WAS_RESET : 0u));
    return has_risen;
}

static void arm(supervisor_t *self, bool enable, bool has_risen) {
    const bool may_arm = self->state == INIT || self->state == IDLE;
    const bool is_armed = self->is_armed != 0u && self->state != FAULT;
    self->is_armed = enable && (is_armed || (has_risen && may_arm));
}

static event_t event_of(const supervisor_t *self, const supervisor_in_t *in, bool is_acknowledged) {
    const bool stays = self->state == FAULT && (!is_acknowledged || is_final(self->fault));
    if (stays || in->latched_fault != QUIESCE_FAULT_NONE) {
        return EVENT_LATCHED_FAULT;
    }
    if (in->clearing_fault != QUIESCE_FAULT_NONE) {
        return EVENT_CLEARING_FAULT;
    }
    if (self->is_armed == 0u) {
        return in->is_ready ? EVENT_READY : EVENT_NOTHING;
    }
    if (!in->is_ready) {
        return EVENT_ARMED;
    }
    return in->is_limited ? EVENT_LIMITED : EVENT_GO;
}

// An emergency stop is told on top of any other latched fault but a final one; of the others the
// first stays.
static void note_fault(supervisor_t *self, const supervisor_in_t *in, event_t event,
                       uint32_t before) {
    if (self->state != SAFE && self->state != FAULT) {
        self->fault = QUIESCE_FAULT_NONE;
        return;
    }
    const bool is_stop = in->latched_fault == QUIESCE_FAULT_ESTOP &&
                         self->fault != QUIESCE_FAULT_ESTOP && !is_final(self->fault);
    if (self->state != before || is_stop) {
        self->fault =
            (uint8_t)(event == EVENT_LATCHED_FAULT ? in->latched_fault : in->clearing_fault);
        self->fault_count = increment_sat_u32(self->fault_count);
    }
}

bool supervisor_step(supervisor_t *self, const supervisor_in_t *in) {
    bool is_acknowledged;
    const uint32_t before = self->state;
    const bool has_risen = follow_inputs(self, in, &is_acknowledged);
    arm(self, in->enable, has_risen);
    const event_t event = event_of(self, in, is_acknowledged);
    self->state = before < QUIESCE_STATE_COUNT ? next[before][event] : (uint8_t)FAULT;
    note_fault(self, in, event, before);
    return before == FAULT && self->state != FAULT;
}
