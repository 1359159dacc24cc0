#include "clocks.h"

#include "reg.h"
#include "stm32f4_flash.h"
#include "stm32f4_pwr.h"
#include "stm32f4_rcc.h"

#define CR (RCC_BASE + RCC_CR)
#define PLLCFGR (RCC_BASE + RCC_PLLCFGR)
#define CFGR (RCC_BASE + RCC_CFGR)
#define ACR (FLASH_BASE + FLASH_ACR)

#define MHz 1000000u
#define INTERNAL_Hz (16u * MHz)
#define FULL_Hz (168u * MHz)
/// QEMU's TIM2 .. TIM5 count nanoseconds; its core's timer 168 MHz.
#define EMULATED_TIMER_Hz (1000u * MHz)

/// Some ms at 16 MHz, a poll of 10 cycles and more.
#define CRYSTAL_POLLS 60000u
#define PLL_POLLS 20000u
#define SWITCH_POLLS 10000u

/// RM0090: voltage scale 1, which 168 MHz need; on the F446 it is that from the reset on.
#define PWR_SCALE_1 (1u << 14)
/// Data sheets, 2.7 .. 3.6 V: five wait states up to 168 MHz.
#define WAIT_STATES 5u
#define WAIT_STATES_MASK 7u
#define SWITCH_INTERNAL 0u
#define SWITCH_PLL 2u
#define BY_2 4u // of the APB2's prescaler
#define BY_4 5u // of the APB1's

// 168 MHz: VCO input of 2 MHz, or 1 MHz where the crystal has no whole number of 2 MHz; VCO 336
// MHz, over 2 (PLLP 0); 48 MHz of it for what needs that.
static bool pll_word(uint32_t in_Hz, bool is_crystal, uint32_t *word) {
    const uint32_t step_MHz = in_Hz % (2u * MHz) == 0u ? 2u : 1u;
    if (in_Hz < 4u * MHz || in_Hz > 26u * MHz || in_Hz % MHz != 0u) {
        return false;
    }
    *word = (in_Hz / (step_MHz * MHz)) << RCC_PLLCFGR_PLLM_AT |
            (336u / step_MHz) << RCC_PLLCFGR_PLLN_AT | 7u << RCC_PLLCFGR_PLLQ_AT |
            (is_crystal ? RCC_PLLCFGR_PLLSRC : 0u);
    return true;
}

static bool use_pll(uint32_t in_Hz, bool is_crystal) {
    const uint32_t mask = RCC_PLLCFGR_PLLM | RCC_PLLCFGR_PLLN | RCC_PLLCFGR_PLLP |
                          RCC_PLLCFGR_PLLQ | RCC_PLLCFGR_PLLSRC;
    uint32_t word;
    if (!pll_word(in_Hz, is_crystal, &word)) {
        return false;
    }
    reg_clear(CR, RCC_CR_PLLON);
    reg_change(PLLCFGR, mask, word);
    reg_set(CR, RCC_CR_PLLON);
    reg_write(ACR, FLASH_ACR_PRFTEN | FLASH_ACR_ICEN | FLASH_ACR_DCEN | WAIT_STATES);
    if (!reg_wait(CR, RCC_CR_PLLRDY, RCC_CR_PLLRDY, PLL_POLLS) ||
        (reg_read(ACR) & WAIT_STATES_MASK) != WAIT_STATES) {
        return false;
    }
    reg_change(CFGR, RCC_CFGR_PPRE1 | RCC_CFGR_PPRE2,
               BY_4 << RCC_CFGR_PPRE1_AT | BY_2 << RCC_CFGR_PPRE2_AT);
    reg_change(CFGR, RCC_CFGR_SW, SWITCH_PLL << RCC_CFGR_SW_AT);
    return reg_wait(CFGR, RCC_CFGR_SWS, SWITCH_PLL << RCC_CFGR_SWS_AT, SWITCH_POLLS);
}

static bool use_crystal(uint32_t crystal_Hz, bool is_external) {
    if (crystal_Hz == 0u) {
        return false;
    }
    reg_set(CR, is_external ? RCC_CR_HSEBYP | RCC_CR_HSEON : RCC_CR_HSEON);
    if (!reg_wait(CR, RCC_CR_HSERDY, RCC_CR_HSERDY, CRYSTAL_POLLS) || !use_pll(crystal_Hz, true)) {
        return false;
    }
    reg_set(CR, RCC_CR_CSSON); // a crystal that stops: non-maskable interrupt, the timer's break
    return true;
}

// As after a reset.
static void use_internal(void) {
    reg_change(CFGR, RCC_CFGR_SW | RCC_CFGR_PPRE1 | RCC_CFGR_PPRE2,
               SWITCH_INTERNAL << RCC_CFGR_SW_AT);
    (void)reg_wait(CFGR, RCC_CFGR_SWS, SWITCH_INTERNAL, SWITCH_POLLS);
    reg_clear(CR, RCC_CR_PLLON | RCC_CR_HSEON | RCC_CR_HSEBYP);
}

static clock_source_t choose(uint32_t crystal_Hz, bool is_external) {
    if ((reg_read(CR) & (RCC_CR_HSION | RCC_CR_HSIRDY)) == 0u) { // no processor runs without
        return CLOCK_ABSENT;
    }
    reg_set(RCC_BASE + RCC_APB1ENR, RCC_APB1ENR_PWREN);
    reg_set(PWR_BASE + PWR_CR, PWR_SCALE_1);
    if (use_crystal(crystal_Hz, is_external)) {
        return CLOCK_CRYSTAL;
    }
    use_internal();
    if (use_pll(INTERNAL_Hz, false)) {
        return CLOCK_INTERNAL_PLL;
    }
    use_internal();
    return CLOCK_INTERNAL;
}

void clocks_start(clocks_t *clocks, uint32_t crystal_Hz, bool is_external) {
    clocks->source = choose(crystal_Hz, is_external);
    const bool is_slow = clocks->source == CLOCK_INTERNAL;
    const uint32_t core_Hz = is_slow ? INTERNAL_Hz : FULL_Hz;
    clocks->core_Hz = core_Hz;
    clocks->apb1_Hz = is_slow ? core_Hz : core_Hz / 4u;
    clocks->apb2_Hz = is_slow ? core_Hz : core_Hz / 2u;
    // A timer's clock is twice its bus's where that is divided.
    clocks->apb1_timer_Hz = is_slow ? core_Hz : core_Hz / 2u;
    clocks->apb2_timer_Hz = core_Hz;
    if (clocks->source == CLOCK_ABSENT) {
        clocks->apb1_timer_Hz = EMULATED_TIMER_Hz;
    }
}
