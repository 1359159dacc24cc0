// The order lies where the mailbox is otherwise; what is counted stands between the markers.
#include "counted_call.h"
#include "law_order.h"
#include "mailbox.h"
#include "print.h"

static void say(const char *name, uint32_t value) {
    print(name, value);
}

static void count_call(void (*function)(void *context), void *context) {
    counted_call((counted_function_t)function, (uintptr_t)context, 0, 0);
}

int main(void) {
    static const law_door_t door = {say, count_call};
    counted_call_init();
    if (!law_runs((const law_order_t *)MAILBOX_BASE, &door)) {
        print("refused", 1);
        return 1;
    }
    print("stack_bytes", counted_call_stack_bytes());
    return counted_call_stack_bytes() < counted_call_stack_size_bytes() ? 0 : 1;
}
