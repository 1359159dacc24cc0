#include "supervisor.h"

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
#define SELF_TEST QUIESCE_STATE_SELF_TEST
#define IDLE QUIESCE_STATE_IDLE
#define ARMED QUIESCE_STATE_ARMED
#define RUN QUIESCE_STATE_RUN
#define DEGRADED QUIESCE_STATE_DEGRADED
#define SAFE QUIESCE_STATE_SAFE
#define FAULT QUIESCE_STATE_FAULT

// next[state][event]. Every entry is written out: a new state or event shows its gaps here.
static const uint8_t next[QUIESCE_STATE_COUNT][EVENTS] = {
    // Columns: nothing, ready, armed, go, limited, clearing fault, latched fault.
    [INIT] = {SELF_TEST, SELF_TEST, SELF_TEST, SELF_TEST, SELF_TEST, SAFE, FAULT},
    [SELF_TEST] = {SELF_TEST, IDLE, SELF_TEST, ARMED, ARMED, SAFE, FAULT},
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
        .flags = SUPERVISOR_WAS_ENABLED | SUPERVISOR_WAS_RESET,
    };
}

static bool is_final(uint32_t fault) {
    return fault == QUIESCE_FAULT_PARAMETER || fault == QUIESCE_FAULT_MEMORY;
}

typedef struct {
    bool has_risen;       ///< enable
    bool is_acknowledged; ///< fault reset has risen
} edges_t;

static uint8_t flag(uint32_t which, bool is_set) {
    return (uint8_t)(is_set ? which : 0u);
}

static edges_t follow_inputs(supervisor_t *self, const supervisor_in_t *in) {
    const edges_t edges = {
        .has_risen = in->enable && (self->flags & SUPERVISOR_WAS_ENABLED) == 0u,
        .is_acknowledged = in->fault_reset && (self->flags & SUPERVISOR_WAS_RESET) == 0u,
    };
    self->flags = (uint8_t)((self->flags & (SUPERVISOR_ARMED | SUPERVISOR_TESTED)) |
                            flag(SUPERVISOR_WAS_ENABLED, in->enable) |
                            flag(SUPERVISOR_WAS_RESET, in->fault_reset));
    return edges;
}

static void set(supervisor_t *self, uint32_t which, bool is_set) {
    self->flags = (uint8_t)((self->flags & ~which) | flag(which, is_set));
}

static void arm(supervisor_t *self, bool enable, bool has_risen) {
    const bool may_arm = self->state == INIT || self->state == SELF_TEST || self->state == IDLE;
    set(self, SUPERVISOR_ARMED, enable && (supervisor_is_armed(self) || (has_risen && may_arm)));
}

// A clearing fault does not end the test, nor does it undo it.
static void note_test(supervisor_t *self) {
    const bool is_before = self->state == INIT || self->state == SELF_TEST || self->state == FAULT;
    const bool has_passed = !is_before && self->state != SAFE;
    set(self, SUPERVISOR_TESTED, has_passed || (supervisor_is_tested(self) && !is_before));
}

static event_t event_of(const supervisor_t *self, const supervisor_in_t *in, bool is_acknowledged) {
    const bool stays = self->state == FAULT && (!is_acknowledged || is_final(self->fault));
    if (stays || in->latched_fault != QUIESCE_FAULT_NONE) {
        return EVENT_LATCHED_FAULT;
    }
    if (in->clearing_fault != QUIESCE_FAULT_NONE) {
        return EVENT_CLEARING_FAULT;
    }
    if (!supervisor_is_armed(self)) {
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
    const uint32_t before = self->state;
    const edges_t edges = follow_inputs(self, in);
    arm(self, in->enable, edges.has_risen);
    const event_t event = event_of(self, in, edges.is_acknowledged);
    self->state = before < QUIESCE_STATE_COUNT ? next[before][event] : (uint8_t)FAULT;
    set(self, SUPERVISOR_ARMED, supervisor_is_armed(self) && self->state != FAULT);
    note_test(self);
    note_fault(self, in, event, before);
    return before == FAULT && self->state != FAULT;
}
