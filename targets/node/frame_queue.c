#include "frame_queue.h"

#include "slcan.h"

static void put(frame_queue_t *queue, uint8_t byte) {
    queue->bytes[(queue->first + queue->count) % FRAME_QUEUE_BYTES] = byte;
    queue->count++;
}

void frame_queue_break(frame_queue_t *queue) {
    put(queue, '\r');
}

void frame_queue_put(frame_queue_t *queue, const can_frame_t *frame) {
    uint8_t text[SLCAN_MAX_BYTES];
    const size_t length = slcan_encode(frame, text);
    if (length > FRAME_QUEUE_BYTES - queue->count) {
        can_unsent_count(&queue->unsent, frame->id);
        return;
    }
    for (size_t i = 0; i < length; i++) {
        put(queue, text[i]);
    }
}

bool frame_queue_take(frame_queue_t *queue, uint8_t *byte) {
    if (queue->count == 0u) {
        return false;
    }
    *byte = queue->bytes[queue->first];
    queue->first = (queue->first + 1u) % FRAME_QUEUE_BYTES;
    queue->count--;
    return true;
}
