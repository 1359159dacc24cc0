// The independent watchdog and the reset's cause on fakes.
#include "fake_registers.h"
#include "reset_cause.h"
#include "stm32f4_iwdg.h"
#include "stm32f4_rcc.h"
#include "unity.h"
#include "watchdog.h"

#define KR (IWDG_BASE + IWDG_KR)
#define PR (IWDG_BASE + IWDG_PR)
#define RLR (IWDG_BASE + IWDG_RLR)
#define SR (IWDG_BASE + IWDG_SR)
#define CSR (RCC_BASE + RCC_CSR)

static bool is_unlocked;
static bool is_started;
static bool is_stuck; ///< an update that never ends
static uint32_t feeds;
static uint32_t kept_pr;
static uint32_t kept_rlr;

// RM0090 Rev 18, page 709: PR and RLR take writes after 0x5555, until another key.
static void guard(uint32_t address, bool is_write, uint32_t value) {
    if (!is_write) {
        fake_set(SR, is_stuck ? IWDG_SR_RVU : 0u);
        return;
    }
    if (address == KR) {
        is_unlocked = value == 0x5555u;
        is_started = is_started || value == 0xCCCCu;
        feeds += value == 0xAAAAu ? 1u : 0u;
    } else if (!is_unlocked) {
        fake_set(PR, kept_pr);
        fake_set(RLR, kept_rlr);
    }
    kept_pr = fake_get(PR);
    kept_rlr = fake_get(RLR);
}

void setUp(void) {
    fake_reset(FAKE_F405);
    fake_use_hook(guard);
    is_unlocked = is_started = is_stuck = false;
    feeds = 0;
    kept_pr = 0;
    kept_rlr = fake_get(RLR);
}

void tearDown(void) {
    TEST_ASSERT_NULL_MESSAGE(fake_mistake(), fake_mistake());
}

static double time_ms(void) {
    return (4u << fake_get(PR)) * (fake_get(RLR) + 1u) / 32.0;
}

static void test_times_are_what_was_asked_for_at_32_kHz(void) {
    static const uint32_t times_ms[] = {1, 50, 511, 512, 513, 2000, 8000, 32000};
    for (uint32_t i = 0; i < sizeof times_ms / sizeof times_ms[0]; i++) {
        TEST_ASSERT_TRUE(watchdog_start(times_ms[i]));
        TEST_ASSERT_TRUE(is_started);
        TEST_ASSERT_FALSE(is_unlocked);
        TEST_ASSERT_TRUE(time_ms() <= times_ms[i] && time_ms() > 0.99 * times_ms[i]);
    }
    TEST_ASSERT_EQUAL_UINT32(sizeof times_ms / sizeof times_ms[0], feeds);
}

static void test_times_out_of_range_change_nothing(void) {
    TEST_ASSERT_FALSE(watchdog_start(0));
    TEST_ASSERT_FALSE(watchdog_start(WATCHDOG_MOST_MS + 1u));
    TEST_ASSERT_EQUAL_UINT32(0, fake_all_writes());
}

static void test_an_update_that_never_ends_is_told(void) {
    is_stuck = true;
    TEST_ASSERT_FALSE(watchdog_start(50));
    TEST_ASSERT_TRUE(is_started); // with the time that it had
}

static void test_feeding_writes_its_key_alone(void) {
    watchdog_feed();
    TEST_ASSERT_EQUAL_UINT32(1, feeds);
    TEST_ASSERT_EQUAL_UINT32(1, fake_all_writes());
}

static void clear_flags(uint32_t address, bool is_write, uint32_t value) {
    if (address == CSR && is_write && (value & RCC_CSR_RMVF) != 0u) {
        fake_set(CSR, value & (RCC_CSR_LSION | RCC_CSR_LSIRDY));
    }
}

static void test_the_causes_of_a_reset(void) {
    static const struct {
        uint32_t flags;
        reset_cause_t cause;
    } cases[] = {
        {RCC_CSR_PORRSTF | RCC_CSR_PADRSTF | RCC_CSR_BORRSTF, RESET_POWER},
        {RCC_CSR_BORRSTF | RCC_CSR_PADRSTF, RESET_BROWN_OUT},
        {RCC_CSR_WDGRSTF | RCC_CSR_PADRSTF, RESET_WATCHDOG},
        {RCC_CSR_WWDGRSTF | RCC_CSR_PADRSTF, RESET_WATCHDOG},
        {RCC_CSR_SFTRSTF | RCC_CSR_PADRSTF, RESET_SOFTWARE},
        {RCC_CSR_LPWRRSTF | RCC_CSR_PADRSTF, RESET_LOW_POWER},
        {RCC_CSR_PADRSTF, RESET_PIN},
        {0, RESET_UNKNOWN},
    };
    fake_use_hook(clear_flags);
    for (uint32_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        fake_set(CSR, cases[i].flags);
        TEST_ASSERT_EQUAL(cases[i].cause, reset_cause_take());
        TEST_ASSERT_EQUAL(RESET_UNKNOWN, reset_cause_take()); // taken
    }
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(test_times_are_what_was_asked_for_at_32_kHz);
    RUN_TEST(test_times_out_of_range_change_nothing);
    RUN_TEST(test_an_update_that_never_ends_is_told);
    RUN_TEST(test_feeding_writes_its_key_alone);
    RUN_TEST(test_the_causes_of_a_reset);
    return UNITY_END();
}
