#include "supply.h"

#include <stdint.h>

#include "reg.h"
#include "stm32f4_exti.h"
#include "stm32f4_pwr.h"

#define PVD_LINE (1u << 16) ///< of EXTI
#define HIGHEST_LEVEL 7u
#define SETTLE_POLLS 1000u     ///< of the detector, some us
#define SUPPLY_POLLS 20000000u ///< some 10 cycles each

#define CSR (PWR_BASE + PWR_CSR)

static bool is_low(void) {
    return (reg_read(CSR) & PWR_CSR_PVDO) != 0u;
}

bool supply_watch(void) {
    reg_change(PWR_BASE + PWR_CR, PWR_CR_PLS, HIGHEST_LEVEL << PWR_CR_PLS_AT);
    reg_set(PWR_BASE + PWR_CR, PWR_CR_PVDE);
    for (uint32_t i = 0; i < SETTLE_POLLS; i++) {
        (void)is_low();
    }
    if (!reg_wait(CSR, PWR_CSR_PVDO, 0, SUPPLY_POLLS)) {
        return false;
    }
    // The detector's line rises where the supply falls.
    reg_set(EXTI_BASE + EXTI_RTSR, PVD_LINE);
    reg_write(EXTI_BASE + EXTI_PR, PVD_LINE);
    reg_set(EXTI_BASE + EXTI_IMR, PVD_LINE);
    return !is_low(); // it may have fallen before the line was watched
}
