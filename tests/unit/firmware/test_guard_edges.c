// The guard at the ends of its ranges: what it starts from, its slowest and fastest slew, no less
// than nothing.
#include "guard.h"
#include "unity.h"

#include <string.h>

static guard_t guard;

void setUp(void) {
    memset(&guard, 0xA5, sizeof guard); // init must not need zeros
}
void tearDown(void) {}

static void start(int32_t max_mA, int32_t safe_mA, int32_t slew_mA_s, uint32_t rate_Hz) {
    const guard_cfg_t cfg = {
        .max_mA = max_mA, .safe_mA = safe_mA, .slew_mA_s = slew_mA_s, .tick_rate_Hz = rate_Hz};
    guard_init(&guard, &cfg);
}

static void test_first_tick_goes_on_from_the_safe_current(void) {
    start(10000, 5000, 1000, 1000);
    TEST_ASSERT_EQUAL_INT32(5001, guard_step(&guard, 10000, true));
    start(10000, 5000, 1000, 1000);
    TEST_ASSERT_EQUAL_INT32(4999, guard_step(&guard, 0, true));
}

static void test_no_request_gets_below_nothing(void) {
    start(5000, 20, 10000, 1000);
    TEST_ASSERT_EQUAL_INT32(10, guard_step(&guard, INT32_MIN, true));
    for (uint32_t i = 0; i < 5; i++) {
        TEST_ASSERT_EQUAL_INT32(0, guard_step(&guard, INT32_MIN, true));
    }
    TEST_ASSERT_EQUAL_INT32(10, guard_step(&guard, 10, true));
}

static void test_safe_current_below_nothing_is_none(void) {
    start(5000, -1, 1000, 1000);
    TEST_ASSERT_EQUAL_INT32(0, guard_step(&guard, 5000, false));
}

// 1000 mA/s at 2 MHz is half of the least step.
static void test_slowest_slew_is_1_uA_a_tick(void) {
    start(5000, 0, 1000, 2000000);
    for (uint32_t i = 1; i <= 3000; i++) {
        TEST_ASSERT_EQUAL_INT32((int32_t)(i / 1000u), guard_step(&guard, 5000, true));
    }
}

static void test_fastest_slew_is_all_there_is_in_a_tick(void) {
    start(20000, 0, INT32_MAX, 1);
    TEST_ASSERT_EQUAL_INT32(20000, guard_step(&guard, INT32_MAX, true));
    TEST_ASSERT_EQUAL_INT32(0, guard_step(&guard, 0, true));
}

static void test_nothing_is_above_the_highest_current(void) {
    start(INT32_MAX, INT32_MAX, INT32_MAX, 1);
    TEST_ASSERT_EQUAL_INT32(20000, guard_step(&guard, INT32_MAX, false));
    TEST_ASSERT_EQUAL_INT32(20000, guard_step(&guard, INT32_MAX, true));
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(test_first_tick_goes_on_from_the_safe_current);
    RUN_TEST(test_no_request_gets_below_nothing);
    RUN_TEST(test_safe_current_below_nothing_is_none);
    RUN_TEST(test_slowest_slew_is_1_uA_a_tick);
    RUN_TEST(test_fastest_slew_is_all_there_is_in_a_tick);
    RUN_TEST(test_nothing_is_above_the_highest_current);
    return UNITY_END();
}
