#include "fuzzy.h"
#include "plant_rules.h"
#include "rule_cases.h"
#include "unity.h"

#include <stddef.h>

void setUp(void) {}
void tearDown(void) {}

enum { RANDOM_POINTS = 2000 };

static uint32_t random_state = 1;

static uint32_t random_u32(void) {
    random_state = random_state * 1664525u + 1013904223u;
    return random_state >> 8 ^ random_state << 16;
}

static const fuzzy_table_t *shipped(void) {
    return (const fuzzy_table_t *)(const void *)plant_rules_table;
}

static int32_t current_mA(int32_t freq_uHz, int32_t rms_um_s2) {
    const int32_t input[] = {freq_uHz, rms_um_s2};
    int32_t output = -1;
    TEST_ASSERT_EQUAL_UINT32(0, fuzzy_evaluate(shipped(), input, &output));
    int32_t straight = -1;
    TEST_ASSERT_EQUAL_UINT32(0, plant_rules(input, &straight));
    TEST_ASSERT_EQUAL_INT32(output, straight);
    return output;
}

static uint64_t fired_by(const fuzzy_table_t *table, int32_t first, int32_t second) {
    const int32_t input[FUZZY_MAX_INPUTS] = {first, second};
    uint64_t bits = 0;
    const uint32_t count = fuzzy_fired(table, input, &bits);
    uint32_t set = 0;
    for (uint64_t left = bits; left != 0; left &= left - 1u) {
        set++;
    }
    TEST_ASSERT_EQUAL_UINT32(count, set);
    return bits;
}

// ---- the shipped rules --------------------------------------------------------------------------

static void test_published_nodes(void) {
    const int32_t rms_um_s2[] = {0, 50000, 150000, 300000, 450000, 2000000};
    for (uint32_t i = 0; i < 6; i++) {
        TEST_ASSERT_EQUAL_INT32(0, current_mA(5000000, rms_um_s2[i]));
        TEST_ASSERT_EQUAL_INT32(5000, current_mA(10000000, rms_um_s2[i]));
        TEST_ASSERT_EQUAL_INT32(5000, current_mA(20000000, rms_um_s2[i]));
    }
}

static void test_between_the_nodes_it_blends(void) {
    TEST_ASSERT_EQUAL_INT32(2500, current_mA(7500000, 40000));
    TEST_ASSERT_EQUAL_INT32(1000, current_mA(6000000, 40000));
    int32_t last_mA = 0;
    for (int32_t f = 5000000; f <= 10000000; f += 12345) {
        const int32_t now_mA = current_mA(f, 40000);
        TEST_ASSERT_TRUE(now_mA >= last_mA);
        last_mA = now_mA;
    }
}

static void test_fired_rules_are_reported_in_the_order_of_the_file(void) {
    TEST_ASSERT_EQUAL_HEX32(1u << 0, fired_by(shipped(), 4000000, 0));
    TEST_ASSERT_EQUAL_HEX32(1u << 15, fired_by(shipped(), 30000000, 900000));
    TEST_ASSERT_EQUAL_HEX32(0x33u, fired_by(shipped(), 7500000, 100000));
}

// The whole plane, extremes included: both engines agree and the output stays in its range.
static void test_output_stays_in_range_everywhere(void) {
    for (int64_t f = INT32_MIN; f <= INT32_MAX; f += 40000003) {
        for (int64_t r = INT32_MIN; r <= INT32_MAX; r += 50000017) {
            const int32_t now_mA = current_mA((int32_t)f, (int32_t)r);
            TEST_ASSERT_TRUE(now_mA >= 0 && now_mA <= 5000);
            TEST_ASSERT_TRUE(fired_by(shipped(), (int32_t)f, (int32_t)r) != 0);
        }
    }
    TEST_ASSERT_EQUAL_INT32(5000, current_mA(INT32_MAX, INT32_MAX));
}

// ---- every form of a table ----------------------------------------------------------------------

