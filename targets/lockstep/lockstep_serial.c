#include "lockstep_serial.h"

#include <stddef.h>

#include "slcan.h"

static uint8_t wait_for_byte(hal_uart_t *uart) {
    uint8_t byte = 0;
    while (!hal_uart_read(uart, &byte)) {
    }
    return byte;
}

static void send(hal_uart_t *uart, const can_frame_t *frame) {
    uint8_t text[SLCAN_MAX_BYTES];
    const size_t count = slcan_encode(frame, text);
    for (size_t i = 0; i < count; i++) {
        hal_uart_write(uart, text[i]);
    }
}

void lockstep_serial_serve(lockstep_can_t *server, hal_uart_t *uart) {
    static can_frame_t replies[LOCKSTEP_CAN_MAX_REPLIES];
    slcan_decoder_t decoder;
    slcan_decoder_init(&decoder);
    lockstep_can_init(server);
    lockstep_can_greet(server, &replies[0]);
    send(uart, &replies[0]);
    while (!server->is_stopped) {
        can_frame_t request;
        if (slcan_decode(&decoder, wait_for_byte(uart), &request)) {
            const uint32_t count = lockstep_can_receive(server, &request, replies);
            for (uint32_t i = 0; i < count; i++) {
                send(uart, &replies[i]);
            }
        }
    }
}
