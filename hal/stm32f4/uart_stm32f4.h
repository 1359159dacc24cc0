/// hal/uart.h on a USART: received by interrupt into a ring, sent byte by byte. Untested on
/// silicon; what to measure: docs/howto/stm32f4.md.
#ifndef UART_STM32F4_H
#define UART_STM32F4_H

#include "hal/uart.h"

#define UART_RING_BYTES 256u ///< 2.5 ms at 1 Mbaud

struct hal_uart {
    uint32_t base;
    volatile uint32_t put;      ///< bytes so far, by the interrupt
    volatile uint32_t taken;    ///< bytes so far, by hal_uart_read
    volatile uint32_t overruns; ///< bytes that were lost before they were read; saturates
    uint8_t ring[UART_RING_BYTES];
};

/// Switches the USART and its receive interrupt on, 8N1. base: USART1_BASE .. USART3_BASE, its pins
/// and its vector are the board's. clock_Hz: of its bus; the divider is rounded. baud: up to a
/// sixteenth of the clock.
void uart_stm32f4_open(hal_uart_t *uart, uint32_t base, uint32_t clock_Hz, uint32_t baud);

/// What the USART's vector calls.
void uart_stm32f4_interrupt(hal_uart_t *uart);

/// Whether hal_uart_read has a byte.
bool uart_stm32f4_has_come(const hal_uart_t *uart);

/// Whether hal_uart_write would not wait.
bool uart_stm32f4_is_free(const hal_uart_t *uart);

#endif
