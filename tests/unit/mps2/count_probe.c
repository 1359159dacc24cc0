// Calls of a known number of instructions between the markers: pass i runs a loop of `turns` + i
// turns, the last one digs into the stack. The instruction counter's own test runs it.
#include "counted_call.h"
#include "mailbox.h"
#include "print.h"

/// The emulator puts it where the mailbox is otherwise.
typedef struct {
    uint32_t passes;
    uint32_t turns; ///< at least 1
    uint32_t exit_code;
} order_t;

/// Two instructions a turn and one to return.
__attribute__((naked)) static void loop(void) {
    __asm__ volatile("1: subs r0, r0, #1\n"
                     "bne 1b\n"
                     "bx lr\n");
}

/// Four instructions and 64 bytes of stack.
__attribute__((naked)) static void dig(void) {
    __asm__ volatile("sub sp, sp, #60\n"
                     "push {r0}\n"
                     "add sp, sp, #64\n"
                     "bx lr\n");
}

int main(void) {
    const order_t order = *(const volatile order_t *)MAILBOX_BASE;
    counted_call_init();
    for (uint32_t i = 0; i < order.passes; i++) {
        counted_call(loop, order.turns + i, 0, 0);
    }
    print("stack_bytes", counted_call_stack_bytes());
    counted_call(dig, 0, 0, 0);
    print("dug_stack_bytes", counted_call_stack_bytes());
    return (int)order.exit_code;
}
