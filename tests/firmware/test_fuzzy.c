#include "fuzzy.h"
#include "squeeze_rules.h"
#include "unity.h"

void setUp(void) {}
void tearDown(void) {}

static const fuzzy_set_t triangle = FUZZY_TRIANGLE(5000000, 10000000, 15000000);
static const fuzzy_set_t left = FUZZY_LEFT_SHOULDER(5000000, 10000000);
static const fuzzy_set_t right = FUZZY_RIGHT_SHOULDER(15000000, 20000000);

static void test_triangle_at_its_corners_and_halves(void) {
    TEST_ASSERT_EQUAL_UINT32(0, fuzzy_membership_q15(&triangle, 5000000));
    TEST_ASSERT_EQUAL_UINT32(FUZZY_ONE_q15, fuzzy_membership_q15(&triangle, 10000000));
    TEST_ASSERT_EQUAL_UINT32(0, fuzzy_membership_q15(&triangle, 15000000));
    TEST_ASSERT_UINT32_WITHIN(1, FUZZY_ONE_q15 / 2, fuzzy_membership_q15(&triangle, 7500000));
    TEST_ASSERT_UINT32_WITHIN(1, FUZZY_ONE_q15 / 2, fuzzy_membership_q15(&triangle, 12500000));
    TEST_ASSERT_EQUAL_UINT32(0, fuzzy_membership_q15(&triangle, INT32_MIN));
    TEST_ASSERT_EQUAL_UINT32(0, fuzzy_membership_q15(&triangle, INT32_MAX));
}

static void test_shoulders_hold_one_to_the_ends_of_the_range(void) {
    TEST_ASSERT_EQUAL_UINT32(FUZZY_ONE_q15, fuzzy_membership_q15(&left, INT32_MIN));
    TEST_ASSERT_EQUAL_UINT32(FUZZY_ONE_q15, fuzzy_membership_q15(&left, 5000000));
    TEST_ASSERT_EQUAL_UINT32(0, fuzzy_membership_q15(&left, 10000000));
    TEST_ASSERT_EQUAL_UINT32(0, fuzzy_membership_q15(&right, 15000000));
    TEST_ASSERT_EQUAL_UINT32(FUZZY_ONE_q15, fuzzy_membership_q15(&right, 20000000));
    TEST_ASSERT_EQUAL_UINT32(FUZZY_ONE_q15, fuzzy_membership_q15(&right, INT32_MAX));
}

static void test_published_nodes(void) {
    const int32_t rms_um_s2[] = {0, 50000, 150000, 300000, 450000, 2000000};
    for (uint32_t i = 0; i < 6; i++) {
        TEST_ASSERT_EQUAL_INT32(0,
                                fuzzy_evaluate(&squeeze_rules, 5000000, rms_um_s2[i]).current_mA);
        TEST_ASSERT_EQUAL_INT32(5000,
                                fuzzy_evaluate(&squeeze_rules, 10000000, rms_um_s2[i]).current_mA);
        TEST_ASSERT_EQUAL_INT32(5000,
                                fuzzy_evaluate(&squeeze_rules, 20000000, rms_um_s2[i]).current_mA);
    }
}

static void test_between_the_nodes_it_blends(void) {
    TEST_ASSERT_INT32_WITHIN(1, 2500, fuzzy_evaluate(&squeeze_rules, 7500000, 40000).current_mA);
    TEST_ASSERT_INT32_WITHIN(2, 1000, fuzzy_evaluate(&squeeze_rules, 6000000, 40000).current_mA);
    int32_t last_mA = 0;
    for (int32_t f = 5000000; f <= 10000000; f += 12345) {
        const int32_t now_mA = fuzzy_evaluate(&squeeze_rules, f, 40000).current_mA;
        TEST_ASSERT_TRUE(now_mA >= last_mA);
        last_mA = now_mA;
    }
}

static void test_fired_rules_are_reported_row_major(void) {
    TEST_ASSERT_EQUAL_HEX32(1u << 0, fuzzy_evaluate(&squeeze_rules, 4000000, 0).rules_fired);
    TEST_ASSERT_EQUAL_HEX32(1u << 15, fuzzy_evaluate(&squeeze_rules, 30000000, 900000).rules_fired);
    TEST_ASSERT_EQUAL_HEX32(0x33u, fuzzy_evaluate(&squeeze_rules, 7500000, 100000).rules_fired);
}

// The whole plane, extremes included: the output never leaves the singletons' range.
static void test_output_stays_in_range_everywhere(void) {
    for (int64_t f = INT32_MIN; f <= INT32_MAX; f += 40000003) {
        for (int64_t r = INT32_MIN; r <= INT32_MAX; r += 50000017) {
            const fuzzy_out_t out = fuzzy_evaluate(&squeeze_rules, (int32_t)f, (int32_t)r);
            TEST_ASSERT_TRUE(out.current_mA >= 0 && out.current_mA <= 5000);
            TEST_ASSERT_TRUE(out.rules_fired != 0);
        }
    }
}

static void test_no_rule_gives_the_default_flagged(void) {
    fuzzy_table_t gap = squeeze_rules;
    gap.default_mA = 321;
    gap.row[0] = triangle;
    const fuzzy_out_t out = fuzzy_evaluate(&gap, 1000000, 0);
    TEST_ASSERT_EQUAL_INT32(321, out.current_mA);
    TEST_ASSERT_EQUAL_HEX32(0, out.rules_fired);
}

// Run-time rules: another table, another answer.
static void test_rules_are_read_from_the_table(void) {
    fuzzy_table_t table = squeeze_rules;
    table.rule[0][0] = 3;
    TEST_ASSERT_EQUAL_INT32(3750, fuzzy_evaluate(&table, 5000000, 0).current_mA);
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(test_triangle_at_its_corners_and_halves);
    RUN_TEST(test_shoulders_hold_one_to_the_ends_of_the_range);
    RUN_TEST(test_published_nodes);
    RUN_TEST(test_between_the_nodes_it_blends);
    RUN_TEST(test_fired_rules_are_reported_row_major);
    RUN_TEST(test_output_stays_in_range_everywhere);
    RUN_TEST(test_no_rule_gives_the_default_flagged);
    RUN_TEST(test_rules_are_read_from_the_table);
    return UNITY_END();
}
