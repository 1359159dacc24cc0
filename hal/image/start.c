#include "start.h"

#include <stdint.h>

#include "semihost.h"
#include "stack.h"

// Placed by image.ld.
extern uint32_t stack_limit[];
extern uint32_t data_load[], data_begin[], data_end[], bss_begin[], bss_end[];

int main(void);

static void copy_data(void) {
    const uint32_t *from = data_load;
    for (uint32_t *to = data_begin; to < data_end; to++) {
        *to = *from++;
    }
}

static void clear_bss(void) {
    for (uint32_t *word = bss_begin; word < bss_end; word++) {
        *word = 0;
    }
}

static void paint_stack(void) {
    register uint32_t *stack_pointer __asm__("sp");
    uint32_t *sp;
    // The register itself, which no compiler can know to have a value.
    // NOLINTNEXTLINE(clang-diagnostic-uninitialized)
    __asm__ volatile("" : "=r"(sp) : "0"(stack_pointer));
    for (volatile uint32_t *word = stack_limit; word < sp; word++) {
        *word = STACK_PAINT;
    }
}

_Noreturn void start_image(void) {
    paint_stack();
    copy_data();
    clear_bss();
    semihost_exit(main());
}
