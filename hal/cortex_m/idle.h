/// Sleep of an ARMv7-M core (ARMv7-M Architecture Reference Manual, B1.5.18; SysTick: B3.3).
#ifndef IDLE_H
#define IDLE_H

#include <stdint.h>

/// With interrupts held (nvic_hold): sleeps until one is pending or these cycles of the core's
/// clock are over, 1 .. 16777215; others: no sleep. It takes none: that is nvic_release's. Uses
/// SysTick.
void idle_cycles(uint32_t cycles);

#endif
