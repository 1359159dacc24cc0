/* vm_flood INTERFACE FRAMES: what a hostile or broken node sends, as fast as the interface takes
 * it: the controller's own input messages with a wrong CRC, a counter that stands still, a wrong
 * length, as remote and as 29-bit frames, ids that nobody knows, and bit patterns of a fixed
 * pseudo-random sequence. */
#include "guest_bus.h"

#include "e2e.h"

#include <string.h>

enum { KINDS = 7 };

static uint32_t next_random(uint32_t *state) {
    *state = *state * 1664525u + 1013904223u;
    return *state >> 8;
}

static void random_frame(can_frame_t *frame, uint32_t *random) {
    frame->id = next_random(random) & CAN_MAX_STANDARD_ID;
    frame->length = (uint8_t)(next_random(random) % (CAN_MAX_BYTES + 1u));
    for (uint32_t i = 0; i < CAN_MAX_BYTES; i++) {
        frame->data[i] = (uint8_t)next_random(random);
    }
}

static void flood_frame(can_frame_t *frame, uint32_t number, uint32_t *random) {
    uint8_t alive = 0;
    guest_sample(frame, 1000, &alive);
    switch (number % KINDS) {
    case 0: /* a sample with a wrong CRC */
        frame->data[frame->length - 1] ^= 0x55;
        break;
    case 1: /* a command with a wrong CRC that would take the enable away */
        guest_command(frame, false, false, &alive);
        frame->data[frame->length - 1] ^= 0xAA;
        break;
    case 2: /* too short */
        frame->length--;
        break;
    case 3:
        frame->is_remote = true;
        break;
    case 4:
        frame->is_extended = true;
        break;
    case 5: /* an emergency stop with a wrong CRC */
        frame->id = quiesce_can_messages[QUIESCE_CAN_AT_EMERGENCY_STOP].e2e.id;
        frame->length = quiesce_can_messages[QUIESCE_CAN_AT_EMERGENCY_STOP].e2e.length;
        break;
    default:
        random_frame(frame, random);
        break;
    }
}

int main(int argc, char **argv) {
    if (argc != 3) {
        return 2;
    }
    const uint32_t frames = (uint32_t)guest_number(argv[2], 1, 10000000);
    const int bus = guest_bus_open(argv[1], NULL, 0);
    uint32_t random = 1;
    for (uint32_t i = 0; i < frames; i++) {
        can_frame_t frame;
        flood_frame(&frame, i, &random);
        if (!guest_bus_send(bus, &frame)) {
            guest_fail("the interface went down");
        }
    }
    return 0;
}
