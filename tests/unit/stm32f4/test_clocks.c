// The clock tree on fakes of both chips: every oscillator that does not start has an answer.
#include "clocks.h"
#include "fake_registers.h"
#include "stm32f4_flash.h"
#include "stm32f4_pwr.h"
#include "stm32f4_rcc.h"
#include "unity.h"

#define CR (RCC_BASE + RCC_CR)
#define CFGR (RCC_BASE + RCC_CFGR)
#define PLLCFGR (RCC_BASE + RCC_PLLCFGR)
#define NEVER UINT32_MAX
#define CRYSTAL_8_MHz 8000000u

// After how many reads of CR an oscillator is ready.
static uint32_t crystal_reads;
static uint32_t pll_reads;
static bool crystal_stops_pll; ///< one that is bad: the PLL does not lock on it
static uint32_t reads;

static bool is_locked(uint32_t cr) {
    const bool is_crystal = (fake_get(PLLCFGR) & RCC_PLLCFGR_PLLSRC) != 0u;
    return (cr & RCC_CR_PLLON) != 0u && pll_reads != NEVER && reads >= pll_reads &&
           !(is_crystal && crystal_stops_pll);
}

// RM0090, RCC_CR and RCC_CFGR: ready flags and the switch's status are the hardware's.
static void oscillate(uint32_t address, bool is_write, uint32_t value) {
    uint32_t cr = fake_get(CR) & ~(RCC_CR_HSERDY | RCC_CR_PLLRDY);
    const uint32_t cfgr = fake_get(CFGR);
    (void)value;
    reads += address == CR && !is_write ? 1u : 0u;
    if ((cr & RCC_CR_HSEON) != 0u && crystal_reads != NEVER && reads >= crystal_reads) {
        cr |= RCC_CR_HSERDY;
    }
    fake_set(CR, cr | (is_locked(cr) ? RCC_CR_PLLRDY : 0u));
    const uint32_t wanted = (cfgr & RCC_CFGR_SW) >> RCC_CFGR_SW_AT;
    const uint32_t used = wanted == 2u && !is_locked(cr) ? 0u : wanted;
    fake_set(CFGR, (cfgr & ~RCC_CFGR_SWS) | used << RCC_CFGR_SWS_AT);
}

static clocks_t start_on(fake_chip_t chip, uint32_t crystal_Hz) {
    clocks_t clocks = {0};
    fake_reset(chip);
    fake_use_hook(oscillate);
    reads = 0;
    clocks_start(&clocks, crystal_Hz, false);
    TEST_ASSERT_NULL_MESSAGE(fake_mistake(), fake_mistake());
    return clocks;
}

void setUp(void) {
    crystal_reads = 10;
    pll_reads = 20;
    crystal_stops_pll = false;
}

void tearDown(void) {}

static void assert_168_MHz_from(uint32_t input_MHz) {
    const uint32_t word = fake_get(PLLCFGR);
    const uint32_t m = (word & RCC_PLLCFGR_PLLM) >> RCC_PLLCFGR_PLLM_AT;
    const uint32_t n = (word & RCC_PLLCFGR_PLLN) >> RCC_PLLCFGR_PLLN_AT;
    const uint32_t p = 2u * (1u + ((word & RCC_PLLCFGR_PLLP) >> RCC_PLLCFGR_PLLP_AT));
    const uint32_t q = (word & RCC_PLLCFGR_PLLQ) >> RCC_PLLCFGR_PLLQ_AT;
    TEST_ASSERT_EQUAL_UINT32(168u * m * p, input_MHz * n);
    TEST_ASSERT_EQUAL_UINT32(48u * m * q, input_MHz * n);
    TEST_ASSERT_TRUE(input_MHz >= m && input_MHz <= 2u * m); // VCO input 1 .. 2 MHz
}

static void test_crystals_of_boards_make_168_MHz_on_both_chips(void) {
    static const uint32_t crystals_MHz[] = {4, 8, 12, 16, 25, 26};
    for (fake_chip_t chip = FAKE_F405; chip <= FAKE_F446; chip++) {
        for (uint32_t i = 0; i < sizeof crystals_MHz / sizeof crystals_MHz[0]; i++) {
            const clocks_t clocks = start_on(chip, crystals_MHz[i] * 1000000u);
            TEST_ASSERT_EQUAL(CLOCK_CRYSTAL, clocks.source);
            TEST_ASSERT_EQUAL_UINT32(168000000u, clocks.core_Hz);
            assert_168_MHz_from(crystals_MHz[i]);
        }
    }
}

