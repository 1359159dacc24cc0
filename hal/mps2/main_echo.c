// Raw echo on UART0: every byte goes back at once. The bench measures the UART's own rate with it.
#include "uart_mps2.h"

int main(void) {
    hal_uart_t uart;
    uart_mps2_open(&uart, CMSDK_UART0, 1000000u);
    for (;;) {
        uint8_t byte;
        if (hal_uart_read(&uart, &byte)) {
            hal_uart_write(&uart, byte);
        }
    }
}
