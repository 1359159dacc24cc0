#include "uart_mps2.h"

void uart_mps2_open(hal_uart_t *uart, cmsdk_uart_t *registers, uint32_t baud) {
    uart->registers = registers;
    uart->overruns = 0;
    registers->baud_divider = CMSDK_CLOCK_HZ / baud;
    registers->control = CMSDK_UART_CONTROL_TX_ENABLE | CMSDK_UART_CONTROL_RX_ENABLE;
    // Drops what came before; and QEMU looks at its line again only when the register is read (it
    // would otherwise notice the next byte up to a second late).
    (void)registers->data;
}

static void count_overrun(hal_uart_t *uart) {
    if ((uart->registers->state & CMSDK_UART_STATE_RX_OVERRUN) != 0) {
        uart->registers->state = CMSDK_UART_STATE_RX_OVERRUN;
        uart->overruns += uart->overruns < UINT32_MAX ? 1u : 0u;
    }
}

bool hal_uart_read(hal_uart_t *uart, uint8_t *byte) {
    count_overrun(uart);
    if ((uart->registers->state & CMSDK_UART_STATE_RX_FULL) == 0) {
        return false;
    }
    *byte = (uint8_t)uart->registers->data;
    return true;
}

void hal_uart_write(hal_uart_t *uart, uint8_t byte) {
    while ((uart->registers->state & CMSDK_UART_STATE_TX_FULL) != 0) {
    }
    uart->registers->data = byte;
}
