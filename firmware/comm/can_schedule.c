#include "can_schedule.h"

void can_schedule_init(can_schedule_t *self, uint32_t tick_rate_Hz) {
    *self = (can_schedule_t){
        .ticks_per_ms = tick_rate_Hz > 1000u ? tick_rate_Hz / 1000u : 1u,
        .ms_per_tick = tick_rate_Hz < 1000u ? 1000u / tick_rate_Hz : 1u,
    };
    for (uint32_t i = 0; i < QUIESCE_CAN_MESSAGES; i++) {
        self->left_ms[i] = quiesce_can_messages[i].start_ms;
    }
}

uint32_t can_schedule_tick(can_schedule_t *self) {
    self->passed_ms = self->tick == 0u ? self->ms_per_tick : 0u;
    self->tick = self->tick + 1u < self->ticks_per_ms ? self->tick + 1u : 0u;
    return self->passed_ms;
}

bool can_schedule_is_due(can_schedule_t *self, uint32_t message) {
    const uint32_t passed_ms = self->passed_ms;
    const bool is_due = self->left_ms[message] < passed_ms;
    uint32_t left_ms = self->left_ms[message];
    if (is_due) {
        left_ms += quiesce_can_messages[message].cycle_ms;
    }
    self->left_ms[message] = (uint16_t)(left_ms > passed_ms ? left_ms - passed_ms : 0u);
    return is_due;
}
