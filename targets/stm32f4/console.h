/// The board's serial line to a host.
#ifndef CONSOLE_H
#define CONSOLE_H

#include "clocks.h"
#include "uart_stm32f4.h"

extern hal_uart_t console;

/// Pins, rate and interrupt as the board's file says.
void console_open(const clocks_t *clocks);

#endif
