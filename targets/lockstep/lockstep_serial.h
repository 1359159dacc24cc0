/// The lock-step server on a serial line: its messages as SLCAN frames.
#ifndef LOCKSTEP_SERIAL_H
#define LOCKSTEP_SERIAL_H

#include "hal/uart.h"
#include "lockstep_can.h"

/// Greets, then serves one bench until that tells it to stop. server: the caller's, of any content.
void lockstep_serial_serve(lockstep_can_t *server, hal_uart_t *uart);

#endif
