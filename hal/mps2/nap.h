/// A short sleep of the processor, so that an image that waits for its host leaves it the machine.
#ifndef NAP_H
#define NAP_H

#include <stdint.h>

/// Sleeps for about time_us (1 .. 1000000), on TIMER1. No interrupt handler runs: its interrupt
/// only ends the sleep.
void nap_us(uint32_t time_us);

#endif
