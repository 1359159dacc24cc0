// Rule tables that a running controller receives: quiesce_table_use and quiesce_table_store_*.
#include "quiesce.h"

#include <stddef.h>

#include "crc32.h"
#include "rule_cases.h"
#include "unity.h"

static quiesce_t controller;
static quiesce_table_store_t store;
static uint32_t ticks;

// A good table whose current at rest is its origin, which the shipped rules (0 mA) do not give.
static uint32_t table[QUIESCE_TABLE_WORDS];
static uint32_t count;

static void start(void) {
    quiesce_params_t params;
    quiesce_params_default(&params);
    TEST_ASSERT_TRUE(quiesce_init(&controller, &params));
    ticks = 0;
}

void setUp(void) {
    start();
    quiesce_table_store_init(&store);
}
void tearDown(void) {}

static quiesce_out_t step(void) {
    const quiesce_in_t in = {.tick = ticks, .sensor[0].is_fresh = true, .enable = ticks > 0};
    quiesce_out_t out;
    ticks++;
    quiesce_step(&controller, &in, &out);
    return out;
}

// What the law reports of its rules.
static int32_t rules_mA(void) {
    int32_t report[QUIESCE_REPORT_WORDS];
    quiesce_report(&controller, report);
    return report[0];
}

// One more tick; the rules' current in it.
static int32_t next_mA(void) {
    (void)step();
    return rules_mA();
}

static void repair_crc(uint32_t *words) {
    ((fuzzy_table_t *)(void *)words)->crc = crc32_words(words + 2, words[2] - 2u);
}

static void make_table(int32_t at_rest_mA) {
    const rule_case_t *one = &rule_cases[CASE_SUM_PHYSICAL];
    count = one->count;
    for (uint32_t i = 0; i < count; i++) {
        table[i] = one->words[i];
    }
    fuzzy_table_t *header = (fuzzy_table_t *)(void *)table;
    fuzzy_output_t *output = (fuzzy_output_t *)(void *)(table + header->output_offset[0]);
    header->origin = at_rest_mA;
    output->origin = at_rest_mA;
    repair_crc(table);
}

static void write_all(void) {
    TEST_ASSERT_TRUE(quiesce_table_store_write(&store, 0, table, count));
}

static quiesce_table_verdict_t commit(void) {
    return quiesce_table_store_commit(&store, &controller);
}

static void receive(int32_t at_rest_mA) {
    make_table(at_rest_mA);
    write_all();
    TEST_ASSERT_EQUAL_INT(QUIESCE_TABLE_OK, commit());
}

static void revert(void) {
    quiesce_table_store_revert(&store, &controller);
}

// ---- quiesce_table_use --------------------------------------------------------------------------

static void test_rules_change_with_the_next_tick_and_not_before(void) {
    make_table(700);
    TEST_ASSERT_EQUAL_INT32(0, next_mA());
    TEST_ASSERT_EQUAL_INT32(0, next_mA());
    TEST_ASSERT_EQUAL_INT(QUIESCE_TABLE_OK, quiesce_table_use(&controller, table, count));
    TEST_ASSERT_EQUAL_INT32(0, rules_mA());
    TEST_ASSERT_EQUAL_INT32(700, next_mA());
    TEST_ASSERT_EQUAL_INT32(700, next_mA());
    TEST_ASSERT_EQUAL_INT(QUIESCE_TABLE_OK, quiesce_table_use(&controller, NULL, 0));
    TEST_ASSERT_EQUAL_INT32(0, next_mA());
}

// A change of mind between two ticks: the last one counts.
static void test_the_last_change_between_two_ticks_counts(void) {
    make_table(700);
    TEST_ASSERT_EQUAL_INT(QUIESCE_TABLE_OK, quiesce_table_use(&controller, table, count));
    TEST_ASSERT_EQUAL_INT(QUIESCE_TABLE_OK, quiesce_table_use(&controller, NULL, 0));
    TEST_ASSERT_EQUAL_INT32(0, next_mA());
}

static void test_initialisation_goes_back_to_the_shipped_rules(void) {
    make_table(700);
    TEST_ASSERT_EQUAL_INT(QUIESCE_TABLE_OK, quiesce_table_use(&controller, table, count));
    TEST_ASSERT_EQUAL_INT32(700, next_mA());
    start();
    TEST_ASSERT_EQUAL_INT32(0, next_mA());
}

