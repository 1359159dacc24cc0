#include "fault.h"

#include <stddef.h>

extern uint32_t stack_limit[], stack_top[]; // placed by image.ld

#define FRAME_WORDS 8 // that an exception stacks

_Noreturn void fault_take(const uint32_t *stacked); // called by the assembly below only

__attribute__((used)) _Noreturn void fault_take(const uint32_t *stacked) {
    const bool is_in_stack = stacked >= stack_limit && stacked + FRAME_WORDS <= stack_top;
    fault_keep(is_in_stack ? stacked : NULL);
    fault_react();
}

// The stack may be what is wrong: begins it anew.
__attribute__((naked)) void fault_handler(void) {
    __asm__ volatile("mov r0, sp\n"
                     "ldr r1, =stack_top\n"
                     "mov sp, r1\n"
                     "b fault_take\n");
}