static void test_cases_have_the_forms_that_they_are_there_for(void) {
    static const uint8_t form[RULE_CASES] = {
        [CASE_SUM_Q15] = FUZZY_PARTITION_SUM,
        [CASE_SUM_PHYSICAL] = FUZZY_PARTITION_SUM,
        [CASE_SUM_WIDE] = FUZZY_PARTITION_SUM,
        [CASE_SUM_FINE] = FUZZY_PARTITION_SUM,
        [CASE_MAX_Q15] = FUZZY_PARTITION_MAX,
        [CASE_MAX_PHYSICAL] = FUZZY_PARTITION_MAX,
        [CASE_CENTROID_Q15] = FUZZY_PARTITION_CENTROID,
        [CASE_CENTROID_PHYSICAL] = FUZZY_PARTITION_CENTROID,
        [CASE_OVERLAPS] = FUZZY_PARTITION_CENTROID,
        [CASE_STACKED] = FUZZY_ANY,
        [CASE_SEVEN] = FUZZY_PARTITION_MAX,
        [CASE_GRID_Q15] = FUZZY_ANY,
        [CASE_GRID_PHYSICAL] = FUZZY_ANY,
        [CASE_GENERAL] = FUZZY_ANY,
        [CASE_FOUR] = FUZZY_ANY,
        [CASE_LIMITS] = FUZZY_ANY,
        [CASE_ONE] = FUZZY_ANY,
    };
    for (uint32_t i = 0; i < RULE_CASES; i++) {
        TEST_ASSERT_EQUAL_MESSAGE(form[i], case_table(&rule_cases[i])->form, rule_cases[i].name);
    }
    TEST_ASSERT_EQUAL(18, case_table(&rule_cases[CASE_SUM_WIDE])->bits);
    TEST_ASSERT_EQUAL(18, case_table(&rule_cases[CASE_SUM_FINE])->bits);
}

static void test_all_ways_to_share_a_term_occur(void) {
    const fuzzy_table_t *table = case_table(&rule_cases[CASE_SEVEN]);
    const uint32_t *twins = fuzzy_at(table, table->twins_offset);
    uint32_t seen = 0;
    for (uint32_t row = 0; row < 6u; row++) {
        for (uint32_t column = 0; column < 6u; column++) {
            seen |= 1u << twins[row * FUZZY_GRID_STRIDE + column];
        }
    }
    TEST_ASSERT_EQUAL_HEX32((2u << FUZZY_TWINS_ALL) - 1u, seen);
}

static void check_point(const rule_case_t *one, const rule_point_t *point,
                        fuzzy_function_t straight) {
    int32_t output[FUZZY_MAX_OUTPUTS] = {0};
    const uint32_t is_default = straight != NULL
                                    ? straight(point->input, output)
                                    : fuzzy_evaluate(case_table(one), point->input, output);
    TEST_ASSERT_EQUAL_HEX32_MESSAGE(point->is_default, is_default, one->name);
    for (uint32_t i = 0; i < case_table(one)->outputs; i++) {
        const int64_t error = output[i] * INT64_C(65536) - point->expected_q16[i];
        // A default is rounded to an integer, and is that.
        const int64_t allowed =
            (is_default >> i & 1u) != 0 ? INT64_C(32768) : point->allowed_q16[i];
        TEST_ASSERT_TRUE_MESSAGE(error <= allowed && error >= -allowed, one->name);
    }
}

static void test_table_agrees_with_the_reference(void) {
    for (uint32_t i = 0; i < RULE_CASES; i++) {
        for (uint32_t k = 0; k < rule_cases[i].points_count; k++) {
            check_point(&rule_cases[i], &rule_cases[i].points[k], NULL);
        }
    }
}

static void test_straight_line_code_agrees_with_the_reference(void) {
    uint32_t tried = 0;
    for (uint32_t i = 0; i < RULE_CASES; i++) {
        for (uint32_t k = 0; k < rule_cases[i].points_count && rule_cases[i].straight; k++) {
            check_point(&rule_cases[i], &rule_cases[i].points[k], rule_cases[i].straight);
            tried++;
        }
    }
    TEST_ASSERT_GREATER_THAN(400, tried);
}

// Where the case's points lie, and sometimes anywhere.
static void random_input(const rule_case_t *one, int32_t *input) {
    for (uint32_t i = 0; i < FUZZY_MAX_INPUTS; i++) {
        const int32_t p = one->points[random_u32() % one->points_count].input[i];
        const int32_t q = one->points[random_u32() % one->points_count].input[i];
        const uint32_t share = random_u32() % 1025u;
        const int64_t between = p + ((int64_t)q - p) * share / 1024;
        input[i] = random_u32() % 16u == 0 ? (int32_t)random_u32() : (int32_t)between;
    }
}

