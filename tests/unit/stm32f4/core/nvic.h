/// In the place of hal/cortex_m/nvic.h on this machine: what a test sees of the core's interrupts.
#ifndef NVIC_H
#define NVIC_H

#include <stdint.h>

extern uint32_t fake_nvic_enabled[8]; ///< a bit an interrupt
extern int32_t fake_nvic_held;

static inline void nvic_enable(uint32_t number, uint32_t priority) {
    (void)priority;
    fake_nvic_enabled[number / 32u] |= 1u << (number % 32u);
}

static inline void nvic_hold(void) {
    fake_nvic_held++;
}

static inline void nvic_release(void) {
    fake_nvic_held--;
}

#endif