static void test_buses_wait_states_voltage_and_the_crystals_watch(void) {
    const clocks_t clocks = start_on(FAKE_F405, CRYSTAL_8_MHz);
    const uint32_t cfgr = fake_get(CFGR);
    TEST_ASSERT_EQUAL_UINT32(5u, (cfgr & RCC_CFGR_PPRE1) >> RCC_CFGR_PPRE1_AT); // over 4
    TEST_ASSERT_EQUAL_UINT32(4u, (cfgr & RCC_CFGR_PPRE2) >> RCC_CFGR_PPRE2_AT); // over 2
    TEST_ASSERT_EQUAL_UINT32(42000000u, clocks.apb1_Hz);
    TEST_ASSERT_EQUAL_UINT32(84000000u, clocks.apb2_Hz);
    TEST_ASSERT_EQUAL_UINT32(84000000u, clocks.apb1_timer_Hz);
    TEST_ASSERT_EQUAL_UINT32(168000000u, clocks.apb2_timer_Hz);
    TEST_ASSERT_EQUAL_UINT32(5u, fake_get(FLASH_BASE + FLASH_ACR) & 7u);
    TEST_ASSERT_BITS_HIGH(1u << 14, fake_get(PWR_BASE + PWR_CR));
    TEST_ASSERT_BITS_HIGH(RCC_CR_CSSON, fake_get(CR));
}

// Faster than the flash can follow is what must never be.
static void test_the_wait_states_come_before_the_switch(void) {
    (void)start_on(FAKE_F405, CRYSTAL_8_MHz);
    uint32_t wait_states = NEVER;
    uint32_t last_switch = 0;
    for (uint32_t i = 0; i < fake_all_writes(); i++) {
        if (fake_written_address(i) == FLASH_BASE + FLASH_ACR && wait_states == NEVER) {
            wait_states = i;
        }
        last_switch = fake_written_address(i) == CFGR ? i : last_switch;
    }
    TEST_ASSERT_TRUE(wait_states < last_switch);
}

static void test_without_a_crystal_the_internal_oscillator_makes_the_same_rate(void) {
    crystal_reads = NEVER;
    for (fake_chip_t chip = FAKE_F405; chip <= FAKE_F446; chip++) {
        const clocks_t clocks = start_on(chip, CRYSTAL_8_MHz);
        TEST_ASSERT_EQUAL(CLOCK_INTERNAL_PLL, clocks.source);
        TEST_ASSERT_EQUAL_UINT32(168000000u, clocks.core_Hz);
        assert_168_MHz_from(16);
        TEST_ASSERT_BITS_LOW(RCC_CR_HSEON | RCC_CR_CSSON, fake_get(CR));
    }
    TEST_ASSERT_EQUAL(CLOCK_INTERNAL_PLL, start_on(FAKE_F405, 0).source); // the board has none
}

static void test_a_crystal_that_the_pll_does_not_lock_on_is_left(void) {
    crystal_stops_pll = true;
    TEST_ASSERT_EQUAL(CLOCK_INTERNAL_PLL, start_on(FAKE_F405, CRYSTAL_8_MHz).source);
}

static void test_crystals_out_of_range_are_not_used(void) {
    static const uint32_t wrong_Hz[] = {3000000u, 27000000u, 11059200u};
    for (uint32_t i = 0; i < sizeof wrong_Hz / sizeof wrong_Hz[0]; i++) {
        TEST_ASSERT_EQUAL(CLOCK_INTERNAL_PLL, start_on(FAKE_F405, wrong_Hz[i]).source);
    }
}

static void test_without_a_pll_it_runs_at_16_MHz(void) {
    pll_reads = NEVER;
    const clocks_t clocks = start_on(FAKE_F405, CRYSTAL_8_MHz);
    TEST_ASSERT_EQUAL(CLOCK_INTERNAL, clocks.source);
    TEST_ASSERT_EQUAL_UINT32(16000000u, clocks.core_Hz);
    TEST_ASSERT_EQUAL_UINT32(16000000u, clocks.apb1_Hz);
    TEST_ASSERT_EQUAL_UINT32(16000000u, clocks.apb1_timer_Hz);
    TEST_ASSERT_EQUAL_UINT32(0, fake_get(CFGR) & (RCC_CFGR_SW | RCC_CFGR_PPRE1 | RCC_CFGR_PPRE2));
    TEST_ASSERT_BITS_LOW(RCC_CR_PLLON | RCC_CR_HSEON, fake_get(CR));
}

static void test_without_any_of_these_registers_it_returns(void) {
    clocks_t clocks = {0};
    fake_reset(FAKE_F405);
    fake_absent();
    clocks_start(&clocks, CRYSTAL_8_MHz, false);
    TEST_ASSERT_EQUAL(CLOCK_ABSENT, clocks.source);
    TEST_ASSERT_EQUAL_UINT32(168000000u, clocks.core_Hz);
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(test_crystals_of_boards_make_168_MHz_on_both_chips);
    RUN_TEST(test_buses_wait_states_voltage_and_the_crystals_watch);
    RUN_TEST(test_the_wait_states_come_before_the_switch);
    RUN_TEST(test_without_a_crystal_the_internal_oscillator_makes_the_same_rate);
    RUN_TEST(test_a_crystal_that_the_pll_does_not_lock_on_is_left);
    RUN_TEST(test_crystals_out_of_range_are_not_used);
    RUN_TEST(test_without_a_pll_it_runs_at_16_MHz);
    RUN_TEST(test_without_any_of_these_registers_it_returns);
    return UNITY_END();
}
