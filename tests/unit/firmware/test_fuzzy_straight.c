// Straight-line C of fuzzy systems: the same answers everywhere.
#include <stdbool.h>

#include "fuzzy_polynomial.h"
#include "straight_cases.h"
#include "unity.h"

void setUp(void) {}
void tearDown(void) {}

static void test_the_same_answers_everywhere(void) {
    for (uint32_t i = 0; i < STRAIGHT_CASES; i++) {
        const straight_case_t *one = &straight_cases[i];
        for (uint32_t k = 0; k < one->points_count; k++) {
            int32_t found[STRAIGHT_MAX_OUTPUTS] = {0};
            const uint32_t is_default = one->function(one->points[k].input, found);
            TEST_ASSERT_EQUAL_HEX32_MESSAGE(one->points[k].is_default, is_default, one->name);
            TEST_ASSERT_EQUAL_INT32_ARRAY_MESSAGE(one->points[k].output, found, one->outputs,
                                                  one->name);
        }
    }
}

/// In any grid over all of int32 no value leaves the ends of an output that keeps to its range.
static void test_values_stay_in_their_range_at_every_int32(void) {
    const straight_case_t *weak = &straight_cases[STRAIGHT_WEAK];
    for (int64_t x = INT32_MIN; x <= INT32_MAX; x += 0x03FFFFFF) {
        for (int64_t y = -40000; y <= 40000; y += 997) {
            const int32_t input[STRAIGHT_MAX_INPUTS] = {(int32_t)y, (int32_t)x, (int32_t)y};
            int32_t found[STRAIGHT_MAX_OUTPUTS] = {0};
            (void)weak->function(input, found);
            TEST_ASSERT_INT32_WITHIN(32768, 32768, found[0]);
        }
    }
}

static void test_inputs_beyond_the_universe_are_its_ends(void) {
    const straight_case_t *one = &straight_cases[STRAIGHT_SUGENO];
    const int32_t ends[2][2] = {{0, 32768}, {32768, 0}};
    const int32_t more[2][2] = {{-1, INT32_MAX}, {32769, INT32_MIN}};
    for (uint32_t i = 0; i < 2u; i++) {
        int32_t at_end = 0, beyond = 0;
        (void)one->function(ends[i], &at_end);
        (void)one->function(more[i], &beyond);
        TEST_ASSERT_EQUAL_INT32(at_end, beyond);
    }
}

static void test_a_step_rounds_down(void) {
    TEST_ASSERT_EQUAL_INT32(5, fuzzy_step(5, 1, 1));
    TEST_ASSERT_EQUAL_INT32(4, fuzzy_step(5, -1, 1));
    TEST_ASSERT_EQUAL_INT32(4, fuzzy_step(5, 1, -1));
    TEST_ASSERT_EQUAL_INT32(1073741824, fuzzy_step(0, INT32_MIN, INT32_MIN));
    TEST_ASSERT_EQUAL_INT32(-1073741824, fuzzy_step(0, INT32_MAX, INT32_MIN));
    TEST_ASSERT_EQUAL_INT32(-3, fuzzy_lesser(-3, 2));
    TEST_ASSERT_EQUAL_INT32(2, fuzzy_greater(-3, 2));
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(test_the_same_answers_everywhere);
    RUN_TEST(test_values_stay_in_their_range_at_every_int32);
    RUN_TEST(test_inputs_beyond_the_universe_are_its_ends);
    RUN_TEST(test_a_step_rounds_down);
    return UNITY_END();
}
