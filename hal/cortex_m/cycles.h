/// The cycle counter of an ARMv7-M core (ARMv7-M Architecture Reference Manual, C1.8).
#ifndef CYCLES_H
#define CYCLES_H

#include <stdbool.h>
#include <stdint.h>

/// Of the core's clock, wrapping; it stands still where there is no counter.
static inline uint32_t cycles_count(void) {
    return *(volatile uint32_t *)0xE0001004u;
}

/// Returns whether it counts: an implementation may lack it, and emulators do.
static inline bool cycles_start(void) {
    *(volatile uint32_t *)0xE000EDFCu |= 1u << 24; // DEMCR.TRCENA: the unit has its clock
    *(volatile uint32_t *)0xE0001000u |= 1u;       // DWT_CTRL.CYCCNTENA
    const uint32_t before = cycles_count();
    __asm__ volatile("dsb" ::: "memory");
    return cycles_count() != before;
}

#endif
