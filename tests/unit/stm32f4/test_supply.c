// The supply's detector on fakes: when it lets a start go on, and what it then watches.
#include "fake_registers.h"
#include "stm32f4_exti.h"
#include "stm32f4_interrupts.h"
#include "stm32f4_pwr.h"
#include "supply.h"
#include "unity.h"

#define CSR (PWR_BASE + PWR_CSR)
#define CR (PWR_BASE + PWR_CR)
#define LINE (1u << 16)
#define SETTLES_WITHIN 100u ///< reads

static uint32_t reads;    ///< of the detector, since it runs
static uint32_t low_from; ///< in reads
static uint32_t low_until;

static bool is_on(void) {
    return (fake_get(CR) & PWR_CR_PVDE) != 0u;
}

// RM0090, section 5.2.2: PVDO says that the supply is below the level, once the detector has
// settled; its rise is what EXTI line 16 sees. Until then it may say anything.
static void detect(uint32_t address, bool is_write, uint32_t value) {
    (void)value;
    if (address != CSR || is_write || !is_on()) {
        return;
    }
    reads++;
    const bool was_low = (fake_get(CSR) & PWR_CSR_PVDO) != 0u;
    const bool is_low = reads < SETTLES_WITHIN || (reads >= low_from && reads < low_until);
    fake_set(CSR, is_low ? PWR_CSR_PVDO : 0u);
    if (is_low && !was_low && (fake_get(EXTI_BASE + EXTI_RTSR) & LINE) != 0u) {
        fake_set(EXTI_BASE + EXTI_PR, LINE);
    }
}

static void start(fake_chip_t chip, uint32_t from, uint32_t until) {
    fake_reset(chip);
    fake_use_hook(detect);
    reads = 0;
    low_from = from;
    low_until = until;
}

void setUp(void) {
    start(FAKE_F405, UINT32_MAX, UINT32_MAX);
}

void tearDown(void) {
    TEST_ASSERT_NULL_MESSAGE(fake_mistake(), fake_mistake());
}

static void assert_watched(void) {
    TEST_ASSERT_EQUAL_UINT32(7, (fake_get(CR) & PWR_CR_PLS) >> PWR_CR_PLS_AT);
    TEST_ASSERT_EQUAL_HEX32(LINE, fake_get(EXTI_BASE + EXTI_RTSR));
    TEST_ASSERT_EQUAL_HEX32(0, fake_get(EXTI_BASE + EXTI_FTSR));
    TEST_ASSERT_EQUAL_HEX32(LINE, fake_get(EXTI_BASE + EXTI_IMR));
    TEST_ASSERT_EQUAL_UINT32(1, PVD_INTERRUPT);
}

static void test_a_supply_that_is_there_is_watched(void) {
    for (fake_chip_t chip = FAKE_F405; chip < FAKE_CHIPS; chip++) {
        start(chip, UINT32_MAX, UINT32_MAX);
        TEST_ASSERT_TRUE(supply_watch());
        assert_watched();
        TEST_ASSERT_EQUAL_HEX32(0, fake_get(EXTI_BASE + EXTI_PR)); // settling was no fall
    }
}

static void test_one_that_comes_back_is_waited_for(void) {
    start(FAKE_F405, 0, 5000000);
    TEST_ASSERT_TRUE(supply_watch());
    TEST_ASSERT_GREATER_OR_EQUAL_UINT32(5000000, reads);
    assert_watched();
    TEST_ASSERT_EQUAL_HEX32(0, fake_get(EXTI_BASE + EXTI_PR));
}

static void test_one_that_stays_low_is_told_after_a_bounded_wait(void) {
    start(FAKE_F405, 0, UINT32_MAX);
    TEST_ASSERT_FALSE(supply_watch());
    TEST_ASSERT_LESS_THAN_UINT32(30000000, reads);
    TEST_ASSERT_EQUAL_HEX32(0, fake_get(EXTI_BASE + EXTI_IMR));
}

// Wherever it falls in those few reads, it is seen: by the line, or by the last look.
static void test_a_fall_at_the_end_of_the_start_is_not_missed(void) {
    TEST_ASSERT_TRUE(supply_watch());
    const uint32_t all = reads;
    for (uint32_t from = all - 3u; from <= all + 1u; from++) {
        start(FAKE_F405, from, UINT32_MAX);
        const bool goes_on = supply_watch();
        (void)detect(CSR, false, 0);
        (void)detect(CSR, false, 0);
        TEST_ASSERT_TRUE(!goes_on || (fake_get(EXTI_BASE + EXTI_PR) & LINE) != 0u);
    }
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(test_a_supply_that_is_there_is_watched);
    RUN_TEST(test_one_that_comes_back_is_waited_for);
    RUN_TEST(test_one_that_stays_low_is_told_after_a_bounded_wait);
    RUN_TEST(test_a_fall_at_the_end_of_the_start_is_not_missed);
    return UNITY_END();
}
