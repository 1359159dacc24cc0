// Start-up of a Cortex-M image: vectors, then what all images have in common (start.h). No
// interrupt is used; every exception is a fault (fault.h).
#include "fault.h"
#include "start.h"

#include <stdint.h>

extern uint32_t stack_top[]; // placed by image.ld

void Reset_Handler(void);

__attribute__((section(".vectors"), used)) static const struct {
    const uint32_t *initial_sp;
    void (*handlers[15])(void);
} vectors = {
    stack_top,
    {Reset_Handler, fault_handler, fault_handler, fault_handler, fault_handler, fault_handler,
     fault_handler, fault_handler, fault_handler, fault_handler, fault_handler, fault_handler,
     fault_handler, fault_handler, fault_handler},
};

// In a build that passes floats in registers the compiler may keep integers there, too.
static void use_float_registers(void) {
#ifdef __ARM_PCS_VFP
    *(volatile uint32_t *)0xE000ED88u |= 0xFu << 20; // CPACR: coprocessors 10 and 11
    __asm__ volatile("dsb\nisb" ::: "memory");
#endif
}

void Reset_Handler(void) {
    use_float_registers();
    start_image();
}
