// Start-up of a 32-bit RISC-V image: stack and trap vector, then what all images have in common
// (start.h). No interrupt is used; every trap is a fault and ends the emulator.
#include "semihost.h"
#include "start.h"

/// Exit code of an image that a fault has ended: hal/cortex_m/fault.h has the same.
#define FAULT_EXIT_CODE 99

void Reset_Handler(void);

static void put_named(const char *name, uint32_t value) {
    semihost_put_text(name);
    semihost_put_hex(value);
}

__attribute__((used)) _Noreturn static void take_fault(uint32_t cause, uint32_t pc,
                                                       uint32_t value) {
    put_named("image fault: cause 0x", cause);
    put_named(" pc 0x", pc);
    put_named(" value 0x", value);
    semihost_put_char('\n');
    semihost_exit(FAULT_EXIT_CODE);
}

// The stack may be what is wrong: begins it anew.
__attribute__((naked, used, aligned(4))) static void fault_handler(void) {
    __asm__ volatile(".option push\n"
                     ".option arch, +zicsr\n"
                     "la sp, stack_top\n"
                     "csrr a0, mcause\n"
                     "csrr a1, mepc\n"
                     "csrr a2, mtval\n"
                     "j take_fault\n"
                     ".option pop\n");
}

// The three instructions by which the emulator knows the call: uncompressed, and within a page.
void semihost_trap(uint32_t operation, const void *argument) {
    register uint32_t a0 __asm__("a0") = operation;
    register const void *a1 __asm__("a1") = argument;
    __asm__ volatile(".option push\n"
                     ".option norvc\n"
                     ".balign 16\n"
                     "slli x0, x0, 0x1f\n"
                     "ebreak\n"
                     "srai x0, x0, 7\n"
                     ".option pop\n"
                     : "+r"(a0)
                     : "r"(a1)
                     : "memory");
}

__attribute__((section(".vectors"), used, naked)) void Reset_Handler(void) {
    __asm__ volatile(".option push\n"
                     ".option arch, +zicsr\n"
                     "la sp, stack_top\n"
                     "la t0, fault_handler\n"
                     "csrw mtvec, t0\n"
                     "j start_image\n"
                     ".option pop\n");
}
