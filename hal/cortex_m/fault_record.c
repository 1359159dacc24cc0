#include "fault.h"

__attribute__((section(".noinit"))) cpu_fault_t cpu_fault;

static uint32_t check_of(const cpu_fault_t *record) {
    return ~(record->magic + record->count + record->exception + record->pc + record->lr +
             record->xpsr + record->cfsr + record->hfsr);
}

bool fault_is_recorded(void) {
    return cpu_fault.magic == FAULT_MAGIC && cpu_fault.check == check_of(&cpu_fault);
}

bool fault_is_final(void) {
    return fault_is_recorded() && cpu_fault.count > FAULT_MOST_RESTARTS;
}

void fault_forget(void) {
    cpu_fault = (cpu_fault_t){0};
}

void fault_count(const cpu_fault_t *what) {
    const uint32_t before = fault_is_recorded() ? cpu_fault.count : 0u;
    cpu_fault = *what;
    cpu_fault.magic = FAULT_MAGIC;
    cpu_fault.count = before < UINT32_MAX ? before + 1u : before;
    cpu_fault.check = check_of(&cpu_fault);
}

void fault_count_watchdog(void) {
    if (!fault_is_final()) {
        fault_count(&(cpu_fault_t){0});
    }
}
