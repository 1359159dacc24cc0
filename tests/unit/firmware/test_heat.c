// Heat of a coil to its last bit: where it starts, its lag, its budget, its limits.
#include "heat.h"
#include "unity.h"

#define Q20 (INT64_C(1) << 20)

static heat_t heat;

void setUp(void) {}
void tearDown(void) {}

static heat_cfg_t cfg_of(int32_t continuous_mA, int32_t highest_mA) {
    return (heat_cfg_t){.tick_rate_Hz = 500,
                        .continuous_mA = continuous_mA,
                        .highest_mA = highest_mA,
                        .time_s = 10,
                        .settle_us = 1000,
                        .first_ticks = HEAT_SLICE_TICKS};
}

static void run_slice(int32_t current_mA) {
    for (uint32_t i = 0; i < HEAT_SLICE_TICKS; i++) {
        heat_step(&heat, current_mA);
    }
}

static void start(int32_t continuous_mA, int32_t highest_mA) {
    const heat_cfg_t cfg = cfg_of(continuous_mA, highest_mA);
    heat_init(&heat, &cfg);
}

// 2000 mA: 4,000,000 mA2 / 16.
static void test_the_budget_is_the_square_and_half_of_it_is_the_start(void) {
    start(2000, 4000);
    TEST_ASSERT_TRUE(heat_budget_q20(&heat) == 250000 * Q20);
    TEST_ASSERT_TRUE(heat.heat_q20 == 125000 * Q20);
    TEST_ASSERT_EQUAL_UINT32(13743895, heat.gain_q32); // 2^32 * 16 / 5000, down
}

static void check_line(int64_t line_q20) {
    TEST_ASSERT_TRUE(heat.line >= 1 << 14 && heat.line < 1 << 15);
    TEST_ASSERT_TRUE((int64_t)heat.line << heat.shift <= line_q20);
    TEST_ASSERT_TRUE((int64_t)(heat.line + 1u) << heat.shift > line_q20);
}

static void test_the_line_lies_over_a_tenth_of_the_budget_in_15_bits(void) {
    static const int32_t currents_mA[] = {1, 3, 4, 5, 12, 100, 2000, 19999};
    for (uint32_t i = 0; i < sizeof currents_mA / sizeof currents_mA[0]; i++) {
        start(currents_mA[i], currents_mA[i] + 1);
        const int64_t square = (int64_t)currents_mA[i] * currents_mA[i] / 16;
        check_line((square > 0 ? square : 1) * Q20 / 10);
    }
}

// Current that takes 2 s to fall, of the coil's 10: 3/4 of 4000 mA's square for a fifth, four
// times.
static void test_the_line_is_as_long_as_a_slow_current_needs(void) {
    heat_cfg_t cfg = cfg_of(2000, 4000);
    cfg.settle_us = 2000000;
    heat_init(&heat, &cfg);
    check_line(750000 * Q20 / 1000000 * 2000000 / 10 * 4);
    cfg = cfg_of(2000, 20000); // the longest there is
    cfg.settle_us = 100000000;
    cfg.time_s = 5;
    heat_init(&heat, &cfg);
    check_line(24750000 * Q20 / 1000000 * 100000000 / 5 * 4);
    TEST_ASSERT_TRUE(heat_is_limiting(&heat)); // from the start
}

static void test_a_current_too_small_for_the_budget_has_the_least_one(void) {
    for (int32_t current_mA = 1; current_mA <= 5; current_mA++) {
        start(current_mA, 10);
        TEST_ASSERT_TRUE(heat_budget_q20(&heat) == Q20); // 25 / 16, down
    }
}

// From nothing, one slice: the square of half a milliampere more / 16, times the gain, up.
static void check_slice(int32_t current_mA, int64_t square_x64) {
    start(2000, 4000);
    heat_resume(&heat, 0);
    run_slice(current_mA);
    const int64_t exact_q34 = (square_x64 * (Q20 / 64) >> 18) * heat.gain_q32; // Q2 times Q32
    TEST_ASSERT_TRUE(heat.heat_q20 == (exact_q34 + (1 << 14) - 1) / (1 << 14));
}

static void test_a_slice_is_rounded_up_of_either_sign(void) {
    check_slice(0, 1);
    check_slice(1, 9);
    check_slice(-1, 9);
    check_slice(4, 81);
    check_slice(1234, INT64_C(2469) * 2469);
    check_slice(-1234, INT64_C(2469) * 2469);
}

// No measurement counts for more than twice the highest current.
static void test_a_current_beyond_all_counts_as_twice_the_highest(void) {
    static const int32_t beyond_mA[] = {40000, 40001, 50000, INT32_MAX, -40000, -40001, INT32_MIN};
    check_slice(39999, INT64_C(79999) * 79999);
    check_slice(-39999, INT64_C(79999) * 79999);
    for (uint32_t i = 0; i < sizeof beyond_mA / sizeof beyond_mA[0]; i++) {
        check_slice(beyond_mA[i], INT64_C(80001) * 80001);
    }
}

