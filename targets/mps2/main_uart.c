// Lock-step image for the UART link: SLCAN frames on UART0, until it is told to stop.
#include "lockstep_serial.h"
#include "uart_mps2.h"

#define UART_BAUD 1000000u

int main(void) {
    static lockstep_can_t server;
    hal_uart_t uart;
    uart_mps2_open(&uart, CMSDK_UART0, UART_BAUD);
    lockstep_serial_serve(&server, &uart);
    return 0;
}
