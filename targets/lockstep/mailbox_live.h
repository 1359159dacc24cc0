/// Mailbox of an image whose controller has its CAN interface: the plain one, and after it the bus.
///
/// MAILBOX_STEP takes the frames that have come before the tick and returns those that it sends;
/// MAILBOX_STOP returns the last ones, safe currents and drivers off.
#ifndef MAILBOX_LIVE_H
#define MAILBOX_LIVE_H

#include "lockstep_node.h"
#include "mailbox.h"

/// Frames of a tick, each way: a bus of 1 Mbit/s has a quarter of them in one of 10 ms.
#define MAILBOX_MAX_FRAMES 256u

typedef struct {
    mailbox_t plain;
    lockstep_pace_t pace;  ///< of this tick
    uint32_t tick_rate_Hz; ///< after it: somebody on the bus may change it
    uint32_t heard;
    uint32_t said;
    can_frame_t heard_frame[MAILBOX_MAX_FRAMES];
    can_frame_t said_frame[MAILBOX_MAX_FRAMES];
} mailbox_live_t;

#endif
