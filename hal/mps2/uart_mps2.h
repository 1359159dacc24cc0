/// hal/uart.h on a CMSDK UART, polled.
#ifndef UART_MPS2_H
#define UART_MPS2_H

#include "cmsdk.h"
#include "hal/uart.h"

struct hal_uart {
    cmsdk_uart_t *registers;
    uint32_t overruns; ///< times that bytes were lost before they were read; saturates
};

/// Switches the UART on, 8N1. baud: up to 1562500 (the clock over 16); the divider rounds down.
void uart_mps2_open(hal_uart_t *uart, cmsdk_uart_t *registers, uint32_t baud);

#endif
