// Heat of a coil to its last bit: where it starts, its lag, its budget, its limits.
#include "heat.h"
#include "unity.h"

#define Q20 (INT64_C(1) << 20)

static heat_t heat;

void setUp(void) {}
void tearDown(void) {}

static void start(int32_t continuous_mA, int32_t time_s, uint32_t rate_Hz) {
    heat_init(&heat, &(heat_cfg_t){rate_Hz, continuous_mA, time_s});
}

// 2000 mA: 4,000,000 mA2 / 16.
static void test_the_budget_is_the_square_and_half_of_it_is_the_start(void) {
    start(2000, 10, 500);
    TEST_ASSERT_TRUE(heat.budget_q20 == 250000 * Q20);
    TEST_ASSERT_TRUE(heat.heat_q20 == 125000 * Q20);
    TEST_ASSERT_EQUAL_UINT32(858993, heat.gain_q32); // 2^32 / 5000, down
    TEST_ASSERT_EQUAL_INT32(2000, heat.continuous_mA);
}

// 15 bits of a tenth.
static void test_a_tenth_of_the_budget_has_15_bits(void) {
    static const int32_t currents_mA[] = {1, 3, 4, 5, 12, 100, 2000, 20000};
    for (uint32_t i = 0; i < sizeof currents_mA / sizeof currents_mA[0]; i++) {
        start(currents_mA[i], 10, 500);
        const int64_t square = (int64_t)currents_mA[i] * currents_mA[i] / 16;
        const int64_t tenth = (square > 0 ? square : 1) * Q20 / 10;
        TEST_ASSERT_TRUE(heat.tenth >= 1u << 14 && heat.tenth < 1u << 15);
        TEST_ASSERT_TRUE((int64_t)heat.tenth << heat.shift <= tenth);
        TEST_ASSERT_TRUE((int64_t)(heat.tenth + 1u) << heat.shift > tenth);
    }
}

static void test_a_current_too_small_for_the_budget_has_the_least_one(void) {
    for (int32_t current_mA = 1; current_mA <= 5; current_mA++) {
        start(current_mA, 10, 500);
        TEST_ASSERT_TRUE(heat.budget_q20 == Q20); // 25 / 16, down
    }
}

// From nothing, one tick: the square / 16, up, times the gain, up.
static void check_step(int32_t current_mA, int64_t square) {
    start(2000, 10, 500);
    heat.heat_q20 = 0;
    heat_step(&heat, current_mA);
    const int64_t exact_q34 = square * 4 * heat.gain_q32; // Q2 times Q32
    TEST_ASSERT_TRUE(heat.heat_q20 == (exact_q34 + (1 << 14) - 1) / (1 << 14));
}

static void test_a_step_is_rounded_up_of_either_sign(void) {
    check_step(0, 0);
    check_step(1, 1); // 1 / 16, up
    check_step(-1, 1);
    check_step(4, 1);
    check_step(5, 2);
    check_step(1234, 95173);
    check_step(-1234, 95173);
}

// No measurement counts for more than twice the highest current.
static void test_a_current_beyond_all_counts_as_twice_the_highest(void) {
    static const int32_t beyond_mA[] = {40001, 50000, INT32_MAX, -40001, INT32_MIN};
    check_step(40000, 100000000);
    check_step(-40000, 100000000);
    check_step(39999, 99995001);
    check_step(-39999, 99995001);
    for (uint32_t i = 0; i < sizeof beyond_mA / sizeof beyond_mA[0]; i++) {
        check_step(beyond_mA[i], 100000000);
    }
}

// To nothing, less a step of the least difference: 0.00003 of (mA)2 / 16.
static void test_a_coil_cools_down_to_nothing(void) {
    start(2000, 5, 4000);
    int64_t last_q20 = heat.heat_q20;
    for (uint32_t i = 0; i < 400000; i++) {
        heat_step(&heat, 0);
        TEST_ASSERT_TRUE(heat.heat_q20 > -32 && heat.heat_q20 <= last_q20);
        last_q20 = heat.heat_q20;
    }
    TEST_ASSERT_TRUE(last_q20 < heat.budget_q20 / 1000);
}

static void set_left(int64_t left_q20) {
    heat.heat_q20 = heat.budget_q20 - left_q20;
}

static void test_the_limit_is_a_line_over_the_last_tenth(void) {
    start(2000, 10, 500);
    const int64_t tenth_q20 = (int64_t)heat.tenth << heat.shift;
    set_left(tenth_q20); // not within it yet
    TEST_ASSERT_FALSE(heat_is_near_budget(&heat));
    TEST_ASSERT_FALSE(heat_is_limiting(&heat, 4000));
    TEST_ASSERT_EQUAL_INT32(4000, heat_limit_mA(&heat, 4000));
    set_left(tenth_q20 - 1);
    TEST_ASSERT_TRUE(heat_is_near_budget(&heat));
    TEST_ASSERT_TRUE(heat_is_limiting(&heat, 4000));
    TEST_ASSERT_FALSE(heat_is_limiting(&heat, 2000)); // nothing is taken away
    TEST_ASSERT_EQUAL_INT32(3999, heat_limit_mA(&heat, 4000));
    for (uint32_t left = 0; left < heat.tenth; left += 97) {
        set_left((int64_t)left << heat.shift);
        const int32_t expected_mA = 2000 + (int32_t)(2000u * left / heat.tenth);
        TEST_ASSERT_EQUAL_INT32(expected_mA, heat_limit_mA(&heat, 4000));
    }
    set_left(-1);
    TEST_ASSERT_EQUAL_INT32(2000, heat_limit_mA(&heat, 4000));
}

static void test_a_sixteenth_above_the_budget_is_excessive(void) {
    start(2000, 10, 500);
    set_left(-heat.budget_q20 / 16);
    TEST_ASSERT_FALSE(heat_is_excessive(&heat));
    heat.heat_q20++;
    TEST_ASSERT_TRUE(heat_is_excessive(&heat));
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(test_the_budget_is_the_square_and_half_of_it_is_the_start);
    RUN_TEST(test_a_tenth_of_the_budget_has_15_bits);
    RUN_TEST(test_a_current_too_small_for_the_budget_has_the_least_one);
    RUN_TEST(test_a_step_is_rounded_up_of_either_sign);
    RUN_TEST(test_a_current_beyond_all_counts_as_twice_the_highest);
    RUN_TEST(test_a_coil_cools_down_to_nothing);
    RUN_TEST(test_the_limit_is_a_line_over_the_last_tenth);
    RUN_TEST(test_a_sixteenth_above_the_budget_is_excessive);
    return UNITY_END();
}
