// Guard, current monitor and heat.
#include "current_monitor.h"
#include "guard.h"
#include "heat.h"
#include "unity.h"

static guard_t guard;
static current_monitor_t monitor;

static const guard_cfg_t guard_cfg = {
    .max_mA = 5000, .safe_mA = 700, .slew_mA_s = 1000000, .tick_rate_Hz = 1000};
static const current_monitor_cfg_t monitor_cfg = {.check = CURRENT_CHECK_ALWAYS,
                                                  .tick_rate_Hz = 1000,
                                                  .error_mA = 500,
                                                  .lag_us = 5000,
                                                  .fault_ticks = 20};

void setUp(void) {
    guard_init(&guard, &guard_cfg);
    current_monitor_init(&monitor, &monitor_cfg);
}
void tearDown(void) {}

static void test_guard_denies_by_default(void) {
    TEST_ASSERT_EQUAL_INT32(700, guard_step(&guard, 5000, false));
}

static void test_guard_limits_range_and_slew(void) {
    TEST_ASSERT_EQUAL_INT32(1700, guard_step(&guard, INT32_MAX, true));
    TEST_ASSERT_EQUAL_INT32(2700, guard_step(&guard, 6000, true));
    for (uint32_t i = 0; i < 10; i++) {
        TEST_ASSERT_TRUE(guard_step(&guard, INT32_MAX, true) <= 5000);
    }
    TEST_ASSERT_EQUAL_INT32(5000, guard_step(&guard, 5000, true));
    TEST_ASSERT_EQUAL_INT32(4000, guard_step(&guard, INT32_MIN, true));
}

static void test_guard_reaches_the_safe_current_at_once(void) {
    for (uint32_t i = 0; i < 10; i++) {
        guard_step(&guard, 5000, true);
    }
    TEST_ASSERT_EQUAL_INT32(700, guard_step(&guard, 5000, false));
    TEST_ASSERT_EQUAL_INT32(1700, guard_step(&guard, 5000, true));
}

static void test_guard_with_senseless_limits_stays_defined(void) {
    const guard_cfg_t broken = {
        .max_mA = -5, .safe_mA = 99999, .slew_mA_s = INT32_MIN, .tick_rate_Hz = 1};
    guard_init(&guard, &broken);
    TEST_ASSERT_EQUAL_INT32(0, guard_step(&guard, 5000, false));
    TEST_ASSERT_EQUAL_INT32(0, guard_step(&guard, 5000, true));
}

// The coil's own lag, in the monitor's expectation: a driver that follows is never suspected.
static void test_monitor_accepts_a_lagging_coil(void) {
    int32_t coil_mA = 0;
    for (uint32_t i = 0; i < 400; i++) {
        const uint16_t command_mA = i / 50 % 2 ? 0u : 5000u;
        TEST_ASSERT_EQUAL(CURRENT_OK,
                          current_monitor_step(&monitor, command_mA, coil_mA, CURRENT_NEW));
        coil_mA += (command_mA - coil_mA) / 6;
    }
}

static current_verdict_t run_monitor(uint16_t command_mA, int32_t measured_mA, bool is_measured,
                                     uint32_t ticks) {
    current_verdict_t verdict = CURRENT_OK;
    for (uint32_t i = 0; i < ticks; i++) {
        verdict = current_monitor_step(&monitor, command_mA, measured_mA,
                                       is_measured ? CURRENT_NEW : CURRENT_NONE);
    }
    return verdict;
}

static void test_monitor_names_the_fault(void) {
    TEST_ASSERT_EQUAL(CURRENT_OK, run_monitor(5000, 0, true, 15));
    TEST_ASSERT_EQUAL(CURRENT_OPEN_COIL, run_monitor(5000, 0, true, 30));
    current_monitor_init(&monitor, &monitor_cfg);
    current_monitor_follow(&monitor, 5000);
    TEST_ASSERT_EQUAL(CURRENT_NOT_FOLLOWING, run_monitor(5000, 3000, true, 30));
    current_monitor_init(&monitor, &monitor_cfg);
    TEST_ASSERT_EQUAL(CURRENT_NOT_FOLLOWING, run_monitor(0, 3000, true, 30)); // stuck on
    current_monitor_init(&monitor, &monitor_cfg);
    TEST_ASSERT_EQUAL(CURRENT_OK, run_monitor(0, 0, false, 19));
    TEST_ASSERT_EQUAL(CURRENT_MISSING, run_monitor(0, 0, false, 1));
}

