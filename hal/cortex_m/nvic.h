/// Interrupts of an ARMv7-M core (ARMv7-M Architecture Reference Manual, B3.4).
#ifndef NVIC_H
#define NVIC_H

#include <stdint.h>

/// number: of the interrupt, 0 .. 239. priority: 0 is the highest; a chip has the upper bits only.
static inline void nvic_enable(uint32_t number, uint32_t priority) {
    ((volatile uint8_t *)0xE000E400u)[number] = (uint8_t)priority;
    ((volatile uint32_t *)0xE000E100u)[number / 32u] = 1u << (number % 32u);
}

static inline void nvic_hold(void) {
    __asm__ volatile("cpsid i" ::: "memory");
}

static inline void nvic_release(void) {
    __asm__ volatile("cpsie i" ::: "memory");
}

#endif