static void test_a_refused_table_changes_nothing(void) {
    receive(700);
    TEST_ASSERT_EQUAL_INT32(700, next_mA());
    make_table(900);
    TEST_ASSERT_EQUAL_INT(QUIESCE_TABLE_SIZE, quiesce_table_use(&controller, table, count - 1u));
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
    repair_crc(table);
    TEST_ASSERT_EQUAL_INT(QUIESCE_TABLE_SHAPE, quiesce_table_use(&controller, table, count));
    make_table(700);
    header->axis[0].cells = 0;
    repair_crc(table);
    TEST_ASSERT_EQUAL_INT(QUIESCE_TABLE_CELL, quiesce_table_use(&controller, table, count));
    make_table(700);
    header->rules_offset = 0;
    repair_crc(table);
    TEST_ASSERT_EQUAL_INT(QUIESCE_TABLE_RULE, quiesce_table_use(&controller, table, count));
    make_table(700);
    header->origin++;
    repair_crc(table);
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

// ---- in parts -----------------------------------------------------------------------------------

static void test_a_table_in_parts_is_used_once_it_is_committed(void) {
    make_table(700);
    uint32_t sent = 0;
    for (uint32_t part = 1; sent < count; part = 2u * part + 1u) {
        const uint32_t now = part < count - sent ? part : count - sent;
        TEST_ASSERT_TRUE(quiesce_table_store_write(&store, sent, table + sent, now));
        sent += now;
        TEST_ASSERT_EQUAL_INT32(0, next_mA());
    }
    TEST_ASSERT_EQUAL_INT(QUIESCE_TABLE_OK, commit());
    TEST_ASSERT_EQUAL_INT32(700, next_mA());
}

static void test_parts_in_the_wrong_place_are_refused_and_lost_nothing(void) {
    make_table(700);
    TEST_ASSERT_FALSE(quiesce_table_store_write(&store, 1, table, 1));
    TEST_ASSERT_TRUE(quiesce_table_store_write(&store, 0, table, 10));
    TEST_ASSERT_FALSE(quiesce_table_store_write(&store, 9, table + 9, 5));
    TEST_ASSERT_FALSE(quiesce_table_store_write(&store, 11, table + 11, 5));
    TEST_ASSERT_FALSE(quiesce_table_store_write(&store, UINT32_MAX, table, 1));
    TEST_ASSERT_TRUE(quiesce_table_store_write(&store, 10, table + 10, count - 10u));
    TEST_ASSERT_EQUAL_INT(QUIESCE_TABLE_OK, commit());
    TEST_ASSERT_EQUAL_INT32(700, next_mA());
}

static void test_more_than_a_slot_is_refused(void) {
    make_table(700);
    TEST_ASSERT_FALSE(quiesce_table_store_write(&store, 0, table, QUIESCE_TABLE_WORDS + 1u));
    TEST_ASSERT_FALSE(quiesce_table_store_write(&store, 0, table, UINT32_MAX));
    write_all();
    const uint32_t room = QUIESCE_TABLE_WORDS - count;
    TEST_ASSERT_FALSE(quiesce_table_store_write(&store, count, table, room + 1u));
    TEST_ASSERT_TRUE(quiesce_table_store_write(&store, count, table, room));
    TEST_ASSERT_FALSE(quiesce_table_store_write(&store, QUIESCE_TABLE_WORDS, table, 1));
    TEST_ASSERT_EQUAL_INT(QUIESCE_TABLE_OK, commit()); // what is behind a table does not matter
    TEST_ASSERT_EQUAL_INT32(700, next_mA());
}

static void test_offset_0_starts_anew(void) {
    make_table(900);
    TEST_ASSERT_TRUE(quiesce_table_store_write(&store, 0, table, 30));
    receive(700);
    TEST_ASSERT_EQUAL_INT32(700, next_mA());
}

static void test_a_commit_needs_a_whole_table(void) {
    TEST_ASSERT_EQUAL_INT(QUIESCE_TABLE_SIZE, commit());
    make_table(700);
    TEST_ASSERT_TRUE(quiesce_table_store_write(&store, 0, table, count - 1u));
    TEST_ASSERT_EQUAL_INT(QUIESCE_TABLE_SIZE, commit());
    // It was given up with that.
    TEST_ASSERT_FALSE(quiesce_table_store_write(&store, count - 1u, table + count - 1u, 1));
    TEST_ASSERT_EQUAL_INT32(0, next_mA());
}

static void test_a_bad_table_leaves_the_one_in_use(void) {
    receive(700);
    make_table(900);
    table[count - 1u] ^= 4u;
    write_all();
    TEST_ASSERT_EQUAL_INT(QUIESCE_TABLE_CRC, commit());
    TEST_ASSERT_EQUAL_INT32(700, next_mA());
    receive(900);
    TEST_ASSERT_EQUAL_INT32(900, next_mA());
}

// Also between the commit and the tick.
static void test_writing_goes_on_beside_the_table_in_use(void) {
    receive(700);
    make_table(900);
    write_all();
    TEST_ASSERT_EQUAL_INT32(700, next_mA());
    TEST_ASSERT_EQUAL_INT(QUIESCE_TABLE_OK, commit());
    for (uint32_t i = 0; i < QUIESCE_TABLE_WORDS; i++) {
        table[i] = 0xA5A5A5A5u;
    }
    TEST_ASSERT_TRUE(quiesce_table_store_write(&store, 0, table, QUIESCE_TABLE_WORDS));
    TEST_ASSERT_EQUAL_INT32(900, next_mA());
    TEST_ASSERT_EQUAL_INT(QUIESCE_TABLE_MAGIC, commit());
    TEST_ASSERT_EQUAL_INT32(900, next_mA());
}

static void test_commit_of_the_same_again_is_refused(void) {
    receive(700);
    TEST_ASSERT_EQUAL_INT(QUIESCE_TABLE_SIZE, commit());
    TEST_ASSERT_EQUAL_INT32(700, next_mA());
}

// ---- going back ---------------------------------------------------------------------------------

static void test_revert_goes_back_to_the_shipped_rules(void) {
    receive(700);
    TEST_ASSERT_EQUAL_INT32(700, next_mA());
    revert();
    TEST_ASSERT_EQUAL_INT32(0, next_mA());
    revert();
    TEST_ASSERT_EQUAL_INT32(0, next_mA());
}

static void test_revert_goes_back_to_the_table_before(void) {
    receive(700);
    receive(900);
    TEST_ASSERT_EQUAL_INT32(900, next_mA());
    revert();
    TEST_ASSERT_EQUAL_INT32(700, next_mA());
    revert();
    TEST_ASSERT_EQUAL_INT32(700, next_mA());
}

static void test_revert_of_nothing_changes_nothing(void) {
    revert();
    TEST_ASSERT_EQUAL_INT32(0, next_mA());
}

static void test_revert_waits_for_the_tick_too(void) {
    receive(700);
    (void)next_mA();
    revert();
    receive(900);
    TEST_ASSERT_EQUAL_INT32(900, next_mA());
    revert();
    TEST_ASSERT_EQUAL_INT32(0, next_mA());
}

// Two slots hold the one in use and the new one: a new one gives up what was before.
static void test_a_new_table_gives_up_the_one_before(void) {
    receive(700);
    receive(900);
    make_table(1100);
    TEST_ASSERT_TRUE(quiesce_table_store_write(&store, 0, table, 1));
    revert();
    TEST_ASSERT_EQUAL_INT32(900, next_mA());
}

static void test_a_refused_table_keeps_the_way_back_to_the_shipped_rules(void) {
    receive(700);
    make_table(900);
    table[5]++;
    write_all();
    TEST_ASSERT_EQUAL_INT(QUIESCE_TABLE_CRC, commit());
    TEST_ASSERT_EQUAL_INT32(700, next_mA());
    revert();
    TEST_ASSERT_EQUAL_INT32(0, next_mA());
}

// Going back exchanges the slots: words received before it are no part of a table any more.
static void test_revert_gives_up_what_was_received(void) {
    receive(700);
    make_table(900);
    write_all();
    revert();
    TEST_ASSERT_EQUAL_INT(QUIESCE_TABLE_SIZE, commit());
    TEST_ASSERT_EQUAL_INT32(0, next_mA());
    receive(700);
    TEST_ASSERT_TRUE(quiesce_table_store_write(&store, 0, table, 10));
    revert();
    TEST_ASSERT_FALSE(quiesce_table_store_write(&store, 10, table + 10, count - 10u));
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(test_rules_change_with_the_next_tick_and_not_before);
    RUN_TEST(test_the_last_change_between_two_ticks_counts);
    RUN_TEST(test_initialisation_goes_back_to_the_shipped_rules);
    RUN_TEST(test_a_refused_table_changes_nothing);
    RUN_TEST(test_tables_of_other_inputs_or_outputs_do_not_fit);
    RUN_TEST(test_each_verdict_of_the_check_is_passed_on);
    RUN_TEST(test_a_table_of_absurd_currents_stays_within_the_limits);
    RUN_TEST(test_a_table_in_parts_is_used_once_it_is_committed);
    RUN_TEST(test_parts_in_the_wrong_place_are_refused_and_lost_nothing);
    RUN_TEST(test_more_than_a_slot_is_refused);
    RUN_TEST(test_offset_0_starts_anew);
    RUN_TEST(test_a_commit_needs_a_whole_table);
    RUN_TEST(test_a_bad_table_leaves_the_one_in_use);
    RUN_TEST(test_writing_goes_on_beside_the_table_in_use);
    RUN_TEST(test_commit_of_the_same_again_is_refused);
    RUN_TEST(test_revert_goes_back_to_the_shipped_rules);
    RUN_TEST(test_revert_goes_back_to_the_table_before);
    RUN_TEST(test_revert_of_nothing_changes_nothing);
    RUN_TEST(test_revert_waits_for_the_tick_too);
    RUN_TEST(test_a_new_table_gives_up_the_one_before);
    RUN_TEST(test_a_refused_table_keeps_the_way_back_to_the_shipped_rules);
    RUN_TEST(test_revert_gives_up_what_was_received);
    return UNITY_END();
}