static void test_monitor_off_and_extremes(void) {
    current_monitor_cfg_t off = monitor_cfg;
    off.check = CURRENT_CHECK_NEVER;
    current_monitor_init(&monitor, &off);
    TEST_ASSERT_EQUAL(CURRENT_OK, run_monitor(5000, 0, true, 1000));
    current_monitor_init(&monitor, &monitor_cfg);
    TEST_ASSERT_EQUAL(CURRENT_NOT_FOLLOWING, run_monitor(20000, INT32_MIN, true, 30));
    TEST_ASSERT_EQUAL(CURRENT_NOT_FOLLOWING, run_monitor(20000, INT32_MAX, true, 30));
}

// Whatever lies between: 20 A in 49 of 50 ticks, or in one of four.
static void test_monitor_does_not_forgive_for_a_good_sample(void) {
    for (uint32_t good = 1; good <= 3; good += 2) {
        const uint32_t of = good == 1 ? 50 : 4;
        bool is_seen = false;
        current_monitor_init(&monitor, &monitor_cfg);
        current_monitor_follow(&monitor, 1000);
        for (uint32_t i = 0; i < 1500 && !is_seen; i++) {
            const int32_t measured_mA = i % of < good ? 1000 : 20000;
            is_seen = current_monitor_step(&monitor, 1000, measured_mA, CURRENT_NEW) != CURRENT_OK;
        }
        TEST_ASSERT_TRUE(is_seen);
    }
}

static void test_monitor_forgets_what_is_rare(void) {
    for (uint32_t i = 0; i < 100000; i++) {
        const int32_t measured_mA = i % 10 == 0 ? 20000 : 1000;
        TEST_ASSERT_EQUAL(CURRENT_OK,
                          current_monitor_step(&monitor, 1000, measured_mA, CURRENT_NEW));
    }
}

static void start_trip(uint32_t trip_ticks) {
    current_monitor_cfg_t cfg = monitor_cfg;
    cfg.check = CURRENT_CHECK_NEVER;
    cfg.trip_mA = 6000;
    cfg.trip_ticks = trip_ticks;
    current_monitor_init(&monitor, &cfg);
}

static void test_monitor_trips_in_its_time_also_with_the_check_off(void) {
    start_trip(3);
    TEST_ASSERT_EQUAL(CURRENT_OK, run_monitor(5000, 6000, true, 1000));
    TEST_ASSERT_EQUAL(CURRENT_OK, run_monitor(5000, 6001, true, 2));
    TEST_ASSERT_EQUAL(CURRENT_OVER, run_monitor(5000, 6001, true, 1));
    start_trip(3);
    TEST_ASSERT_EQUAL(CURRENT_OVER, run_monitor(0, INT32_MIN, true, 3));
    start_trip(3);
    for (uint32_t i = 0; i < 2; i++) { // bursts of two
        TEST_ASSERT_EQUAL(CURRENT_OK, run_monitor(5000, 5000, true, 1));
        (void)run_monitor(5000, -20000, true, 2);
    }
    TEST_ASSERT_EQUAL(CURRENT_OVER, run_monitor(5000, -20000, true, 1));
    current_monitor_reset(&monitor);
    TEST_ASSERT_EQUAL(CURRENT_OK, run_monitor(5000, -20000, true, 2));
}

static void test_monitor_of_a_current_that_may_be_measured(void) {
    current_monitor_cfg_t cfg = monitor_cfg;
    cfg.check = CURRENT_CHECK_ONCE_SEEN;
    current_monitor_init(&monitor, &cfg);
    TEST_ASSERT_EQUAL(CURRENT_OK, run_monitor(5000, 0, false, 1000));
    current_monitor_init(&monitor, &cfg);
    current_monitor_follow(&monitor, 5000);
    TEST_ASSERT_EQUAL(CURRENT_OK, run_monitor(5000, 5000, true, 1));
    TEST_ASSERT_EQUAL(CURRENT_OK, run_monitor(5000, 0, false, 19));
    TEST_ASSERT_EQUAL(CURRENT_MISSING, run_monitor(5000, 0, false, 1));
}

