#include "nap.h"

#include "cmsdk.h"

#define TIMER1_INTERRUPT (1u << 9)
#define NVIC_ENABLE (*(volatile uint32_t *)0xE000E100u)
#define NVIC_CLEAR_PENDING (*(volatile uint32_t *)0xE000E280u)

void nap_us(uint32_t time_us) {
    cmsdk_timer_t *const timer = CMSDK_TIMER1;
    __asm__ volatile("cpsid i"); // a pending interrupt wakes the processor and is not taken
    NVIC_ENABLE = TIMER1_INTERRUPT;
    timer->reload = 0;
    timer->value = time_us * (CMSDK_CLOCK_HZ / 1000000u);
    timer->control = CMSDK_TIMER_CONTROL_ENABLE | CMSDK_TIMER_CONTROL_INTERRUPT;
    while (timer->interrupt == 0) {
        __asm__ volatile("wfi");
    }
    timer->control = 0;
    timer->interrupt = 1; // clears it
    NVIC_CLEAR_PENDING = TIMER1_INTERRUPT;
    __asm__ volatile("cpsie i");
}
