// Raw echo on UART0: a line goes back as soon as its CR has come. The bench measures with it what
// the UART itself can do: the same bytes and turn-round as an exchange, and no work between. A CR
// of its own says that it listens.
#include "uart_mps2.h"

#define LINE_BYTES 64u

int main(void) {
    hal_uart_t uart;
    uint8_t line[LINE_BYTES];
    uint32_t count = 0;

    uart_mps2_open(&uart, CMSDK_UART0, 1000000u);
    hal_uart_write(&uart, '\r');
    for (;;) {
        if (!hal_uart_read(&uart, &line[count])) {
            continue;
        }
        count++;
        if (line[count - 1u] == '\r' || count == LINE_BYTES) {
            for (uint32_t i = 0; i < count; i++) {
                hal_uart_write(&uart, line[i]);
            }
            count = 0;
        }
    }
}
