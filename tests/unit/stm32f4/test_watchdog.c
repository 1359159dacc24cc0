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

#define CORE_Hz 168000000.0
#define READ_CYCLES 10.0 ///< of a poll, at the least
#define UPDATE_PERIODS 6.0
#define LSI_Hz 32000.0

static bool is_unlocked;
static bool is_started;
static bool is_stuck; ///< an update that never ends
static uint32_t feeds;
static uint32_t kept_pr;
static uint32_t kept_rlr;
static uint32_t next_pr; ///< what an update brings
static uint32_t next_rlr;
static double now_s;
static double end_s; ///< of the update
static uint32_t writes_into_an_update;

static double slowest_period_s(void) {
    const uint32_t prescaler = next_pr > kept_pr ? next_pr : kept_pr;
    return (4u << prescaler) / LSI_Hz;
}

// A value goes over to the watchdog's own clock: until then SR says so, and reads have the old one.
static void update(uint32_t address, uint32_t value) {
    writes_into_an_update += fake_get(SR) & (address == PR ? IWDG_SR_PVU : IWDG_SR_RVU);
    if (is_unlocked) {
        *(address == PR ? &next_pr : &next_rlr) = value;
        fake_set(SR, fake_get(SR) | (address == PR ? IWDG_SR_PVU : IWDG_SR_RVU));
        end_s = now_s + UPDATE_PERIODS * slowest_period_s();
    }
    fake_set(PR, kept_pr);
    fake_set(RLR, kept_rlr);
}

static void end_update(void) {
    if (fake_get(SR) != 0u && now_s >= end_s && !is_stuck) {
        fake_set(SR, 0);
        fake_set(PR, kept_pr = next_pr);
        fake_set(RLR, kept_rlr = next_rlr);
    }
}

// RM0090 Rev 18, page 709: PR and RLR take writes after 0x5555, until another key; SR.
static void guard(uint32_t address, bool is_write, uint32_t value) {
    now_s += READ_CYCLES / CORE_Hz;
    end_update();
    if (is_write && address == KR) {
        is_unlocked = value == 0x5555u;
        is_started = is_started || value == 0xCCCCu;
        feeds += value == 0xAAAAu ? 1u : 0u;
    } else if (is_write) {
        update(address, value);
    }
}

void setUp(void) {
    fake_reset(FAKE_F405);
    fake_use_hook(guard);
    is_unlocked = is_started = is_stuck = false;
    feeds = writes_into_an_update = 0;
    kept_pr = next_pr = 0;
    kept_rlr = next_rlr = fake_get(RLR);
    now_s = end_s = 0.0;
}

void tearDown(void) {
    TEST_ASSERT_NULL_MESSAGE(fake_mistake(), fake_mistake());
    TEST_ASSERT_EQUAL_UINT32(0, writes_into_an_update);
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

// As the image's idle loop does, some us a pass.
static uint32_t passes_until_set(uint32_t timeout_ms) {
    uint32_t passes = 1;
    while (!watchdog_set(timeout_ms) && passes < 100000u) {
        now_s += 5e-6;
        passes++;
    }
    return passes;
}

static void test_another_time_holds_within_50_ms_and_is_written_once(void) {
    static const uint32_t times_ms[] = {8000, 50, 32000, 50};
    TEST_ASSERT_TRUE(watchdog_start(2000));
    for (uint32_t i = 0; i < sizeof times_ms / sizeof times_ms[0]; i++) {
        const uint32_t writes = fake_writes(RLR);
        const double begin_s = now_s;
        TEST_ASSERT_TRUE(passes_until_set(times_ms[i]) > 1u); // it takes time, and nobody waits
        TEST_ASSERT_TRUE(now_s - begin_s < 0.05);
        TEST_ASSERT_TRUE(time_ms() <= times_ms[i] && time_ms() > 0.99 * times_ms[i]);
        TEST_ASSERT_EQUAL_UINT32(writes + 1u, fake_writes(RLR));
        TEST_ASSERT_EQUAL_UINT32(1, passes_until_set(times_ms[i]));
        TEST_ASSERT_EQUAL_UINT32(writes + 1u, fake_writes(RLR));
        TEST_ASSERT_FALSE(is_unlocked);
    }
    TEST_ASSERT_EQUAL_UINT32(1, feeds); // the start's: a loop that only asks supervises nothing
}

static void test_a_time_that_is_thought_better_of_is_not_taken_for_the_first(void) {
    TEST_ASSERT_TRUE(watchdog_start(2000));
    TEST_ASSERT_FALSE(watchdog_set(8000));
    TEST_ASSERT_FALSE(watchdog_set(2000)); // still on its way to 8 s
    TEST_ASSERT_TRUE(passes_until_set(2000) < 100000u);
    TEST_ASSERT_TRUE(time_ms() <= 2000.0 && time_ms() > 1980.0);
}

static void test_times_out_of_range_change_nothing(void) {
    TEST_ASSERT_FALSE(watchdog_start(0));
    TEST_ASSERT_FALSE(watchdog_set(0));
    TEST_ASSERT_FALSE(watchdog_set(WATCHDOG_MOST_MS + 1u));
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
    RUN_TEST(test_another_time_holds_within_50_ms_and_is_written_once);
    RUN_TEST(test_a_time_that_is_thought_better_of_is_not_taken_for_the_first);
    RUN_TEST(test_times_out_of_range_change_nothing);
    RUN_TEST(test_an_update_that_never_ends_is_told);
    RUN_TEST(test_feeding_writes_its_key_alone);
    RUN_TEST(test_the_causes_of_a_reset);
    return UNITY_END();
}
