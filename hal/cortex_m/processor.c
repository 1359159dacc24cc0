#include "processor.h"

#define SCB_VTOR (*(volatile uint32_t *)0xE000ED08u)
#define SCB_AIRCR (*(volatile uint32_t *)0xE000ED0Cu)
#define AIRCR_RESET 0x05FA0004u ///< the key, and SYSRESETREQ

_Noreturn void processor_reset(void) {
    __asm__ volatile("dsb" ::: "memory");
    SCB_AIRCR = AIRCR_RESET;
    for (;;) {
        __asm__ volatile("dsb" ::: "memory");
    }
}

_Noreturn void processor_run(uint32_t vectors) {
    SCB_VTOR = vectors;
    // The first is the stack, the second where it begins.
    __asm__ volatile("dsb\n\t"
                     "isb\n\t"
                     "ldr r1, [%0]\n\t"
                     "ldr r2, [%0, #4]\n\t"
                     "msr msp, r1\n\t"
                     "bx r2"
                     :
                     : "r"(vectors)
                     : "r1", "r2", "memory");
    for (;;) {
    }
}
