// Tables that arrive in parts: quiesce_tables_* of one law (test_tables_both.c: of law and
// tracker).
#include <stddef.h>

#include "rules_rig.h"

static quiesce_tables_t tables;

void setUp(void) {
    start();
    quiesce_tables_init(&tables);
}
void tearDown(void) {}

static void write_all(void) {
    TEST_ASSERT_TRUE(quiesce_tables_write(&tables, 0, table, count));
}

static quiesce_table_verdict_t check(void) {
    return quiesce_tables_check(&tables, &controller);
}

static quiesce_table_verdict_t commit(void) {
    return quiesce_tables_commit(&tables, &controller);
}

static void receive(int32_t at_rest_mA) {
    make_table(at_rest_mA);
    write_all();
    TEST_ASSERT_EQUAL_INT(QUIESCE_TABLE_OK, commit());
}

static bool revert(void) {
    return quiesce_tables_revert(&tables, &controller, QUIESCE_OF_LAW);
}

static bool unload(void) {
    return quiesce_tables_unload(&tables, &controller, QUIESCE_OF_LAW);
}

static bool is_loaded(void) {
    return quiesce_tables_is_loaded(&tables, &controller, QUIESCE_OF_LAW);
}

// ---- in parts -----------------------------------------------------------------------------------

static void test_a_table_in_parts_is_used_once_it_is_committed(void) {
    make_table(700);
    uint32_t sent = 0;
    for (uint32_t part = 1; sent < count; part = 2u * part + 1u) {
        const uint32_t now = part < count - sent ? part : count - sent;
        TEST_ASSERT_TRUE(quiesce_tables_write(&tables, sent, table + sent, now));
        sent += now;
        TEST_ASSERT_EQUAL_INT32(0, next_mA());
    }
    TEST_ASSERT_FALSE(is_loaded());
    TEST_ASSERT_EQUAL_INT(QUIESCE_TABLE_OK, commit());
    TEST_ASSERT_TRUE(is_loaded());
    TEST_ASSERT_EQUAL_INT32(700, next_mA());
}

static void test_parts_in_the_wrong_place_are_refused_and_lost_nothing(void) {
    make_table(700);
    TEST_ASSERT_FALSE(quiesce_tables_write(&tables, 1, table, 1));
    TEST_ASSERT_TRUE(quiesce_tables_write(&tables, 0, table, 10));
    (void)quiesce_tables_sum(&tables, 5);
    TEST_ASSERT_FALSE(quiesce_tables_write(&tables, 9, table + 9, 5));
    TEST_ASSERT_FALSE(quiesce_tables_write(&tables, 11, table + 11, 5));
    TEST_ASSERT_FALSE(quiesce_tables_write(&tables, UINT32_MAX, table, 1));
    TEST_ASSERT_TRUE(quiesce_tables_write(&tables, 10, table + 10, count - 10u));
    TEST_ASSERT_EQUAL_INT(QUIESCE_TABLE_OK, commit());
    TEST_ASSERT_EQUAL_INT32(700, next_mA());
}

// Unused words behind the rules are a part of the table like any others.
static void test_a_table_of_the_full_size_is_used(void) {
    make_table(700);
    memset(table + count, 0x5A, (QUIESCE_TABLE_WORDS - count) * sizeof table[0]);
    count = QUIESCE_TABLE_WORDS;
    table[TABLE_WORDS] = count;
    sample_seal(table);
    write_all();
    TEST_ASSERT_FALSE(quiesce_tables_write(&tables, count, table, 1));
    TEST_ASSERT_FALSE(quiesce_tables_sum(&tables, 1000));
    TEST_ASSERT_FALSE(quiesce_tables_sum(&tables, 1000));
    TEST_ASSERT_TRUE(quiesce_tables_sum(&tables, 46)); // the head's first two are not summed
    TEST_ASSERT_EQUAL_INT(QUIESCE_TABLE_OK, commit());
    TEST_ASSERT_EQUAL_INT32(700, next_mA());
}

static void test_more_than_a_room_is_refused(void) {
    make_table(700);
    TEST_ASSERT_FALSE(quiesce_tables_write(&tables, 0, table, QUIESCE_TABLE_WORDS + 1u));
    TEST_ASSERT_FALSE(quiesce_tables_write(&tables, 0, table, UINT32_MAX));
    write_all();
    const uint32_t room = QUIESCE_TABLE_WORDS - count;
    TEST_ASSERT_FALSE(quiesce_tables_write(&tables, count, table, room + 1u));
    TEST_ASSERT_EQUAL_INT(QUIESCE_TABLE_OK, check());
    TEST_ASSERT_TRUE(quiesce_tables_write(&tables, count, table, room));
    TEST_ASSERT_FALSE(quiesce_tables_write(&tables, QUIESCE_TABLE_WORDS, table, 1));
    TEST_ASSERT_EQUAL_INT(QUIESCE_TABLE_SIZE, commit()); // more than its head says
    memset(table, 0, sizeof table);
    make_table(700);
    table[TABLE_WORDS] = QUIESCE_TABLE_WORDS + 1u;
    sample_seal(table);
    TEST_ASSERT_EQUAL_INT(QUIESCE_TABLE_SIZE,
                          quiesce_table_use(&controller, table, QUIESCE_TABLE_WORDS + 1u));
    TEST_ASSERT_EQUAL_INT32(0, next_mA());
}

