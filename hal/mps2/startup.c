// Start-up of a Cortex-M image: vectors, then what all images have in common (start.h). No
// interrupt is used; every exception is a fault (fault.h).
#include "fault.h"
#include "semihost.h"
#include "start.h"

#include <stddef.h>

extern uint32_t stack_limit[], stack_top[]; // placed by image.ld

void Reset_Handler(void);

#define FRAME_WORDS 8 // that an exception stacks

__attribute__((used)) _Noreturn static void take_fault(const uint32_t *stacked) {
    const bool is_in_stack = stacked >= stack_limit && stacked + FRAME_WORDS <= stack_top;
    fault_keep(is_in_stack ? stacked : NULL);
    fault_react();
}

// The stack may be what is wrong: begins it anew.
__attribute__((naked)) static void fault_handler(void) {
    __asm__ volatile("mov r0, sp\n"
                     "ldr r1, =stack_top\n"
                     "mov sp, r1\n"
                     "b take_fault\n");
}

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

void semihost_trap(uint32_t operation, const void *argument) {
    register uint32_t r0 __asm__("r0") = operation;
    register const void *r1 __asm__("r1") = argument;
    __asm__ volatile("bkpt 0xab" : "+r"(r0) : "r"(r1) : "memory");
}

void Reset_Handler(void) {
    use_float_registers();
    start_image();
}
