#include "fuzzy_norms.h"

#include <stdlib.h>

#include "unity.h"

void setUp(void) {}
void tearDown(void) {}

enum { ONE = 1 << 30, POINTS = 24 };

static const fuzzy_norm_t t_norms[] = {
    FUZZY_MINIMUM,          FUZZY_PRODUCT,          FUZZY_BOUNDED_DIFFERENCE, FUZZY_DRASTIC_PRODUCT,
    FUZZY_EINSTEIN_PRODUCT, FUZZY_HAMACHER_PRODUCT, FUZZY_NILPOTENT_MINIMUM,
};
static const fuzzy_norm_t s_norms[] = {
    FUZZY_MAXIMUM,      FUZZY_ALGEBRAIC_SUM, FUZZY_BOUNDED_SUM,       FUZZY_DRASTIC_SUM,
    FUZZY_EINSTEIN_SUM, FUZZY_HAMACHER_SUM,  FUZZY_NILPOTENT_MAXIMUM,
};
enum { NORMS = sizeof t_norms / sizeof t_norms[0] };

// 0, 1 and what lies between.
static uint32_t point(uint32_t k) {
    return k == 0 ? 0 : k == 1u ? ONE : (uint32_t)(((uint64_t)(k - 1u) * 982451653u) % ONE);
}

static void expect_near(uint32_t expected, uint32_t found) {
    TEST_ASSERT_UINT32_WITHIN(4, expected, found);
}

static void test_one_and_zero_are_neutral(void) {
    for (uint32_t n = 0; n < NORMS; n++) {
        for (uint32_t k = 0; k < POINTS; k++) {
            expect_near(point(k), fuzzy_norm(t_norms[n], point(k), ONE));
            expect_near(point(k), fuzzy_norm(s_norms[n], 0, point(k)));
        }
    }
}

static void test_norms_do_not_mind_the_order(void) {
    for (uint32_t n = 0; n < NORMS; n++) {
        for (uint32_t k = 0; k < POINTS * POINTS; k++) {
            const uint32_t a = point(k % POINTS);
            const uint32_t b = point(k / POINTS);
            TEST_ASSERT_EQUAL_UINT32(fuzzy_norm(t_norms[n], a, b), fuzzy_norm(t_norms[n], b, a));
            TEST_ASSERT_EQUAL_UINT32(fuzzy_norm(s_norms[n], a, b), fuzzy_norm(s_norms[n], b, a));
        }
    }
}

// An S-norm is what its T-norm leaves of the complements.
static void test_norms_are_dual(void) {
    for (uint32_t n = 0; n < NORMS; n++) {
        for (uint32_t k = 0; k < POINTS * POINTS; k++) {
            const uint32_t a = point(k % POINTS);
            const uint32_t b = point(k / POINTS);
            const uint32_t dual = ONE - fuzzy_norm(t_norms[n], ONE - a, ONE - b);
            TEST_ASSERT_UINT32_WITHIN(8, dual, fuzzy_norm(s_norms[n], a, b));
        }
    }
}