static void test_offset_0_starts_anew(void) {
    make_table(900);
    TEST_ASSERT_TRUE(quiesce_tables_write(&tables, 0, table, 30));
    TEST_ASSERT_TRUE(quiesce_tables_sum(&tables, 30));
    receive(700);
    TEST_ASSERT_EQUAL_INT32(700, next_mA());
    write_all();
    TEST_ASSERT_TRUE(quiesce_tables_write(&tables, 0, table, 0));
    TEST_ASSERT_EQUAL_INT(QUIESCE_TABLE_SIZE, commit());
}

static void test_a_commit_needs_a_whole_table(void) {
    TEST_ASSERT_EQUAL_INT(QUIESCE_TABLE_SIZE, commit());
    make_table(700);
    for (uint32_t length = 1; length < count; length++) {
        TEST_ASSERT_TRUE(quiesce_tables_write(&tables, 0, table, length));
        TEST_ASSERT_TRUE(quiesce_tables_sum(&tables, length));
        TEST_ASSERT_EQUAL_INT(QUIESCE_TABLE_SIZE, check());
        TEST_ASSERT_EQUAL_INT(QUIESCE_TABLE_SIZE, commit());
        // It was given up with that.
        TEST_ASSERT_FALSE(quiesce_tables_write(&tables, length, table + length, 1));
    }
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

static void test_a_check_changes_nothing(void) {
    receive(700);
    TEST_ASSERT_EQUAL_INT32(700, next_mA());
    make_table(900);
    write_all();
    const quiesce_t before = controller;
    for (uint32_t i = 0; i < 3u; i++) {
        TEST_ASSERT_EQUAL_INT(QUIESCE_TABLE_OK, check());
        TEST_ASSERT_EQUAL_MEMORY(&before, &controller, sizeof before);
    }
    TEST_ASSERT_EQUAL_INT(QUIESCE_TABLE_OK, commit());
    TEST_ASSERT_EQUAL_INT32(900, next_mA());
    TEST_ASSERT_TRUE(quiesce_tables_write(&tables, 0, table, 20));
    TEST_ASSERT_EQUAL_INT(QUIESCE_TABLE_SIZE, check());
    // What goes on arriving is summed on from there.
    TEST_ASSERT_TRUE(quiesce_tables_write(&tables, 20, table + 20, count - 20u));
    TEST_ASSERT_EQUAL_INT(QUIESCE_TABLE_OK, check());
    TEST_ASSERT_EQUAL_INT(QUIESCE_TABLE_OK, commit());
}

// Also between the commit and the tick.
static void test_writing_goes_on_beside_the_table_in_use(void) {
    receive(700);
    make_table(900);
    write_all();
    TEST_ASSERT_EQUAL_INT32(700, next_mA());
    TEST_ASSERT_EQUAL_INT(QUIESCE_TABLE_OK, commit());
    memset(table, 0xA5, sizeof table);
    TEST_ASSERT_TRUE(quiesce_tables_write(&tables, 0, table, QUIESCE_TABLE_WORDS));
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
    TEST_ASSERT_TRUE(revert());
    TEST_ASSERT_FALSE(is_loaded());
    TEST_ASSERT_EQUAL_INT32(0, next_mA());
    TEST_ASSERT_FALSE(revert());
    TEST_ASSERT_EQUAL_INT32(0, next_mA());
}

static void test_revert_goes_back_to_the_table_before_once(void) {
    receive(500);
    receive(700);
    receive(900);
    TEST_ASSERT_EQUAL_INT32(900, next_mA());
    TEST_ASSERT_TRUE(revert());
    TEST_ASSERT_TRUE(is_loaded());
    TEST_ASSERT_EQUAL_INT32(700, next_mA());
    TEST_ASSERT_FALSE(revert());
    TEST_ASSERT_EQUAL_INT32(700, next_mA());
}

static void test_revert_of_nothing_changes_nothing(void) {
    const quiesce_t before = controller;
    TEST_ASSERT_FALSE(revert());
    TEST_ASSERT_EQUAL_MEMORY(&before, &controller, sizeof before);
}

static void test_revert_waits_for_the_tick_too(void) {
    receive(700);
    (void)next_mA();
    TEST_ASSERT_TRUE(revert());
    receive(900);
    TEST_ASSERT_EQUAL_INT32(900, next_mA());
    TEST_ASSERT_TRUE(revert());
    TEST_ASSERT_EQUAL_INT32(0, next_mA());
}

// Neither what arrives nor what is refused takes the place of the one before.
static void test_what_arrives_leaves_the_table_before(void) {
    receive(700);
    receive(900);
    make_table(1100);
    write_all();
    TEST_ASSERT_TRUE(revert());
    TEST_ASSERT_EQUAL_INT32(700, next_mA());
    TEST_ASSERT_EQUAL_INT(QUIESCE_TABLE_OK, commit()); // and it is still there
    TEST_ASSERT_EQUAL_INT32(1100, next_mA());
    table[5]++;
    write_all();
    TEST_ASSERT_EQUAL_INT(QUIESCE_TABLE_CRC, commit());
    TEST_ASSERT_TRUE(revert());
    TEST_ASSERT_EQUAL_INT32(700, next_mA());
}

static void test_unload_goes_back_to_what_ships_and_revert_undoes_it(void) {
    TEST_ASSERT_TRUE(unload());
    TEST_ASSERT_FALSE(revert());
    receive(500);
    receive(700);
    TEST_ASSERT_TRUE(unload());
    TEST_ASSERT_FALSE(is_loaded());
    TEST_ASSERT_EQUAL_INT32(0, next_mA());
    TEST_ASSERT_TRUE(unload()); // which says nothing new
    TEST_ASSERT_TRUE(revert());
    TEST_ASSERT_TRUE(is_loaded());
    TEST_ASSERT_EQUAL_INT32(700, next_mA());
    TEST_ASSERT_FALSE(revert());
    TEST_ASSERT_EQUAL_INT32(700, next_mA());
}

static void test_what_is_damaged_in_its_room_is_not_gone_back_to(void) {
    receive(700);
    receive(900);
    tables.words[tables.of[QUIESCE_OF_LAW].before][20] ^= 1u;
    TEST_ASSERT_FALSE(revert());
    TEST_ASSERT_EQUAL_INT32(900, next_mA());
    TEST_ASSERT_TRUE(unload());
    TEST_ASSERT_EQUAL_INT32(0, next_mA());
}

// Words linked into a program take the place of those that the law ships with.
static void test_other_words_can_ship(void) {
    static uint32_t linked[QUIESCE_TABLE_WORDS];
    (void)sample_rules(linked, 300);
    quiesce_tables_ship(&tables, linked);
    TEST_ASSERT_EQUAL_INT32(0, next_mA());
    quiesce_tables_resume(&tables, &controller);
    TEST_ASSERT_EQUAL_INT32(300, next_mA());
    TEST_ASSERT_FALSE(is_loaded());
    receive(700);
    TEST_ASSERT_TRUE(revert());
    TEST_ASSERT_EQUAL_PTR(linked, quiesce_table_in_use(&controller, QUIESCE_OF_LAW));
    receive(900);
    TEST_ASSERT_TRUE(unload());
    TEST_ASSERT_EQUAL_INT32(300, next_mA());
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(test_a_table_in_parts_is_used_once_it_is_committed);
    RUN_TEST(test_parts_in_the_wrong_place_are_refused_and_lost_nothing);
    RUN_TEST(test_a_table_of_the_full_size_is_used);
    RUN_TEST(test_more_than_a_room_is_refused);
    RUN_TEST(test_offset_0_starts_anew);
    RUN_TEST(test_a_commit_needs_a_whole_table);
    RUN_TEST(test_a_bad_table_leaves_the_one_in_use);
    RUN_TEST(test_a_check_changes_nothing);
    RUN_TEST(test_writing_goes_on_beside_the_table_in_use);
    RUN_TEST(test_commit_of_the_same_again_is_refused);
    RUN_TEST(test_revert_goes_back_to_the_shipped_rules);
    RUN_TEST(test_revert_goes_back_to_the_table_before_once);
    RUN_TEST(test_revert_of_nothing_changes_nothing);
    RUN_TEST(test_revert_waits_for_the_tick_too);
    RUN_TEST(test_what_arrives_leaves_the_table_before);
    RUN_TEST(test_unload_goes_back_to_what_ships_and_revert_undoes_it);
    RUN_TEST(test_what_is_damaged_in_its_room_is_not_gone_back_to);
    RUN_TEST(test_other_words_can_ship);
    return UNITY_END();
}
