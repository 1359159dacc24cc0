#include "idle.h"

#define SYSTICK_CONTROL (*(volatile uint32_t *)0xE000E010u)
#define SYSTICK_RELOAD (*(volatile uint32_t *)0xE000E014u)
#define SYSTICK_COUNT (*(volatile uint32_t *)0xE000E018u)
#define SYSTICK_ON 7u // of the core's clock, with its exception
#define SYSTICK_MOST 0x00FFFFFFu
#define SCB_ICSR (*(volatile uint32_t *)0xE000ED04u)
#define ICSR_FORGET_SYSTICK (1u << 25)

void idle_cycles(uint32_t cycles) {
    if (cycles == 0u || cycles > SYSTICK_MOST) {
        return;
    }
    SYSTICK_RELOAD = cycles;
    SYSTICK_COUNT = 0; // it begins with the reload
    SYSTICK_CONTROL = SYSTICK_ON;
    __asm__ volatile("dsb\nwfi" ::: "memory");
    SYSTICK_CONTROL = 0;
    SCB_ICSR = ICSR_FORGET_SYSTICK; // it is never taken
}
