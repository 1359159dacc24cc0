// From reset to main; main's result goes to the debugger, or to QEMU, by semihosting.
#include <stdint.h>

extern uint32_t bss_begin[], bss_end[], stack_top[]; // of link.ld

int main(void);
void start(void);

__attribute__((section(".vectors"), used)) static const struct {
    const uint32_t *stack;
    void (*reset)(void);
} vectors = {stack_top, start};

void start(void) {
    for (uint32_t *word = bss_begin; word < bss_end; word++) {
        *word = 0;
    }
    // SYS_EXIT_EXTENDED with ADP_Stopped_ApplicationExit.
    const uint32_t ended[2] = {0x20026u, (uint32_t)main()};
    register uint32_t operation __asm__("r0") = 0x20u;
    register const uint32_t *parameter __asm__("r1") = ended;
    __asm__ volatile("bkpt 0xAB" : : "r"(operation), "r"(parameter) : "memory");
    for (;;) {
    }
}
