/* vm_echo INTERFACE ID FRAMES: sends FRAMES frames of ID back under ID + 1, then ends. Who sends
 * them paces himself by what comes back. Ends with 1 where one is missing: the first four data
 * bytes count them. */
#include "guest_bus.h"

#include <inttypes.h>
#include <stdio.h>

static uint32_t number_of(const can_frame_t *frame) {
    return (uint32_t)frame->data[0] | (uint32_t)frame->data[1] << 8 |
           (uint32_t)frame->data[2] << 16 | (uint32_t)frame->data[3] << 24;
}

int main(int argc, char **argv) {
    if (argc != 4) {
        return 2;
    }
    const uint32_t id = (uint32_t)guest_number(argv[2], 0, 0x7FE);
    const uint32_t frames = (uint32_t)guest_number(argv[3], 1, 1000000);
    const int bus = guest_bus_open(argv[1], &id, 1);
    printf("ECHO-READY\n");
    fflush(stdout);
    for (uint32_t i = 0; i < frames; i++) {
        guest_frame_t in;
        if (!guest_bus_receive(bus, &in)) {
            guest_fail("the interface went down");
        }
        if (number_of(&in.frame) != i) {
            fprintf(stderr, "frame %" PRIu32 " instead of %" PRIu32 "\n", number_of(&in.frame), i);
            return 1;
        }
        in.frame.id = id + 1;
        if (!guest_bus_send(bus, &in.frame)) {
            guest_fail("the interface went down");
        }
    }
    return 0;
}
