// What a change costs: by its definition, and bounded whatever it is told.
#include "adapt_cost.h"

#include "test_signal.h"
#include "unity.h"

enum { ONE_q20 = 10486 }; // 1 %

static const adapt_goal_t reach_only = {0, 0, 0};

void setUp(void) {}
void tearDown(void) {}

static void test_reach_counts_as_it_changes(void) {
    const adapt_effect_t from = {1000000, 700000};
    const adapt_effect_t to = {980000, 900000};
    TEST_ASSERT_INT32_WITHIN(30, -2 * ONE_q20,
                             adapt_cost_q20(from, to, reach_only, ADAPT_NO_LIMIT));
    TEST_ASSERT_INT32_WITHIN(30, -2 * ONE_q20, adapt_drift_q20(from, to));
}

// Within the limit nothing; beyond it twice the excess, and getting nearer to it is a gain.
static void test_acceleration_counts_twice_beyond_its_limit(void) {
    const uint32_t limit_um_s2 = 707000;
    const adapt_effect_t at = {1000000, 700000};
    const adapt_effect_t within = {1000000, 707000};
    const adapt_effect_t beyond = {1000000, 714000};
    TEST_ASSERT_EQUAL_INT32(0, adapt_cost_q20(at, within, reach_only, limit_um_s2));
    TEST_ASSERT_INT32_WITHIN(60, 2 * ONE_q20, adapt_cost_q20(at, beyond, reach_only, limit_um_s2));
    TEST_ASSERT_INT32_WITHIN(60, -2 * ONE_q20 * 100 / 102,
                             adapt_cost_q20(beyond, within, reach_only, limit_um_s2));
}

static void test_the_limit_is_a_factor_of_what_is_free(void) {
    const adapt_goal_t goal = {0, 0, 101};
    TEST_ASSERT_UINT32_WITHIN(100, 1010000, adapt_limit_um_s2(goal, 1000000));
    TEST_ASSERT_EQUAL_UINT32(ADAPT_NO_LIMIT, adapt_limit_um_s2(goal, 0));
    TEST_ASSERT_EQUAL_UINT32(ADAPT_NO_LIMIT, adapt_limit_um_s2(reach_only, 1000000));
    TEST_ASSERT_EQUAL_UINT32(ADAPT_NO_LIMIT, adapt_limit_um_s2(goal, UINT32_MAX));
}

static void test_it_is_bounded_for_any_effects_and_goals(void) {
    uint32_t seed = 5;
    for (uint32_t i = 0; i < 20000u; i++) {
        uint32_t word[8];
        for (uint32_t k = 0; k < 8u; k++) {
            word[k] = (uint32_t)signal_noise(&seed, INT32_MAX / 2) >>
                      (uint32_t)abs_i32(signal_noise(&seed, 31));
        }
        const adapt_effect_t from = {word[0], word[1]};
        const adapt_effect_t to = {word[2], word[3]};
        const adapt_goal_t goal = {(uint16_t)word[4], (uint16_t)word[5], (uint16_t)word[6]};
        const uint32_t limit_um_s2 = adapt_limit_um_s2(goal, word[7]);
        const int32_t cost = adapt_cost_q20(from, to, goal, limit_um_s2);
        TEST_ASSERT_TRUE(abs_i32(cost) <= ADAPT_MOST_COST_Q20);
    }
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(test_reach_counts_as_it_changes);
    RUN_TEST(test_acceleration_counts_twice_beyond_its_limit);
    RUN_TEST(test_the_limit_is_a_factor_of_what_is_free);
    RUN_TEST(test_it_is_bounded_for_any_effects_and_goals);
    return UNITY_END();
}
