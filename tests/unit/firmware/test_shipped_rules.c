// A build without loaded rule tables: the rules that ship run, as they do elsewhere, and no others
// are taken.
#include "plant_rules.h"
#include "quiesce.h"
#include "quiesce_rules.h"
#include "unity.h"
#include <string.h>

#define WORDS (sizeof plant_rules_table / sizeof plant_rules_table[0])

static uint32_t words[WORDS];
static quiesce_t controller;
static quiesce_params_t params;

void setUp(void) {
    memcpy(words, plant_rules_table, sizeof words);
    quiesce_params_default(&params);
    params.law = QUIESCE_LAW_FUZZY;
    TEST_ASSERT_TRUE(quiesce_init(&controller, &params));
}
void tearDown(void) {}

/// CRC-32 (IEEE 802.3) of the words from the third one on, as a table has it.
static uint32_t sum_of(const uint32_t *table, uint32_t count) {
    uint32_t crc = UINT32_MAX;
    for (uint32_t i = 2; i < count; i++) {
        for (uint32_t bit = 0; bit < 32; bit++) {
            const uint32_t feedback = (crc ^ (table[i] >> bit)) & 1u;
            crc = (crc >> 1) ^ (feedback != 0 ? UINT32_C(0xEDB88320) : 0);
        }
    }
    return ~crc;
}

static void test_shipped_rules_are_evaluated_as_they_are_compiled(void) {
    for (int32_t freq_uHz = 0; freq_uHz <= 26000000; freq_uHz += 250000) {
        for (int32_t rms_um_s2 = 0; rms_um_s2 <= 600000; rms_um_s2 += 7000) {
            const int32_t input[] = {freq_uHz, rms_um_s2};
            int32_t expected_mA = 0;
            (void)plant_rules(input, &expected_mA);
            TEST_ASSERT_EQUAL_INT32(expected_mA,
                                    quiesce_rules_current_mA(NULL, freq_uHz, rms_um_s2, NULL));
        }
    }
}

static void test_shipped_rules_are_taken_again(void) {
    TEST_ASSERT_EQUAL_UINT32(words[1], sum_of(words, WORDS));
    TEST_ASSERT_EQUAL_INT(QUIESCE_TABLE_OK, quiesce_table_check(words, WORDS));
    TEST_ASSERT_EQUAL_INT(QUIESCE_TABLE_OK, quiesce_table_use(&controller, words, WORDS));
}

static void test_other_rules_are_refused(void) {
    for (uint32_t i = 3; i < WORDS; i++) {
        words[i] ^= 1u;
        words[1] = sum_of(words, WORDS);
        TEST_ASSERT_EQUAL_INT(QUIESCE_TABLE_MAGIC, quiesce_table_check(words, WORDS));
        TEST_ASSERT_EQUAL_INT(QUIESCE_TABLE_MAGIC, quiesce_table_use(&controller, words, WORDS));
        words[i] ^= 1u;
    }
    words[2] = WORDS - 1u;
    words[1] = sum_of(words, WORDS - 1u);
    TEST_ASSERT_EQUAL_INT(QUIESCE_TABLE_MAGIC, quiesce_table_check(words, WORDS - 1u));
}

static void test_a_damaged_table_is_refused_before_it_is_compared(void) {
    words[5] ^= 1u;
    TEST_ASSERT_EQUAL_INT(QUIESCE_TABLE_CRC, quiesce_table_check(words, WORDS));
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(test_shipped_rules_are_evaluated_as_they_are_compiled);
    RUN_TEST(test_shipped_rules_are_taken_again);
    RUN_TEST(test_other_rules_are_refused);
    RUN_TEST(test_a_damaged_table_is_refused_before_it_is_compared);
    return UNITY_END();
}