// Nothing moves within a slice; the first one is as long as it is told.
static void test_a_slice_takes_the_mean_of_its_ticks(void) {
    for (uint32_t first = 1; first <= HEAT_SLICE_TICKS; first++) {
        heat_cfg_t cfg = cfg_of(2000, 4000);
        cfg.first_ticks = first;
        heat_init(&heat, &cfg);
        const int64_t before_q20 = heat.heat_q20;
        for (uint32_t i = 1; i <= first; i++) {
            TEST_ASSERT_TRUE(heat.heat_q20 == before_q20);
            heat_step(&heat, 4000);
        }
        TEST_ASSERT_TRUE(heat.heat_q20 != before_q20);
    }
    start(2000, 4000);
    for (uint32_t i = 0; i < HEAT_SLICE_TICKS / 2u; i++) {
        heat_step(&heat, 3000);
        heat_step(&heat, 1000);
    }
    const int64_t mixed_q20 = heat.heat_q20;
    start(2000, 4000);
    run_slice(2236); // the root of half of 3000's and 1000's square
    const int64_t difference_q20 = heat.heat_q20 - mixed_q20;
    TEST_ASSERT_TRUE(difference_q20 < 2 * Q20 && difference_q20 > -2 * Q20); // of 250,000
}

// To the half milliampere that no current may be, less a step of the least difference.
static void test_a_coil_cools_down_to_nothing(void) {
    heat_cfg_t cfg = cfg_of(2000, 4000);
    cfg.time_s = 5;
    cfg.tick_rate_Hz = 4000;
    heat_init(&heat, &cfg);
    int64_t last_q20 = heat.heat_q20;
    for (uint32_t i = 0; i < 400000 / HEAT_SLICE_TICKS; i++) {
        run_slice(0);
        TEST_ASSERT_TRUE(heat.heat_q20 > 0 && heat.heat_q20 <= last_q20);
        last_q20 = heat.heat_q20;
    }
    TEST_ASSERT_TRUE(last_q20 < heat_budget_q20(&heat) / 1000);
}

static void set_left(int64_t left_q20) {
    heat_resume(&heat, heat_budget_q20(&heat) - left_q20);
}

// Its end: 2000 mA less a 64th and 1.
static void test_the_limit_is_a_line_to_less_than_the_continuous_current(void) {
    start(2000, 4000);
    const int64_t line_q20 = (int64_t)heat.line << heat.shift;
    set_left(line_q20); // not within it yet
    TEST_ASSERT_FALSE(heat_is_limiting(&heat));
    TEST_ASSERT_EQUAL_INT32(4000, heat_limit_mA(&heat));
    set_left(line_q20 - 1);
    TEST_ASSERT_TRUE(heat_is_limiting(&heat));
    TEST_ASSERT_EQUAL_INT32(3999, heat_limit_mA(&heat));
    for (uint32_t left = 0; left < heat.line; left += 97) {
        set_left((int64_t)left << heat.shift);
        const int32_t expected_mA = 1968 + (int32_t)(2032u * left / heat.line);
        TEST_ASSERT_EQUAL_INT32(expected_mA, heat_limit_mA(&heat));
    }
    set_left(-1);
    TEST_ASSERT_EQUAL_INT32(1968, heat_limit_mA(&heat));
}

static void test_nothing_is_derated_where_the_highest_is_the_continuous_current(void) {
    static const int32_t highest_mA[] = {0, 1, 500, 2000};
    for (uint32_t i = 0; i < sizeof highest_mA / sizeof highest_mA[0]; i++) {
        start(2000, highest_mA[i]);
        const int64_t budget_q20 = heat_budget_q20(&heat);
        for (int64_t left_q20 = -budget_q20; left_q20 <= budget_q20; left_q20 += budget_q20 / 64) {
            set_left(left_q20);
            TEST_ASSERT_FALSE(heat_is_limiting(&heat));
            TEST_ASSERT_EQUAL_INT32(highest_mA[i], heat_limit_mA(&heat));
        }
    }
}

static void test_a_sixteenth_above_the_budget_is_excessive(void) {
    start(2000, 4000);
    const int64_t excess_q20 = heat_budget_q20(&heat) / 16 + 3 * Q20;
    set_left(-excess_q20);
    TEST_ASSERT_FALSE(heat_is_excessive(&heat));
    set_left(-excess_q20 - 1);
    TEST_ASSERT_TRUE(heat_is_excessive(&heat));
}

// A coil that carries its continuous current for ever is not too hot, however small that is.
static void test_the_continuous_current_is_never_excessive(void) {
    for (int32_t continuous_mA = 1; continuous_mA <= 64; continuous_mA++) {
        start(continuous_mA, continuous_mA);
        for (uint32_t i = 0; i < 100000; i++) { // 20 time constants
            heat_step(&heat, continuous_mA);
        }
        TEST_ASSERT_FALSE(heat_is_excessive(&heat));
    }
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(test_the_budget_is_the_square_and_half_of_it_is_the_start);
    RUN_TEST(test_the_line_lies_over_a_tenth_of_the_budget_in_15_bits);
    RUN_TEST(test_the_line_is_as_long_as_a_slow_current_needs);
    RUN_TEST(test_a_current_too_small_for_the_budget_has_the_least_one);
    RUN_TEST(test_a_slice_is_rounded_up_of_either_sign);
    RUN_TEST(test_a_slice_takes_the_mean_of_its_ticks);
    RUN_TEST(test_a_current_beyond_all_counts_as_twice_the_highest);
    RUN_TEST(test_a_coil_cools_down_to_nothing);
    RUN_TEST(test_the_limit_is_a_line_to_less_than_the_continuous_current);
    RUN_TEST(test_nothing_is_derated_where_the_highest_is_the_continuous_current);
    RUN_TEST(test_a_sixteenth_above_the_budget_is_excessive);
    RUN_TEST(test_the_continuous_current_is_never_excessive);
    return UNITY_END();
}
