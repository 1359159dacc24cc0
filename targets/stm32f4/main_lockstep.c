// The controller of a board behind a bench: it takes a tick for each stimulus that comes as a SLCAN
// frame on the console (lockstep_can.h), with the bench's samples. The board's own sensor and
// output are not used: the output stage stays off.
#include "board.h"
#include "clocks.h"
#include "console.h"
#include "lockstep_can.h"
#include "safe.h"
#include "slcan.h"

#include <stddef.h>

static uint8_t wait_for_byte(void) {
    uint8_t byte = 0;
    while (!hal_uart_read(&console, &byte)) {
    }
    return byte;
}

static void send(const can_frame_t *frame) {
    uint8_t text[SLCAN_MAX_BYTES];
    const size_t count = slcan_encode(frame, text);
    for (size_t i = 0; i < count; i++) {
        hal_uart_write(&console, text[i]);
    }
}

// One bench after the other: what stops this one waits for the next.
int main(void) {
    static lockstep_can_t server;
    static can_frame_t replies[LOCKSTEP_CAN_MAX_REPLIES];
    clocks_t clocks;
    slcan_decoder_t decoder;
    safe_outputs();
    clocks_start(&clocks, stm32f4_board.crystal_Hz, stm32f4_board.crystal_is_external);
    console_open(&clocks);
    slcan_decoder_init(&decoder);
    lockstep_can_init(&server);
    lockstep_can_greet(&server, &replies[0]);
    send(&replies[0]);
    for (;;) {
        can_frame_t request;
        if (slcan_decode(&decoder, wait_for_byte(), &request)) {
            const uint32_t count = lockstep_can_receive(&server, &request, replies);
            for (uint32_t i = 0; i < count; i++) {
                send(&replies[i]);
            }
        }
    }
}
