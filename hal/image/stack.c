#include "stack.h"

extern uint32_t stack_limit[]; // lowest word; image.ld
extern uint32_t stack_top[];   // one past the highest

uint32_t stack_high_water_bytes(void) {
    const uint32_t *word = stack_limit;
    while (word < stack_top && *word == STACK_PAINT) {
        word++;
    }
    return (uint32_t)(stack_top - word) * sizeof *word;
}

uint32_t stack_size_bytes(void) {
    return (uint32_t)(stack_top - stack_limit) * sizeof *stack_limit;
}
