// Start-up of an mps2-an386 image: vectors, memory, stack paint, main, exit with main's result.
// No interrupt is used; every exception is a fault (fault.h).
#include "fault.h"
#include "semihost.h"
#include "stack.h"

#include <stddef.h>

// Placed by mps2.ld.
extern uint32_t stack_limit[], stack_top[];
extern uint32_t data_load[], data_begin[], data_end[], bss_begin[], bss_end[];

int main(void);
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
    uint32_t *sp;
    __asm__ volatile("mov %0, sp" : "=r"(sp));
    for (volatile uint32_t *word = stack_limit; word < sp; word++) {
        *word = STACK_PAINT;
    }
}

void Reset_Handler(void) {
    paint_stack();
    copy_data();
    clear_bss();
    semihost_exit(main());
}
