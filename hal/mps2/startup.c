// Start-up of an mps2-an386 image: vectors, memory, stack paint, main, exit with main's result.
// No interrupt is used; every exception reports where it happened and ends the image.
#include "semihost.h"
#include "stack.h"

#include <stdint.h>

// Placed by mps2.ld.
extern uint32_t stack_limit[], stack_top[];
extern uint32_t data_load[], data_begin[], data_end[], bss_begin[], bss_end[];

int main(void);
void Reset_Handler(void);
void fault_report(const uint32_t *stacked);

#define SCB_CFSR (*(const volatile uint32_t *)0xE000ED28u) ///< configurable fault status
#define SCB_HFSR (*(const volatile uint32_t *)0xE000ED2Cu) ///< hard fault status

/// The words that an exception stacks: r0 r1 r2 r3 r12 lr pc xpsr.
enum { STACKED_LR = 5, STACKED_PC = 6, STACKED_XPSR = 7 };

static void put_named(const char *name, uint32_t value) {
    semihost_put_text(name);
    semihost_put_hex(value);
}

__attribute__((used)) void fault_report(const uint32_t *stacked) {
    uint32_t exception;
    __asm__ volatile("mrs %0, ipsr" : "=r"(exception));
    put_named("image fault: exception 0x", exception);
    put_named(" pc 0x", stacked[STACKED_PC]);
    put_named(" lr 0x", stacked[STACKED_LR]);
    put_named(" xpsr 0x", stacked[STACKED_XPSR]);
    put_named(" cfsr 0x", SCB_CFSR);
    put_named(" hfsr 0x", SCB_HFSR);
    semihost_put_char('\n');
    semihost_exit(SEMIHOST_EXIT_FAULT);
}

__attribute__((naked)) static void fault_handler(void) {
    __asm__ volatile("mov r0, sp\n"
                     "b fault_report\n");
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
