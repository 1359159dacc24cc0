/// Byte stream to a host: SLCAN frames travel on it.
#ifndef HAL_UART_H
#define HAL_UART_H

#include <stdbool.h>
#include <stdint.h>

typedef struct hal_uart hal_uart_t;

/// One received byte; written only where the function returns true. Never blocks.
/// Returns false iff nothing has arrived.
bool hal_uart_read(hal_uart_t *uart, uint8_t *byte);

/// Sends one byte; waits while the transmit register is full (bounded by one byte time).
void hal_uart_write(hal_uart_t *uart, uint8_t byte);

#endif
