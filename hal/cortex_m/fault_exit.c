// Under a test or a bench: says what happened and ends the emulator.
#include "fault.h"
#include "semihost.h"

static void put_named(const char *name, uint32_t value) {
    semihost_put_text(name);
    semihost_put_hex(value);
}

_Noreturn void fault_react(void) {
    put_named("image fault: exception 0x", cpu_fault.exception);
    put_named(" pc 0x", cpu_fault.pc);
    put_named(" lr 0x", cpu_fault.lr);
    put_named(" xpsr 0x", cpu_fault.xpsr);
    put_named(" cfsr 0x", cpu_fault.cfsr);
    put_named(" hfsr 0x", cpu_fault.hfsr);
    semihost_put_char('\n');
    semihost_exit(FAULT_EXIT_CODE);
}
