// The current monitor at its edges: what it expects, tick by tick, and the ticks of each verdict.
#include "current_monitor.h"
#include "unity.h"

static current_monitor_t monitor;

void setUp(void) {}
void tearDown(void) {}

static void start(current_check_t check, int32_t trip_mA, int32_t initial_mA) {
    const current_monitor_cfg_t cfg = {
        .check = check,
        .tick_rate_Hz = 1000,
        .error_mA = 100,
        .lag_us = 3000,
        .fault_ticks = 10,
        .trip_mA = trip_mA,
        .trip_ticks = 5,
    };
    current_monitor_init(&monitor, &cfg, initial_mA);
}

static current_verdict_t step(int32_t measured_mA) {
    return current_monitor_step(&monitor, 1000, measured_mA, true);
}

// In ticks of a measurement that stays, until this verdict.
static uint32_t ticks_until(current_verdict_t verdict, int32_t measured_mA) {
    for (uint32_t i = 1; i <= 100; i++) {
        if (step(measured_mA) == verdict) {
            return i;
        }
    }
    return 0;
}

// Three ticks of lag: a quarter of the step in a tick, exactly.
static void test_the_expectation_starts_at_the_initial_current_and_lags(void) {
    start(CURRENT_CHECK_ALWAYS, 0, 20000);
    TEST_ASSERT_TRUE(monitor.expected_mA_q16 == INT64_C(20000) * 65536);
    TEST_ASSERT_EQUAL_INT32(20000, current_monitor_expected_mA(&monitor));
    TEST_ASSERT_EQUAL_INT32(16384, monitor.lag_gain_q16);
    (void)current_monitor_step(&monitor, 0, 15000, true);
    TEST_ASSERT_TRUE(monitor.expected_mA_q16 == INT64_C(15000) * 65536);
    (void)current_monitor_step(&monitor, 20000, 16250, true);
    TEST_ASSERT_TRUE(monitor.expected_mA_q16 == INT64_C(16250) * 65536);
    TEST_ASSERT_EQUAL_INT32(16250, current_monitor_expected_mA(&monitor));
}

static void test_what_is_followed_is_expected_and_forgives(void) {
    start(CURRENT_CHECK_ALWAYS, 1500, 0);
    for (uint32_t i = 0; i < 9; i++) {
        TEST_ASSERT_EQUAL(CURRENT_OK, step(0));
    }
    current_monitor_follow(&monitor, 700);
    TEST_ASSERT_EQUAL_INT32(700, current_monitor_expected_mA(&monitor));
    TEST_ASSERT_EQUAL(CURRENT_OK, step(775)); // a quarter of the way
    TEST_ASSERT_EQUAL_INT32(775, current_monitor_expected_mA(&monitor));
    TEST_ASSERT_EQUAL(10, ticks_until(CURRENT_NOT_FOLLOWING, -1000));
    current_monitor_follow(&monitor, 0);
    for (uint32_t i = 0; i < 4; i++) {
        (void)step(1600); // a trip goes on
        current_monitor_follow(&monitor, 1600);
    }
    TEST_ASSERT_EQUAL(CURRENT_OVER, step(1600));
}

static void test_no_lag_is_the_command(void) {
    const current_monitor_cfg_t cfg = {
        .check = CURRENT_CHECK_ALWAYS, .tick_rate_Hz = 4000, .error_mA = 1, .fault_ticks = 1};
    current_monitor_init(&monitor, &cfg, 0);
    TEST_ASSERT_EQUAL_INT32(65536, monitor.lag_gain_q16);
    TEST_ASSERT_EQUAL(CURRENT_OK, current_monitor_step(&monitor, 20000, 20001, true));
    TEST_ASSERT_EQUAL(CURRENT_NOT_FOLLOWING, current_monitor_step(&monitor, 20000, 20002, true));
}

static void test_the_error_itself_is_allowed_on_either_side(void) {
    start(CURRENT_CHECK_ALWAYS, 0, 1000);
    TEST_ASSERT_EQUAL_UINT32(0, ticks_until(CURRENT_NOT_FOLLOWING, 1100));
    TEST_ASSERT_EQUAL_UINT32(0, ticks_until(CURRENT_NOT_FOLLOWING, 900));
    TEST_ASSERT_EQUAL_UINT32(10, ticks_until(CURRENT_NOT_FOLLOWING, 1101));
    start(CURRENT_CHECK_ALWAYS, 0, 1000);
    TEST_ASSERT_EQUAL_UINT32(10, ticks_until(CURRENT_NOT_FOLLOWING, 899));
}

