/// Frames that wait for a serial line, as SLCAN lines: nobody waits for the host. What finds no
/// room is dropped and counted.
#ifndef FRAME_QUEUE_H
#define FRAME_QUEUE_H

#include "can_node.h"

/// Some 25 ms of frames: an older demand is of no use to a driver.
#define FRAME_QUEUE_BYTES 512u

typedef struct {
    uint8_t bytes[FRAME_QUEUE_BYTES];
    uint32_t first;
    uint32_t count;
    can_unsent_t unsent;
} frame_queue_t;

/// Ends a line that something has cut off. There must be room.
void frame_queue_break(frame_queue_t *queue);

void frame_queue_put(frame_queue_t *queue, const can_frame_t *frame);

/// The next byte. Returns false iff nothing waits.
bool frame_queue_take(frame_queue_t *queue, uint8_t *byte);

#endif
