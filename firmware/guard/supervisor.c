#include "supervisor.h"

#define STATES 5

typedef enum {
    EVENT_NOTHING,
    EVENT_READY,   // healthy for long enough, not enabled
    EVENT_ENABLED, // healthy for long enough, enabled
    EVENT_CLEARING_FAULT,
    EVENT_LATCHED_FAULT,
    EVENT_ACKNOWLEDGED,
    EVENTS
} event_t;

// next[state][event]. Every entry is written out: a new state or event shows its gaps here.
static const uint8_t next[STATES][EVENTS] = {
    // Columns: nothing, ready, enabled, clearing fault, latched fault, acknowledged.
    [QUIESCE_STATE_INIT] = {QUIESCE_STATE_INIT, QUIESCE_STATE_IDLE, QUIESCE_STATE_IDLE,
                            QUIESCE_STATE_SAFE, QUIESCE_STATE_FAULT, QUIESCE_STATE_INIT},
    [QUIESCE_STATE_IDLE] = {QUIESCE_STATE_IDLE, QUIESCE_STATE_IDLE, QUIESCE_STATE_RUN,
                            QUIESCE_STATE_SAFE, QUIESCE_STATE_FAULT, QUIESCE_STATE_IDLE},
    [QUIESCE_STATE_RUN] = {QUIESCE_STATE_RUN, QUIESCE_STATE_IDLE, QUIESCE_STATE_RUN,
                           QUIESCE_STATE_SAFE, QUIESCE_STATE_FAULT, QUIESCE_STATE_RUN},
    [QUIESCE_STATE_SAFE] = {QUIESCE_STATE_SAFE, QUIESCE_STATE_IDLE, QUIESCE_STATE_IDLE,
                            QUIESCE_STATE_SAFE, QUIESCE_STATE_FAULT, QUIESCE_STATE_SAFE},
    [QUIESCE_STATE_FAULT] = {QUIESCE_STATE_FAULT, QUIESCE_STATE_FAULT, QUIESCE_STATE_FAULT,
                             QUIESCE_STATE_FAULT, QUIESCE_STATE_FAULT, QUIESCE_STATE_INIT},
};

void supervisor_init(supervisor_t *self, quiesce_fault_t first_fault) {
    const bool is_refused = first_fault != QUIESCE_FAULT_NONE;
    *self = (supervisor_t){
        .state = is_refused ? QUIESCE_STATE_FAULT : QUIESCE_STATE_INIT,
        .fault = first_fault,
        .fault_count = is_refused ? 1u : 0u,
    };
}

static event_t event_of(const supervisor_t *self, const supervisor_in_t *in, bool is_edge) {
    if (in->latched_fault != QUIESCE_FAULT_NONE) {
        return EVENT_LATCHED_FAULT;
    }
    if (self->state == QUIESCE_STATE_FAULT) {
        const bool may_leave = is_edge && self->fault != QUIESCE_FAULT_PARAMETER;
        return may_leave ? EVENT_ACKNOWLEDGED : EVENT_NOTHING;
    }
    if (in->clearing_fault != QUIESCE_FAULT_NONE) {
        return EVENT_CLEARING_FAULT;
    }
    // RUN ends at once when the operator lets go; everything else waits for a good sensor.
    if (self->state == QUIESCE_STATE_RUN && !in->enable) {
        return EVENT_READY;
    }
    if (!in->is_ready) {
        return EVENT_NOTHING;
    }
    return in->enable ? EVENT_ENABLED : EVENT_READY;
}

static bool is_faulted(quiesce_state_t state) {
    return state == QUIESCE_STATE_SAFE || state == QUIESCE_STATE_FAULT;
}

// What switches the driver off does so even where another latched fault already holds FAULT, and an
// emergency stop is always told; only refused parameters, which no acknowledgement may clear, keep
// their place.
static bool is_stop_on_top(const supervisor_t *self, const supervisor_in_t *in) {
    if (self->fault == QUIESCE_FAULT_PARAMETER || in->latched_fault == self->fault) {
        return false;
    }
    return in->latched_fault == QUIESCE_FAULT_ESTOP ||
           (supervisor_switches_off(in->latched_fault) && !supervisor_switches_off(self->fault));
}

bool supervisor_step(supervisor_t *self, const supervisor_in_t *in) {
    const bool is_edge = in->fault_reset && !self->last_fault_reset;
    self->last_fault_reset = in->fault_reset;

    const event_t event = event_of(self, in, is_edge);
    const quiesce_state_t state = (quiesce_state_t)next[self->state][event];
    if (!is_faulted(state)) {
        self->fault = QUIESCE_FAULT_NONE;
    } else if (state != self->state || is_stop_on_top(self, in)) {
        self->fault = event == EVENT_LATCHED_FAULT ? in->latched_fault : in->clearing_fault;
        self->fault_count = increment_sat_u32(self->fault_count);
    }
    self->state = state;
    return event == EVENT_ACKNOWLEDGED;
}
