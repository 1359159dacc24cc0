#include "fault.h"

#include <stddef.h>

#define SCB_CFSR (*(const volatile uint32_t *)0xE000ED28u) ///< configurable fault status
#define SCB_HFSR (*(const volatile uint32_t *)0xE000ED2Cu) ///< hard fault status

enum { STACKED_LR = 5, STACKED_PC = 6, STACKED_XPSR = 7 };

void fault_keep(const uint32_t *stacked) {
    uint32_t exception;
    __asm__ volatile("mrs %0, ipsr" : "=r"(exception));
    const cpu_fault_t what = {
        .exception = exception,
        .pc = stacked != NULL ? stacked[STACKED_PC] : 0u,
        .lr = stacked != NULL ? stacked[STACKED_LR] : 0u,
        .xpsr = stacked != NULL ? stacked[STACKED_XPSR] : 0u,
        .cfsr = SCB_CFSR,
        .hfsr = SCB_HFSR,
    };
    fault_count(&what);
}
