// Kinds of tables, found by the first word: quiesce_table_kind and quiesce_table_check.
#include <stddef.h>
#include <string.h>

#include "law.h"
#include "table_samples.h"
#include "track.h"
#include "unity.h"

static uint32_t words[QUIESCE_TABLE_WORDS + 1u];

void setUp(void) {
    memset(words, 0, sizeof words);
}
void tearDown(void) {}

static void expect_kind(const table_kind_t *kind, quiesce_owner_t owner) {
    quiesce_owner_t found = QUIESCE_TABLE_OWNERS;
    TEST_ASSERT_EQUAL_STRING(kind->name, quiesce_table_kind(kind->magic, &found));
    TEST_ASSERT_EQUAL_INT(owner, found);
    TEST_ASSERT_EQUAL_STRING(kind->name, quiesce_table_kind(kind->magic, NULL));
    TEST_ASSERT_NOT_EQUAL(0, kind->least_words);
    TEST_ASSERT_LESS_OR_EQUAL(QUIESCE_TABLE_WORDS, kind->least_words);
}

static void test_every_kind_is_found_by_its_first_word(void) {
    uint32_t kinds = 0;
    for (int32_t i = 0; law_find(i) != NULL; i++) {
        if (law_find(i)->kind != NULL) {
            expect_kind(law_find(i)->kind, QUIESCE_OF_LAW);
            kinds++;
        }
    }
    for (int32_t i = 0; track_find(i) != NULL; i++) {
        if (track_find(i)->kind != NULL) {
            expect_kind(track_find(i)->kind, QUIESCE_OF_TRACKER);
            kinds++;
        }
    }
    TEST_ASSERT_EQUAL_UINT32(12, kinds); // rules are two laws'
}

// The room for tables counts on it: QUIESCE_TRACKERS_HAVE_TABLES.
static void test_trackers_with_tables_are_these(void) {
    for (int32_t i = 0; i < QUIESCE_TRACKER_COUNT; i++) {
        const bool has_tables = i == QUIESCE_TRACKER_INVERSE || i == QUIESCE_TRACKER_NETWORK ||
                                i == QUIESCE_TRACKER_BANK;
        TEST_ASSERT_EQUAL(has_tables, track_find(i)->kind != NULL);
    }
    TEST_ASSERT_EQUAL_UINT32(5, QUIESCE_TABLE_ROOMS);
}

static void test_kinds_have_the_names_that_people_know(void) {
    static const struct {
        uint32_t magic;
        const char *name;
    } known[] = {
        {0x31545A46, "rules"},   {0x31485051, "pulses"},           {0x314E4C51, "linear"},
        {0x31475351, "signs"},   {0x31524651, "friction"},         {0x314C5051, "polynomial"},
        {0x314E4E51, "network"}, {0x31534651, "rules_on_signals"}, {0x32464D51, "map"},
        {0x314B4251, "bank"},    {0x314E5451, "inverse_network"},
    };
    for (uint32_t i = 0; i < sizeof known / sizeof known[0]; i++) {
        TEST_ASSERT_EQUAL_STRING(known[i].name, quiesce_table_kind(known[i].magic, NULL));
    }
}

static void test_a_word_that_begins_no_table_is_of_no_kind(void) {
    static const uint32_t magics[] = {0, 1, UINT32_MAX, 0x31544C51, 0x46515A31, 0x31465451};
    for (uint32_t i = 0; i < sizeof magics / sizeof magics[0]; i++) {
        quiesce_owner_t owner = QUIESCE_TABLE_OWNERS;
        TEST_ASSERT_NULL(quiesce_table_kind(magics[i], &owner));
        TEST_ASSERT_EQUAL_INT(QUIESCE_TABLE_OWNERS, owner);
        words[TABLE_MAGIC] = magics[i];
        TEST_ASSERT_EQUAL_INT(QUIESCE_TABLE_MAGIC, quiesce_table_check(words, 10));
        TEST_ASSERT_EQUAL_INT(QUIESCE_TABLE_MAGIC, quiesce_table_check(words, 1));
    }
    TEST_ASSERT_EQUAL_INT(QUIESCE_TABLE_SIZE, quiesce_table_check(words, 0));
    TEST_ASSERT_EQUAL_INT(QUIESCE_TABLE_SIZE, quiesce_table_check(NULL, 0));
}

// Of any length, and with any word damaged: what its kind says of them, and nothing is read beyond.
static void expect_checked(uint32_t count) {
    TEST_ASSERT_EQUAL_INT(QUIESCE_TABLE_OK, quiesce_table_check(words, count));
    for (uint32_t length = 1; length <= QUIESCE_TABLE_WORDS + 1u; length++) {
        if (length != count) {
            TEST_ASSERT_EQUAL_INT(QUIESCE_TABLE_SIZE, quiesce_table_check(words, length));
        }
    }
    for (uint32_t at = TABLE_CRC; at < count; at++) {
        words[at] ^= 0x10u;
        TEST_ASSERT_EQUAL_INT(at == TABLE_WORDS ? QUIESCE_TABLE_SIZE : QUIESCE_TABLE_CRC,
                              quiesce_table_check(words, count));
        words[at] ^= 0x10u;
    }
}

static void test_tables_are_checked_by_their_kind(void) {
    expect_checked(sample_rules(words, 700));
    expect_checked(sample_friction(words, 50000));
    expect_checked(sample_map(words, 700000));
    (void)sample_friction(words, 0x40000000);
    TEST_ASSERT_EQUAL_INT(QUIESCE_TABLE_POINT, quiesce_table_check(words, words[TABLE_WORDS]));
    (void)sample_map(words, 400000); // that of the current below
    TEST_ASSERT_EQUAL_INT(QUIESCE_TABLE_OK, quiesce_table_check(words, words[TABLE_WORDS]));
    (void)sample_map(words, 399999);
    TEST_ASSERT_EQUAL_INT(QUIESCE_TABLE_POINT, quiesce_table_check(words, words[TABLE_WORDS]));
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(test_every_kind_is_found_by_its_first_word);
    RUN_TEST(test_trackers_with_tables_are_these);
    RUN_TEST(test_kinds_have_the_names_that_people_know);
    RUN_TEST(test_a_word_that_begins_no_table_is_of_no_kind);
    RUN_TEST(test_tables_are_checked_by_their_kind);
    return UNITY_END();
}
