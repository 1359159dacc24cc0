#include "counted_call.h"

#include "stack.h"

#define STACK_WORDS 1024u

static _Alignas(8) uint32_t stack[STACK_WORDS];

void counted_call_init(void) {
    for (uint32_t i = 0; i < STACK_WORDS; i++) {
        stack[i] = STACK_PAINT;
    }
}

void counted_call(counted_function_t function, uintptr_t a, uintptr_t b, uintptr_t c) {
    register uintptr_t r0 __asm__("r0") = a;
    register uintptr_t r1 __asm__("r1") = b;
    register uintptr_t r2 __asm__("r2") = c;
    register counted_function_t r3 __asm__("r3") = function;
    register uint32_t *top __asm__("r5") = stack + STACK_WORDS;
    __asm__ volatile("mov r4, sp\n"
                     "mov sp, %[top]\n"
                     ".global quiesce_count_begin\nquiesce_count_begin:\n"
                     "blx r3\n"
                     ".global quiesce_count_end\nquiesce_count_end:\n"
                     "mov sp, r4\n"
                     : "+r"(r0), "+r"(r1), "+r"(r2), "+r"(r3)
                     : [top] "r"(top)
                     : "r4", "r12", "lr", "cc", "memory");
}

uint32_t counted_call_stack_bytes(void) {
    uint32_t unused = 0;
    while (unused < STACK_WORDS && stack[unused] == STACK_PAINT) {
        unused++;
    }
    return (STACK_WORDS - unused) * (uint32_t)sizeof stack[0];
}

uint32_t counted_call_stack_size_bytes(void) {
    return (uint32_t)sizeof stack;
}