static void test_known_values(void) {
    const uint32_t a = ONE / 2;
    const uint32_t b = ONE / 4;
    expect_near(b, fuzzy_norm(FUZZY_MINIMUM, a, b));
    expect_near(ONE / 8, fuzzy_norm(FUZZY_PRODUCT, a, b));
    expect_near(0, fuzzy_norm(FUZZY_BOUNDED_DIFFERENCE, a, b));
    expect_near(0, fuzzy_norm(FUZZY_DRASTIC_PRODUCT, a, b));
    expect_near(ONE / 11, fuzzy_norm(FUZZY_EINSTEIN_PRODUCT, a, b));
    expect_near(ONE / 5, fuzzy_norm(FUZZY_HAMACHER_PRODUCT, a, b));
    expect_near(0, fuzzy_norm(FUZZY_NILPOTENT_MINIMUM, a, b));
    expect_near(a, fuzzy_norm(FUZZY_MAXIMUM, a, b));
    expect_near(ONE / 8 * 5, fuzzy_norm(FUZZY_ALGEBRAIC_SUM, a, b));
    expect_near(ONE / 4 * 3, fuzzy_norm(FUZZY_BOUNDED_SUM, a, b));
    expect_near(ONE, fuzzy_norm(FUZZY_DRASTIC_SUM, a, b));
    expect_near((uint32_t)(ONE / 3 * 2), fuzzy_norm(FUZZY_EINSTEIN_SUM, a, b));
    expect_near((uint32_t)(UINT64_C(4) * ONE / 7), fuzzy_norm(FUZZY_HAMACHER_SUM, a, b));
    expect_near(a, fuzzy_norm(FUZZY_NILPOTENT_MAXIMUM, a, b));
    expect_near(ONE / 4 * 3, fuzzy_norm(FUZZY_NORMALIZED_SUM, a, b));
    expect_near(ONE, fuzzy_norm(FUZZY_NORMALIZED_SUM, a, ONE));
    expect_near(ONE / 4 * 3, fuzzy_norm(FUZZY_UNBOUNDED_SUM, a, b));
}

static void test_nothing_and_everything(void) {
    expect_near(0, fuzzy_norm(FUZZY_HAMACHER_PRODUCT, 0, 0));
    expect_near(ONE, fuzzy_norm(FUZZY_HAMACHER_SUM, ONE, ONE));
    TEST_ASSERT_EQUAL_UINT32(UINT32_MAX, fuzzy_norm(FUZZY_UNBOUNDED_SUM, UINT32_MAX, ONE));
    TEST_ASSERT_EQUAL_UINT32(UINT32_MAX, fuzzy_norm(FUZZY_UNBOUNDED_SUM, 3u * ONE, 3u * ONE));
}

static void test_hedges_hold_the_ends_and_rise(void) {
    for (uint32_t h = FUZZY_VERY; h < FUZZY_HEDGES; h++) {
        TEST_ASSERT_EQUAL_UINT32(0, fuzzy_hedge((fuzzy_hedge_t)h, 0));
        TEST_ASSERT_EQUAL_UINT32(ONE, fuzzy_hedge((fuzzy_hedge_t)h, ONE));
        uint32_t before = 0;
        for (uint32_t k = 0; k <= 64u; k++) {
            const uint32_t now = fuzzy_hedge((fuzzy_hedge_t)h, k * (ONE / 64));
            TEST_ASSERT_GREATER_OR_EQUAL_UINT32(before, now);
            before = now;
        }
    }
    TEST_ASSERT_EQUAL_UINT32(12345, fuzzy_hedge(FUZZY_PLAIN, 12345));
    TEST_ASSERT_EQUAL_UINT32(ONE - 12345, fuzzy_hedge(FUZZY_NOT, 12345));
}

static void test_hedges_at_a_quarter_and_three(void) {
    const uint32_t quarter = ONE / 4;
    const uint32_t three = ONE / 4 * 3;
    expect_near(ONE / 16, fuzzy_hedge(FUZZY_VERY, quarter));
    expect_near(ONE / 2, fuzzy_hedge(FUZZY_SOMEWHAT, quarter));
    expect_near(ONE / 8, fuzzy_hedge(FUZZY_EXTREMELY, quarter));
    expect_near(ONE / 8 * 7, fuzzy_hedge(FUZZY_EXTREMELY, three));
    expect_near(379625062, fuzzy_hedge(FUZZY_SELDOM, quarter)); // sqrt(1/8)
    expect_near(ONE - 379625062, fuzzy_hedge(FUZZY_SELDOM, three));
    expect_near(ONE / 64, fuzzy_hedge(FUZZY_CUBED, quarter));
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(test_one_and_zero_are_neutral);
    RUN_TEST(test_norms_do_not_mind_the_order);
    RUN_TEST(test_norms_are_dual);
    RUN_TEST(test_known_values);
    RUN_TEST(test_nothing_and_everything);
    RUN_TEST(test_hedges_hold_the_ends_and_rise);
    RUN_TEST(test_hedges_at_a_quarter_and_three);
    return UNITY_END();
}
