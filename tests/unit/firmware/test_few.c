// A build that holds few laws and trackers, and not the default ones: what it starts with is among
// them, and what it does not hold is refused by name.
#include "quiesce.h"
#include "unity.h"

#define SIGNS_MAGIC UINT32_C(0x31475351)
#define LINEAR_MAGIC UINT32_C(0x314E4C51)

static quiesce_t controller;
static quiesce_params_t params;

void setUp(void) {
    quiesce_params_default(&params);
}
void tearDown(void) {}

static void test_few_starts_with_what_it_holds(void) {
    TEST_ASSERT_EQUAL_INT32(QUIESCE_LAW_OFF, params.law);
    TEST_ASSERT_EQUAL_INT32(QUIESCE_TRACKER_PROPORTIONAL, params.tracker);
    TEST_ASSERT_TRUE(quiesce_params_check(&params, NULL));
    TEST_ASSERT_TRUE(quiesce_init(&controller, &params));
}

static void expect_refused(const char *name) {
    quiesce_param_error_t error;
    TEST_ASSERT_FALSE(quiesce_params_check(&params, &error));
    TEST_ASSERT_EQUAL_STRING(name, quiesce_param_info(error.index)->name);
    TEST_ASSERT_EQUAL_STRING("not in this build", error.reason);
    TEST_ASSERT_FALSE(quiesce_init(&controller, &params));
    quiesce_out_t out = {0};
    quiesce_step(&controller, &(quiesce_in_t){.sensor[0].is_fresh = true}, &out);
    TEST_ASSERT_EQUAL_UINT32(QUIESCE_FAULT_PARAMETER, out.telemetry.fault);
    TEST_ASSERT_EQUAL_INT32(params.safe_current_mA, out.damper[0].current_cmd_mA);
}

static void test_few_refuses_every_law_that_it_lacks(void) {
    for (params.law = 0; params.law < QUIESCE_LAW_COUNT; params.law++) {
        if (params.law == QUIESCE_LAW_OFF || params.law == QUIESCE_LAW_CONSTANT ||
            params.law == QUIESCE_LAW_SIGNS) {
            TEST_ASSERT_TRUE(quiesce_params_check(&params, NULL));
            TEST_ASSERT_NOT_NULL(quiesce_report_words(params.law));
        } else {
            expect_refused("law");
            TEST_ASSERT_NULL(quiesce_report_words(params.law));
        }
    }
}

static void test_few_refuses_every_tracker_that_it_lacks(void) {
    for (params.tracker = 0; params.tracker < QUIESCE_TRACKER_COUNT; params.tracker++) {
        if (params.tracker != QUIESCE_TRACKER_PROPORTIONAL) {
            expect_refused("tracker");
        }
    }
}

static void test_few_knows_the_tables_of_its_own_laws_alone(void) {
    quiesce_owner_t owner = QUIESCE_OF_TRACKER;
    TEST_ASSERT_EQUAL_STRING("signs", quiesce_table_kind(SIGNS_MAGIC, &owner));
    TEST_ASSERT_EQUAL_INT(QUIESCE_OF_LAW, owner);
    TEST_ASSERT_NULL(quiesce_table_kind(LINEAR_MAGIC, NULL));
    const uint32_t words[] = {LINEAR_MAGIC, 0, 3};
    TEST_ASSERT_EQUAL_INT(QUIESCE_TABLE_MAGIC, quiesce_table_check(words, 3));
}

static uint32_t room_of(const quiesce_tables_t *tables) {
    uint32_t count;
    const uint32_t *const words = quiesce_tables_arrival(tables, &count);
    return (uint32_t)(words - tables->words[0]) / QUIESCE_TABLE_WORDS;
}

static bool arrives(quiesce_tables_t *tables) {
    const uint32_t word = SIGNS_MAGIC;
    return quiesce_tables_write(tables, 0, &word, 1);
}

// Its tracker has no tables: what is in use, and what arrives, in the room of the one before.
static void test_few_has_two_rooms_for_the_law_s_tables(void) {
    static quiesce_tables_t tables;
    quiesce_tables_init(&tables);
    TEST_ASSERT_EQUAL_UINT32(2, sizeof tables.words / sizeof tables.words[0]);
    TEST_ASSERT_TRUE(arrives(&tables));
    TEST_ASSERT_EQUAL_UINT32(0, room_of(&tables));
    tables.of[QUIESCE_OF_LAW].now = 0;
    TEST_ASSERT_TRUE(arrives(&tables));
    TEST_ASSERT_EQUAL_UINT32(1, room_of(&tables));
    tables.of[QUIESCE_OF_LAW].before = 0;
    tables.of[QUIESCE_OF_LAW].now = 1;
    TEST_ASSERT_TRUE(arrives(&tables));
    TEST_ASSERT_EQUAL_UINT32(0, room_of(&tables));
    TEST_ASSERT_FALSE(quiesce_tables_revert(&tables, &controller, QUIESCE_OF_LAW));
}

// A store reads the table that was in use when it began, whatever is in use by now.
static void test_few_takes_no_room_that_is_held(void) {
    static quiesce_tables_t tables;
    quiesce_tables_init(&tables);
    quiesce_tables_hold(&tables, tables.words[0]);
    TEST_ASSERT_TRUE(arrives(&tables));
    TEST_ASSERT_EQUAL_UINT32(1, room_of(&tables));
    tables.of[QUIESCE_OF_LAW].before = 0;
    tables.of[QUIESCE_OF_LAW].now = 1;
    TEST_ASSERT_FALSE(quiesce_tables_have_room(&tables));
    TEST_ASSERT_FALSE(arrives(&tables));
    TEST_ASSERT_EQUAL_UINT32(0, tables.of[QUIESCE_OF_LAW].before);
    quiesce_tables_hold(&tables, NULL);
    TEST_ASSERT_TRUE(quiesce_tables_have_room(&tables));
    TEST_ASSERT_EQUAL_PTR(tables.words[0], quiesce_tables_room(&tables));
    TEST_ASSERT_EQUAL_UINT32(1, tables.of[QUIESCE_OF_LAW].before);
}

static void test_few_runs_the_law_that_it_holds(void) {
    params.law = QUIESCE_LAW_CONSTANT;
    params.constant_current_mA = 1500;
    TEST_ASSERT_TRUE(quiesce_init(&controller, &params));
    quiesce_out_t out = {0};
    for (uint32_t tick = 0; tick < 500; tick++) {
        quiesce_in_t in = {.tick = tick, .sensor[0].is_fresh = true, .enable = tick >= 200};
        in.sensor[0].counts = tick % 2 == 0 ? 100 : -100;
        quiesce_step(&controller, &in, &out);
    }
    TEST_ASSERT_EQUAL_INT32(1500, out.damper[0].current_cmd_mA);
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(test_few_starts_with_what_it_holds);
    RUN_TEST(test_few_refuses_every_law_that_it_lacks);
    RUN_TEST(test_few_refuses_every_tracker_that_it_lacks);
    RUN_TEST(test_few_knows_the_tables_of_its_own_laws_alone);
    RUN_TEST(test_few_has_two_rooms_for_the_law_s_tables);
    RUN_TEST(test_few_takes_no_room_that_is_held);
    RUN_TEST(test_few_runs_the_law_that_it_holds);
    return UNITY_END();
}
