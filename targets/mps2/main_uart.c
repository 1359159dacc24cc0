// Lock-step image for the UART link: SLCAN frames on UART0, until it is told to stop.
#include "lockstep_can.h"
#include "slcan.h"
#include "uart_mps2.h"

#include <stddef.h>

#define UART_BAUD 1000000u

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

int main(void) {
    static lockstep_can_t server;
    static can_frame_t replies[LOCKSTEP_CAN_MAX_REPLIES];
    slcan_decoder_t decoder;
    hal_uart_t uart;

    uart_mps2_open(&uart, CMSDK_UART0, UART_BAUD);
    slcan_decoder_init(&decoder);
    lockstep_can_init(&server);
    lockstep_can_greet(&server, &replies[0]);
    send(&uart, &replies[0]);
    while (!server.is_stopped) {
        can_frame_t request;
        if (slcan_decode(&decoder, wait_for_byte(&uart), &request)) {
            const uint32_t count = lockstep_can_receive(&server, &request, replies);
            for (uint32_t i = 0; i < count; i++) {
                send(&uart, &replies[i]);
            }
        }
    }
    return 0;
}