static void check_in_range(const rule_case_t *one, uint32_t is_default, const int32_t *output) {
    for (uint32_t i = 0; i < case_table(one)->outputs; i++) {
        const fuzzy_output_t *header = fuzzy_at(case_table(one), case_table(one)->output_offset[i]);
        if ((is_default >> i & 1u) != 0) {
            TEST_ASSERT_EQUAL_INT32_MESSAGE(header->value_default, output[i], one->name);
        } else {
            TEST_ASSERT_TRUE_MESSAGE(output[i] >= one->low[i] && output[i] <= one->high[i],
                                     one->name);
        }
    }
}

static void test_both_engines_have_the_same_bits_and_stay_in_range(void) {
    for (uint32_t i = 0; i < RULE_CASES; i++) {
        const rule_case_t *one = &rule_cases[i];
        uint32_t defaults = 0;
        for (uint32_t k = 0; k < RANDOM_POINTS; k++) {
            int32_t input[FUZZY_MAX_INPUTS];
            random_input(one, input);
            int32_t table[FUZZY_MAX_OUTPUTS] = {0};
            int32_t straight[FUZZY_MAX_OUTPUTS] = {0};
            const uint32_t is_default = fuzzy_evaluate(case_table(one), input, table);
            check_in_range(one, is_default, table);
            defaults |= is_default;
            if (one->straight != NULL) {
                TEST_ASSERT_EQUAL_HEX32_MESSAGE(is_default, one->straight(input, straight),
                                                one->name);
                TEST_ASSERT_EQUAL_INT32_ARRAY(table, straight, FUZZY_MAX_OUTPUTS);
            }
        }
        // Where no rule fires the default stands, flagged, in these outputs and no others.
        TEST_ASSERT_EQUAL_HEX32_MESSAGE(one->defaults, defaults, one->name);
    }
}

static void test_the_ends_of_a_universe_hold_beyond_it(void) {
    const rule_case_t *one = &rule_cases[CASE_CENTROID_Q15];
    for (int32_t y = 0; y <= 32768; y += 331) {
        const int32_t inside[] = {32768, y};
        const int32_t outside[] = {INT32_MAX, y};
        int32_t expected = 0;
        int32_t found = 0;
        (void)fuzzy_evaluate(case_table(one), inside, &expected);
        (void)fuzzy_evaluate(case_table(one), outside, &found);
        TEST_ASSERT_EQUAL_INT32(expected, found);
    }
}

// OR, NOT, weights, rules that do not name an input, three sets at once.
static void test_rules_that_fire_in_any_base(void) {
    const fuzzy_table_t *table = case_table(&rule_cases[CASE_GENERAL]);
    uint64_t bits = 0;
    // x = -10, y = 0, z = 1000: low and left; z is not large.
    TEST_ASSERT_EQUAL_UINT32(1, fuzzy_fired(table, (const int32_t[]){0, 0, 0}, &bits));
    TEST_ASSERT_EQUAL_HEX32(1u << 0, bits);
    // x = 10, y = 1, z = 1024: high or large; right and not small; wide is 0 there.
    TEST_ASSERT_EQUAL_UINT32(2, fuzzy_fired(table, (const int32_t[]){32768, 32768, 32768}, &bits));
    TEST_ASSERT_EQUAL_HEX32(1u << 1 | 1u << 2, bits);
    // x = 0, y = 1, z = 1000: high at 1/4; small is 1, so that NOT is 0; wide, however weakly.
    TEST_ASSERT_EQUAL_UINT32(2, fuzzy_fired(table, (const int32_t[]){16384, 32768, 0}, &bits));
    TEST_ASSERT_EQUAL_HEX32(1u << 1 | 1u << 4, bits);
    // x = -8, y = 1/2: neither left nor right.
    TEST_ASSERT_EQUAL_UINT32(0, fuzzy_fired(table, (const int32_t[]){3277, 16384, 0}, &bits));
    TEST_ASSERT_EQUAL_HEX32(0, bits);
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(test_published_nodes);
    RUN_TEST(test_between_the_nodes_it_blends);
    RUN_TEST(test_fired_rules_are_reported_in_the_order_of_the_file);
    RUN_TEST(test_output_stays_in_range_everywhere);
    RUN_TEST(test_cases_have_the_forms_that_they_are_there_for);
    RUN_TEST(test_all_ways_to_share_a_term_occur);
    RUN_TEST(test_table_agrees_with_the_reference);
    RUN_TEST(test_straight_line_code_agrees_with_the_reference);
    RUN_TEST(test_both_engines_have_the_same_bits_and_stay_in_range);
    RUN_TEST(test_the_ends_of_a_universe_hold_beyond_it);
    RUN_TEST(test_rules_that_fire_in_any_base);
    return UNITY_END();
}