static heat_t heat;

static void heat_for(int32_t current_mA, uint32_t ticks) {
    for (; ticks > 0; ticks--) {
        heat_step(&heat, current_mA);
    }
}

// Of the budget.
static int32_t heat_permille(void) {
    return (int32_t)(heat.heat_q20 * 1000 / heat_budget_q20(&heat));
}

static void start_heat(int32_t continuous_mA, int32_t highest_mA) {
    heat_init(&heat, &(heat_cfg_t){.tick_rate_Hz = 500,
                                   .continuous_mA = continuous_mA,
                                   .highest_mA = highest_mA,
                                   .time_s = 10,
                                   .settle_us = 36000, // a slice and two ticks
                                   .first_ticks = HEAT_SLICE_TICKS});
}

static void test_heat_of_the_continuous_current_ends_at_its_budget(void) {
    start_heat(2000, 4000);
    heat_for(2000, 100000); // 20 time constants
    TEST_ASSERT_INT32_WITHIN(1, 1000, heat_permille());
    TEST_ASSERT_FALSE(heat_is_excessive(&heat));
    TEST_ASSERT_EQUAL_INT32(1968, heat_limit_mA(&heat)); // less a 64th and 1
    heat_for(0, 5000);                                   // one
    TEST_ASSERT_INT32_WITHIN(2, 368, heat_permille());
    TEST_ASSERT_EQUAL_INT32(4000, heat_limit_mA(&heat));
}

static void test_heat_stays_within_its_budget(void) {
    static const int32_t rows[][2] = {{4000, 2000}, {20000, 2000}, {20000, 19999}, {1000, 100}};
    for (uint32_t i = 0; i < 4; i++) {
        const int32_t lowest_mA = rows[i][1] - rows[i][1] / 64 - 1;
        int32_t least_mA = INT32_MAX;
        start_heat(rows[i][1], rows[i][0]);
        for (uint32_t t = 0; t < 50000; t++) {
            const int32_t limit_mA = heat_limit_mA(&heat);
            TEST_ASSERT_TRUE(limit_mA >= lowest_mA && limit_mA <= rows[i][0]);
            TEST_ASSERT_TRUE(limit_mA == rows[i][0] || heat_is_limiting(&heat));
            TEST_ASSERT_TRUE(heat.heat_q20 <= heat_budget_q20(&heat));
            heat_step(&heat, t & 1u ? limit_mA : -limit_mA);
            least_mA = limit_mA < least_mA ? limit_mA : least_mA;
        }
        TEST_ASSERT_INT32_WITHIN(rows[i][1] / 50 + 1, rows[i][1], least_mA);
    }
}

static void test_heat_of_a_driver_that_gives_more_is_excessive(void) {
    start_heat(2000, 4000);
    heat_for(4000, 3000);
    TEST_ASSERT_TRUE(heat_is_excessive(&heat));
    TEST_ASSERT_EQUAL_INT32(1968, heat_limit_mA(&heat));
    start_heat(4000, 4000);
    heat_for(INT32_MIN, 100); // bounded
    TEST_ASSERT_TRUE(heat.heat_q20 > 0);
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(test_guard_denies_by_default);
    RUN_TEST(test_guard_limits_range_and_slew);
    RUN_TEST(test_guard_reaches_the_safe_current_at_once);
    RUN_TEST(test_guard_with_senseless_limits_stays_defined);
    RUN_TEST(test_monitor_accepts_a_lagging_coil);
    RUN_TEST(test_monitor_names_the_fault);
    RUN_TEST(test_monitor_off_and_extremes);
    RUN_TEST(test_monitor_does_not_forgive_for_a_good_sample);
    RUN_TEST(test_monitor_forgets_what_is_rare);
    RUN_TEST(test_monitor_trips_in_its_time_also_with_the_check_off);
    RUN_TEST(test_monitor_of_a_current_that_may_be_measured);
    RUN_TEST(test_heat_of_the_continuous_current_ends_at_its_budget);
    RUN_TEST(test_heat_stays_within_its_budget);
    RUN_TEST(test_heat_of_a_driver_that_gives_more_is_excessive);
    return UNITY_END();
}
