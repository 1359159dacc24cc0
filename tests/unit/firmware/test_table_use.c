// Tables that a running controller is given whole: quiesce_table_use and quiesce_table_drop.
#include <stddef.h>

#include "rules_rig.h"

void setUp(void) {
    start();
}
void tearDown(void) {}

static void test_rules_change_with_the_next_tick_and_not_before(void) {
    make_table(700);
    TEST_ASSERT_EQUAL_INT32(0, next_mA());
    TEST_ASSERT_EQUAL_INT32(0, next_mA());
    TEST_ASSERT_EQUAL_INT(QUIESCE_TABLE_OK, quiesce_table_use(&controller, table, count));
    TEST_ASSERT_EQUAL_INT32(0, rules_mA());
    TEST_ASSERT_EQUAL_INT32(700, next_mA());
    TEST_ASSERT_EQUAL_INT32(700, next_mA());
    TEST_ASSERT_TRUE(quiesce_table_drop(&controller, QUIESCE_OF_LAW));
    TEST_ASSERT_EQUAL_INT32(0, next_mA());
}

// A change of mind between two ticks: the last one counts.
static void test_the_last_change_between_two_ticks_counts(void) {
    make_table(700);
    TEST_ASSERT_EQUAL_INT(QUIESCE_TABLE_OK, quiesce_table_use(&controller, table, count));
    TEST_ASSERT_TRUE(quiesce_table_drop(&controller, QUIESCE_OF_LAW));
    TEST_ASSERT_EQUAL_INT32(0, next_mA());
}

static void test_initialisation_goes_back_to_the_shipped_rules(void) {
    make_table(700);
    TEST_ASSERT_EQUAL_INT(QUIESCE_TABLE_OK, quiesce_table_use(&controller, table, count));
    TEST_ASSERT_EQUAL_INT32(700, next_mA());
    start();
    TEST_ASSERT_EQUAL_INT32(0, next_mA());
}

static void test_the_table_in_use_is_told(void) {
    const uint32_t *shipped = quiesce_table_in_use(&controller, QUIESCE_OF_LAW);
    TEST_ASSERT_EQUAL_HEX32(quiesce_table_hash(&controller), shipped[TABLE_CRC]);
    make_table(700);
    TEST_ASSERT_EQUAL_INT(QUIESCE_TABLE_OK, quiesce_table_use(&controller, table, count));
    TEST_ASSERT_EQUAL_PTR(table, quiesce_table_in_use(&controller, QUIESCE_OF_LAW));
    TEST_ASSERT_NULL(quiesce_table_in_use(&controller, QUIESCE_OF_TRACKER));
    // There is none of a tracker's: nothing demands forces.
    TEST_ASSERT_FALSE(quiesce_table_drop(&controller, QUIESCE_OF_TRACKER));
    TEST_ASSERT_EQUAL_PTR(table, quiesce_table_in_use(&controller, QUIESCE_OF_LAW));
    TEST_ASSERT_TRUE(quiesce_table_drop(&controller, QUIESCE_OF_LAW));
    TEST_ASSERT_EQUAL_PTR(shipped, quiesce_table_in_use(&controller, QUIESCE_OF_LAW));
}

static void test_a_refused_table_changes_nothing(void) {
    static uint32_t used[QUIESCE_TABLE_WORDS];
    (void)sample_rules(used, 700);
    TEST_ASSERT_EQUAL_INT(QUIESCE_TABLE_OK,
                          quiesce_table_use(&controller, used, used[TABLE_WORDS]));
    TEST_ASSERT_EQUAL_INT32(700, next_mA());
    make_table(900);
    TEST_ASSERT_EQUAL_INT(QUIESCE_TABLE_SIZE, quiesce_table_use(&controller, table, count - 1u));
    TEST_ASSERT_EQUAL_INT(QUIESCE_TABLE_SIZE, quiesce_table_use(&controller, table, count + 1u));
    TEST_ASSERT_EQUAL_INT(QUIESCE_TABLE_SIZE, quiesce_table_use(&controller, table, 0));
    table[20]++;
    TEST_ASSERT_EQUAL_INT(QUIESCE_TABLE_CRC, quiesce_table_use(&controller, table, count));
    table[0]++;
    TEST_ASSERT_EQUAL_INT(QUIESCE_TABLE_MAGIC, quiesce_table_use(&controller, table, count));
    TEST_ASSERT_EQUAL_INT32(700, next_mA());
}

static void test_tables_of_other_inputs_or_outputs_do_not_fit(void) {
    // The last has the right numbers of both, in other units.
    const uint32_t unfit[] = {CASE_ONE, CASE_GENERAL, CASE_FOUR, CASE_GRID_Q15, CASE_SUM_Q15};
    for (uint32_t i = 0; i < sizeof unfit / sizeof unfit[0]; i++) {
        const rule_case_t *one = &rule_cases[unfit[i]];
        TEST_ASSERT_EQUAL_INT(QUIESCE_TABLE_FIT,
                              quiesce_table_use(&controller, one->words, one->count));
    }
    TEST_ASSERT_EQUAL_INT32(0, next_mA());
}

static void test_each_verdict_of_the_check_is_passed_on(void) {
    make_table(700);
    fuzzy_table_t *header = (fuzzy_table_t *)(void *)table;
    header->bits = 0;
    sample_seal(table);
    TEST_ASSERT_EQUAL_INT(QUIESCE_TABLE_SHAPE, quiesce_table_use(&controller, table, count));
    make_table(700);
    header->axis[0].cells = 0;
    sample_seal(table);
    TEST_ASSERT_EQUAL_INT(QUIESCE_TABLE_CELL, quiesce_table_use(&controller, table, count));
    make_table(700);
    header->rules_offset = 0;
    sample_seal(table);
    TEST_ASSERT_EQUAL_INT(QUIESCE_TABLE_RULE, quiesce_table_use(&controller, table, count));
    make_table(700);
    header->origin++;
    sample_seal(table);
    TEST_ASSERT_EQUAL_INT(QUIESCE_TABLE_OUTPUT, quiesce_table_use(&controller, table, count));
}

// Whatever a table says, the request stays a current, and the guard keeps its limits.
static void test_a_table_of_absurd_currents_stays_within_the_limits(void) {
    make_table(-1000000000);
    TEST_ASSERT_EQUAL_INT(QUIESCE_TABLE_OK, quiesce_table_use(&controller, table, count));
    TEST_ASSERT_EQUAL_INT32(0, next_mA());
    make_table(2000000000);
    TEST_ASSERT_EQUAL_INT(QUIESCE_TABLE_OK, quiesce_table_use(&controller, table, count));
    for (uint32_t i = 0; i < 3000u; i++) {
        const quiesce_out_t out = step();
        TEST_ASSERT_EQUAL_INT32(1000000, rules_mA());
        TEST_ASSERT_TRUE(out.damper[0].current_cmd_mA >= 0 && out.damper[0].current_cmd_mA <= 5000);
    }
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(test_rules_change_with_the_next_tick_and_not_before);
    RUN_TEST(test_the_last_change_between_two_ticks_counts);
    RUN_TEST(test_initialisation_goes_back_to_the_shipped_rules);
    RUN_TEST(test_the_table_in_use_is_told);
    RUN_TEST(test_a_refused_table_changes_nothing);
    RUN_TEST(test_tables_of_other_inputs_or_outputs_do_not_fit);
    RUN_TEST(test_each_verdict_of_the_check_is_passed_on);
    RUN_TEST(test_a_table_of_absurd_currents_stays_within_the_limits);
    return UNITY_END();
}
