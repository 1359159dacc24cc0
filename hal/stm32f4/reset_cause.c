#include "reset_cause.h"

#include "reg.h"
#include "stm32f4_rcc.h"

#define CSR (RCC_BASE + RCC_CSR)

// Every reset sets the pin's flag as well, and one of the power that of the brown-out.
reset_cause_t reset_cause_take(void) {
    static const struct {
        uint32_t flag;
        reset_cause_t cause;
    } flags[] = {
        {RCC_CSR_PORRSTF, RESET_POWER},    {RCC_CSR_BORRSTF, RESET_BROWN_OUT},
        {RCC_CSR_WDGRSTF, RESET_WATCHDOG}, {RCC_CSR_WWDGRSTF, RESET_WATCHDOG},
        {RCC_CSR_SFTRSTF, RESET_SOFTWARE}, {RCC_CSR_LPWRRSTF, RESET_LOW_POWER},
        {RCC_CSR_PADRSTF, RESET_PIN},
    };
    const uint32_t csr = reg_read(CSR);
    reg_set(CSR, RCC_CSR_RMVF);
    for (uint32_t i = 0; i < sizeof flags / sizeof flags[0]; i++) {
        if ((csr & flags[i].flag) != 0u) {
            return flags[i].cause;
        }
    }
    return RESET_UNKNOWN;
}
