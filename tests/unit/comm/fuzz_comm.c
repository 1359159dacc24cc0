// libFuzzer: any bytes on the UART. Whatever arrives, replies are well-formed frames, at most
// LOCKSTEP_CAN_MAX_REPLIES, and a tick runs only for an answered stimulus.
#include "lockstep_can.h"
#include "slcan.h"

#include <stddef.h>
#include <stdlib.h>

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t count);

static void require(bool holds) {
    if (!holds) {
        abort();
    }
}

static void check_replies(const can_frame_t *replies, uint32_t count) {
    uint8_t text[SLCAN_MAX_BYTES];
    require(count <= LOCKSTEP_CAN_MAX_REPLIES);
    for (uint32_t i = 0; i < count; i++) {
        require(slcan_encode(&replies[i], text) > 0);
    }
}

static uint32_t commands_in(const can_frame_t *replies, uint32_t count) {
    uint32_t commands = 0;
    for (uint32_t i = 0; i < count; i++) {
        commands += replies[i].id == QUIESCE_CAN_LOCKSTEP_COMMAND_FRAME_ID ? 1u : 0u;
    }
    return commands;
}

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t count) {
    static lockstep_can_t server;
    static can_frame_t replies[LOCKSTEP_CAN_MAX_REPLIES];
    slcan_decoder_t decoder;
    can_frame_t frame;

    slcan_decoder_init(&decoder);
    lockstep_can_init(&server);
    for (size_t i = 0; i < count; i++) {
        if (slcan_decode(&decoder, bytes[i], &frame)) {
            const uint8_t sequence = server.sequence;
            const bool was_started = server.is_started;
            const uint32_t sent = lockstep_can_receive(&server, &frame, replies);
            check_replies(replies, sent);
            const bool has_ticked = was_started && server.is_started &&
                                    frame.id == QUIESCE_CAN_LOCKSTEP_STIMULUS_FRAME_ID &&
                                    server.sequence != sequence;
            require(commands_in(replies, sent) == (has_ticked ? 1u : 0u));
        }
    }
    return 0;
}
