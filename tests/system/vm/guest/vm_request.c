/* vm_request INTERFACE OPERATION INDEX VALUE: a service request; prints the reply's result and
 * value. The demand frames are its clock: without a reply it asks again after 500 of them, ends
 * with 1 after the fifth time. */
#include "guest_bus.h"

#include "quiesce_can.h"

#include <inttypes.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

enum { DEMAND = 0x010, REPLY = 0x408, PATIENCE_FRAMES = 500, ATTEMPTS = 5 };

static void ask(int bus, char **argv, uint8_t alive) {
    const struct quiesce_can_service_request_t request = {
        .operation = (uint8_t)guest_number(argv[2], 0, 255),
        .param_index = (uint8_t)guest_number(argv[3], 0, 255),
        .param_value = guest_number(argv[4], INT32_MIN, INT32_MAX)};
    can_frame_t frame = {.id = 0};
    quiesce_can_service_request_pack(frame.data, &request, sizeof frame.data);
    guest_protect(&frame, QUIESCE_CAN_AT_SERVICE_REQUEST, &alive);
    guest_bus_send(bus, &frame);
}

int main(int argc, char **argv) {
    static const uint32_t ids[] = {DEMAND, REPLY};
    guest_frame_t in;
    if (argc != 5) {
        return 2;
    }
    const int bus = guest_bus_open(argv[1], ids, 2);
    const uint8_t alive = (uint8_t)(getpid() % 16);
    for (uint32_t frames = 0; frames < ATTEMPTS * PATIENCE_FRAMES; frames++) {
        if (frames % PATIENCE_FRAMES == 0) {
            ask(bus, argv, alive);
        }
        do {
            if (!guest_bus_receive(bus, &in)) {
                guest_fail("the interface went down");
            }
            struct quiesce_can_service_reply_t reply;
            if (in.frame.id == REPLY &&
                quiesce_can_service_reply_unpack(&reply, in.frame.data, in.frame.length) == 0 &&
                reply.alive == alive) {
                printf("%u %" PRId32 "\n", (unsigned)reply.result, reply.param_value);
                return 0;
            }
        } while (in.frame.id != DEMAND);
    }
    return 1;
}
