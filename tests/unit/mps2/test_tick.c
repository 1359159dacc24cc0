#include "nap.h"
#include "tick_mps2.h"
#include "unity.h"

/// Instructions a second at -icount shift=3 (8 ns each), and those of one turn of spin().
#define INSTRUCTIONS_PER_S 125000000u
#define INSTRUCTIONS_PER_TURN 2u

static hal_tick_t tick;

void setUp(void) {
    tick = (hal_tick_t){.timer = CMSDK_TIMER0};
}

void tearDown(void) {}

static void spin(uint32_t turns) {
    __asm__ volatile("1: subs %0, %0, #1\n"
                     "bne 1b\n"
                     : "+r"(turns)
                     :
                     : "cc");
}

static void spin_for_us(uint32_t time_us) {
    spin(time_us * (INSTRUCTIONS_PER_S / 1000000u) / INSTRUCTIONS_PER_TURN);
}

static void test_rates_that_the_clock_cannot_make_are_refused(void) {
    TEST_ASSERT_FALSE(hal_tick_start(&tick, 0));
    TEST_ASSERT_FALSE(hal_tick_start(&tick, 3));
    TEST_ASSERT_FALSE(hal_tick_start(&tick, 100001));
    TEST_ASSERT_FALSE(hal_tick_start(&tick, 125000));
    TEST_ASSERT_TRUE(hal_tick_start(&tick, 1));
    TEST_ASSERT_TRUE(hal_tick_start(&tick, 100000));
}

static void test_no_tick_has_elapsed_at_the_start(void) {
    TEST_ASSERT_TRUE(hal_tick_start(&tick, 1000));
    TEST_ASSERT_EQUAL_UINT32(0, hal_tick_elapsed(&tick));
    spin_for_us(900);
    TEST_ASSERT_EQUAL_UINT32(0, hal_tick_elapsed(&tick));
    spin_for_us(200);
    TEST_ASSERT_EQUAL_UINT32(1, hal_tick_elapsed(&tick));
}

static void test_rate_is_right_over_many_ticks(void) {
    static const uint32_t rates_Hz[] = {500, 1000, 4000, 100000};
    for (uint32_t i = 0; i < sizeof rates_Hz / sizeof rates_Hz[0]; i++) {
        TEST_ASSERT_TRUE(hal_tick_start(&tick, rates_Hz[i]));
        spin_for_us(200000);
        TEST_ASSERT_UINT32_WITHIN(1, rates_Hz[i] / 5u, hal_tick_elapsed(&tick));
    }
}

static void test_polling_loses_no_tick(void) {
    uint32_t ticks = 0;
    TEST_ASSERT_TRUE(hal_tick_start(&tick, 1000));
    for (uint32_t i = 0; i < 2000; i++) {
        spin_for_us(97);
        ticks += hal_tick_elapsed(&tick);
    }
    TEST_ASSERT_UINT32_WITHIN(2, 194, ticks); // and the polls' own instructions
}

static void test_overrun_reports_every_tick(void) {
    TEST_ASSERT_TRUE(hal_tick_start(&tick, 1000));
    spin_for_us(5500);
    TEST_ASSERT_EQUAL_UINT32(5, hal_tick_elapsed(&tick));
    TEST_ASSERT_EQUAL_UINT32(0, hal_tick_elapsed(&tick));
    spin_for_us(600); // the half tick left over counts
    TEST_ASSERT_EQUAL_UINT32(1, hal_tick_elapsed(&tick));
}

static void test_nap_sleeps_its_time(void) {
    static const uint32_t naps_us[] = {50, 1000, 100000};
    for (uint32_t i = 0; i < sizeof naps_us / sizeof naps_us[0]; i++) {
        TEST_ASSERT_TRUE(hal_tick_start(&tick, 100000));
        nap_us(naps_us[i]);
        const uint32_t slept_us = 10u * hal_tick_elapsed(&tick);
        TEST_ASSERT_GREATER_OR_EQUAL_UINT32(naps_us[i] - 10u, slept_us);
        TEST_ASSERT_LESS_THAN_UINT32(naps_us[i] + naps_us[i] / 5u + 50u, slept_us);
    }
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(test_rates_that_the_clock_cannot_make_are_refused);
    RUN_TEST(test_no_tick_has_elapsed_at_the_start);
    RUN_TEST(test_rate_is_right_over_many_ticks);
    RUN_TEST(test_polling_loses_no_tick);
    RUN_TEST(test_overrun_reports_every_tick);
    RUN_TEST(test_nap_sleeps_its_time);
    return UNITY_END();
}