static void test_a_trip_at_the_level_is_none_and_comes_in_its_time_beyond(void) {
    start(CURRENT_CHECK_NEVER, 3000, 1000);
    TEST_ASSERT_EQUAL_UINT32(0, ticks_until(CURRENT_OVER, 3000));
    TEST_ASSERT_EQUAL_UINT32(0, ticks_until(CURRENT_OVER, -3000));
    TEST_ASSERT_EQUAL_UINT32(5, ticks_until(CURRENT_OVER, 3001));
    start(CURRENT_CHECK_NEVER, 3000, 1000);
    TEST_ASSERT_EQUAL_UINT32(5, ticks_until(CURRENT_OVER, -3001));
}

static void test_the_least_level_of_a_trip_trips(void) {
    start(CURRENT_CHECK_NEVER, 1, 0);
    TEST_ASSERT_EQUAL_UINT32(5, ticks_until(CURRENT_OVER, 2));
    start(CURRENT_CHECK_NEVER, 0, 0);
    TEST_ASSERT_EQUAL_UINT32(0, ticks_until(CURRENT_OVER, INT32_MAX));
}

static void test_good_ticks_take_back_an_eighth_of_a_trip(void) {
    start(CURRENT_CHECK_NEVER, 3000, 1000);
    for (uint32_t i = 0; i < 4; i++) {
        TEST_ASSERT_EQUAL(CURRENT_OK, step(3001));
    }
    for (uint32_t i = 0; i < 8; i++) { // one of the four
        TEST_ASSERT_EQUAL(CURRENT_OK, step(1000));
    }
    TEST_ASSERT_EQUAL(CURRENT_OK, step(3001));
    TEST_ASSERT_EQUAL(CURRENT_OVER, step(3001));
}

static void test_good_ticks_take_back_a_quarter_of_an_error(void) {
    start(CURRENT_CHECK_ALWAYS, 0, 1000);
    for (uint32_t i = 0; i < 9; i++) {
        TEST_ASSERT_EQUAL(CURRENT_OK, step(2000));
    }
    for (uint32_t i = 0; i < 4; i++) {
        TEST_ASSERT_EQUAL(CURRENT_OK, step(1000));
    }
    TEST_ASSERT_EQUAL(CURRENT_OK, step(2000));
    TEST_ASSERT_EQUAL(CURRENT_NOT_FOLLOWING, step(2000));
}

// A single bad tick is forgotten to the last count.
static void test_counts_go_back_to_nothing(void) {
    start(CURRENT_CHECK_ALWAYS, 3000, 1000);
    (void)step(5000);
    for (uint32_t i = 0; i < 8; i++) {
        (void)step(1000);
    }
    TEST_ASSERT_EQUAL_UINT32(0, monitor.over);
    TEST_ASSERT_EQUAL_UINT32(0, monitor.wrong);
}

static void test_a_coil_is_open_from_twice_the_error_on(void) {
    start(CURRENT_CHECK_ALWAYS, 0, 200);
    for (uint32_t i = 0; i < 10; i++) {
        (void)current_monitor_step(&monitor, 200, 49, true);
    }
    TEST_ASSERT_EQUAL(CURRENT_OPEN_COIL, current_monitor_step(&monitor, 200, 49, true));
    TEST_ASSERT_EQUAL(CURRENT_OPEN_COIL, current_monitor_step(&monitor, 200, -49, true));
    TEST_ASSERT_EQUAL(CURRENT_NOT_FOLLOWING, current_monitor_step(&monitor, 200, 50, true));
    start(CURRENT_CHECK_ALWAYS, 0, 199);
    for (uint32_t i = 0; i < 10; i++) {
        (void)current_monitor_step(&monitor, 199, 0, true);
    }
    TEST_ASSERT_EQUAL(CURRENT_NOT_FOLLOWING, current_monitor_step(&monitor, 199, 0, true));
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(test_the_expectation_starts_at_the_initial_current_and_lags);
    RUN_TEST(test_what_is_followed_is_expected_and_forgives);
    RUN_TEST(test_no_lag_is_the_command);
    RUN_TEST(test_the_error_itself_is_allowed_on_either_side);
    RUN_TEST(test_a_trip_at_the_level_is_none_and_comes_in_its_time_beyond);
    RUN_TEST(test_the_least_level_of_a_trip_trips);
    RUN_TEST(test_good_ticks_take_back_an_eighth_of_a_trip);
    RUN_TEST(test_good_ticks_take_back_a_quarter_of_an_error);
    RUN_TEST(test_counts_go_back_to_nothing);
    RUN_TEST(test_a_coil_is_open_from_twice_the_error_on);
    return UNITY_END();
}
