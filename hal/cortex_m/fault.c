#include "fault.h"

#include <stddef.h>

#define SCB_CFSR (*(const volatile uint32_t *)0xE000ED28u) ///< configurable fault status
#define SCB_HFSR (*(const volatile uint32_t *)0xE000ED2Cu) ///< hard fault status

enum { STACKED_LR = 5, STACKED_PC = 6, STACKED_XPSR = 7 };

__attribute__((section(".noinit"))) cpu_fault_t cpu_fault;

static uint32_t check_of(const cpu_fault_t *record) {
    return ~(record->magic + record->count + record->exception + record->pc + record->lr +
             record->xpsr + record->cfsr + record->hfsr);
}

bool fault_is_recorded(void) {
    return cpu_fault.magic == FAULT_MAGIC && cpu_fault.check == check_of(&cpu_fault);
}

void fault_forget(void) {
    cpu_fault = (cpu_fault_t){0};
}

void fault_keep(const uint32_t *stacked) {
    uint32_t exception;
    __asm__ volatile("mrs %0, ipsr" : "=r"(exception));
    const uint32_t before = fault_is_recorded() ? cpu_fault.count : 0u;
    cpu_fault = (cpu_fault_t){
        .magic = FAULT_MAGIC,
        .count = before < UINT32_MAX ? before + 1u : before,
        .exception = exception,
        .pc = stacked != NULL ? stacked[STACKED_PC] : 0u,
        .lr = stacked != NULL ? stacked[STACKED_LR] : 0u,
        .xpsr = stacked != NULL ? stacked[STACKED_XPSR] : 0u,
        .cfsr = SCB_CFSR,
        .hfsr = SCB_HFSR,
    };
    cpu_fault.check = check_of(&cpu_fault);
}
