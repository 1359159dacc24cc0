#include "fuzzy.h"
#include "rules_squeeze_2012.h"
#include "unity.h"

void setUp(void) {}
void tearDown(void) {}

static const fuzzy_table_t *shipped(void) {
    return (const fuzzy_table_t *)(const void *)rules_squeeze_2012_table;
}

static int32_t current_mA(int32_t freq_uHz, int32_t rms_um_s2) {
    const int32_t input[] = {freq_uHz, rms_um_s2};
    int32_t output = -1;
    TEST_ASSERT_EQUAL_UINT32(0, fuzzy_evaluate(shipped(), input, &output));
    int32_t straight = -1;
    TEST_ASSERT_EQUAL_UINT32(0, rules_squeeze_2012(input, &straight));
    TEST_ASSERT_EQUAL_INT32(output, straight);
    return output;
}

static uint64_t fired(int32_t freq_uHz, int32_t rms_um_s2) {
    const int32_t input[] = {freq_uHz, rms_um_s2};
    uint64_t bits = 0;
    (void)fuzzy_fired(shipped(), input, &bits);
    return bits;
}

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
    TEST_ASSERT_EQUAL_HEX32(1u << 0, fired(4000000, 0));
    TEST_ASSERT_EQUAL_HEX32(1u << 15, fired(30000000, 900000));
    TEST_ASSERT_EQUAL_HEX32(0x33u, fired(7500000, 100000));
}

// The whole plane, extremes included: both engines agree and the output stays in its range.
static void test_output_stays_in_range_everywhere(void) {
    for (int64_t f = INT32_MIN; f <= INT32_MAX; f += 40000003) {
        for (int64_t r = INT32_MIN; r <= INT32_MAX; r += 50000017) {
            const int32_t now_mA = current_mA((int32_t)f, (int32_t)r);
            TEST_ASSERT_TRUE(now_mA >= 0 && now_mA <= 5000);
            TEST_ASSERT_TRUE(fired((int32_t)f, (int32_t)r) != 0);
        }
    }
    TEST_ASSERT_EQUAL_INT32(5000, current_mA(INT32_MAX, INT32_MAX));
}

static void test_the_shipped_table_is_accepted(void) {
    TEST_ASSERT_EQUAL_INT(FUZZY_TABLE_OK, fuzzy_table_check(shipped(), shipped()->size_words));
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(test_published_nodes);
    RUN_TEST(test_between_the_nodes_it_blends);
    RUN_TEST(test_fired_rules_are_reported_in_the_order_of_the_file);
    RUN_TEST(test_output_stays_in_range_everywhere);
    RUN_TEST(test_the_shipped_table_is_accepted);
    return UNITY_END();
}
