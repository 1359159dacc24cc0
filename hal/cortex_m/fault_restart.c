#include "fault.h"

#define SCB_AIRCR (*(volatile uint32_t *)0xE000ED0Cu)
#define AIRCR_RESET 0x05FA0004u ///< the key, and SYSRESETREQ

_Noreturn void fault_restart(void) {
    __asm__ volatile("dsb" ::: "memory");
    if (cpu_fault.count <= FAULT_MOST_RESTARTS) {
        SCB_AIRCR = AIRCR_RESET;
    }
    fault_stay_silent();
}

_Noreturn void fault_stay_silent(void) {
    for (;;) {
        __asm__ volatile("wfi");
    }
}
