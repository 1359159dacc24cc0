/// When each cyclic message is due: every GenMsgCycleTime from GenMsgStartDelayTime on, in whole
/// milliseconds of ticks. A tick that is longer than a cycle sends once.
#ifndef CAN_SCHEDULE_H
#define CAN_SCHEDULE_H

#include "quiesce_can_tables.h"

#ifdef __cplusplus
extern "C" {
#endif

typedef struct {
    uint32_t ticks_per_ms;                  ///< 1 or more
    uint32_t ms_per_tick;                   ///< of the ticks that begin a millisecond
    uint32_t tick;                          ///< in the millisecond
    uint32_t passed_ms;                     ///< with this tick
    uint16_t left_ms[QUIESCE_CAN_MESSAGES]; ///< until each is due
} can_schedule_t;

/// tick_rate_Hz: 500, 1000, 2000 or 4000, as parameters allow it.
void can_schedule_init(can_schedule_t *self, uint32_t tick_rate_Hz);

/// A tick: returns the milliseconds that it takes, 0 .. 2.
uint32_t can_schedule_tick(can_schedule_t *self);

/// Whether message QUIESCE_CAN_AT_.. is due in this tick. Ask once a tick for each that is cyclic.
bool can_schedule_is_due(can_schedule_t *self, uint32_t message);

#ifdef __cplusplus
}
#endif

#endif
