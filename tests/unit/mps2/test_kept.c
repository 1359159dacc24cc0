// What the node image keeps: which records come back after a power-up, and what the node is
// answered while one is being written.
#include "kept.h"
#include "nvm_mps2.h"
#include "unity.h"

static hal_nvm_memory_t memory;
static kept_t kept;
static quiesce_params_t shipped;
static const quiesce_board_t *wired;
static uint32_t back_words[QUIESCE_TABLE_WORDS];

static uint32_t read_words(keeper_record_t record) {
    return kept_read(&kept, record, back_words, QUIESCE_TABLE_WORDS);
}

// A power-up: only the memory is left.
static void start(void) {
    kept = (kept_t){0};
    memory = (hal_nvm_memory_t){.words = (volatile uint32_t *)NVM_MPS2_BASE};
    kept_open(&kept, &memory, wired, &shipped);
    for (uint32_t i = 0; i < KEEPER_RECORDS; i++) {
        (void)read_words((keeper_record_t)i);
    }
}

void setUp(void) {
    for (uint32_t i = 0; i < NVM_MPS2_WORDS; i++) {
        ((volatile uint32_t *)NVM_MPS2_BASE)[i] = 0;
    }
    quiesce_params_default(&shipped);
    wired = NULL;
    start();
}

void tearDown(void) {}

static hal_nvm_progress_t work(void) {
    hal_nvm_progress_t progress = HAL_NVM_BUSY;
    for (uint32_t i = 0; i < 1000u && progress == HAL_NVM_BUSY; i++) {
        progress = kept_work(&kept);
    }
    return progress;
}

static void store(keeper_record_t record, const uint32_t *words, uint32_t count) {
    TEST_ASSERT_EQUAL(KEEPER_BEGUN, kept_store(&kept, record, words, count));
    TEST_ASSERT_EQUAL(HAL_NVM_DONE, work());
}

static void store_params(const quiesce_params_t *params) {
    store(KEEPER_PARAMS, (const uint32_t *)(const void *)params, QUIESCE_PARAM_COUNT);
}

static void test_parameters_come_back_while_those_that_ship_are_the_same(void) {
    quiesce_params_t params = shipped;
    quiesce_params_t back = {0};
    TEST_ASSERT_FALSE(kept_read_params(&kept, &back));
    params.constant_current_mA++;
    store_params(&params);
    start();
    TEST_ASSERT_TRUE(kept_read_params(&kept, &back));
    TEST_ASSERT_EQUAL_MEMORY(&params, &back, sizeof params);
    shipped.band_low_mHz++;
    start();
    TEST_ASSERT_FALSE(kept_read_params(&kept, &back));
}

static void test_parameters_of_another_number_or_forgotten_are_none(void) {
    quiesce_params_t back;
    store(KEEPER_PARAMS, (const uint32_t *)(const void *)&shipped, QUIESCE_PARAM_COUNT - 1u);
    TEST_ASSERT_FALSE(kept_read_params(&kept, &back));
    store_params(&shipped);
    TEST_ASSERT_TRUE(kept_read_params(&kept, &back));
    store(KEEPER_PARAMS, NULL, 0);
    TEST_ASSERT_FALSE(kept_read_params(&kept, &back));
}

static void test_longest_table_comes_back_and_is_forgotten(void) {
    static uint32_t words[QUIESCE_TABLE_WORDS];
    words[7] = 7;
    store(KEEPER_LAW_TABLE, words, QUIESCE_TABLE_WORDS);
    start();
    TEST_ASSERT_EQUAL_UINT32(QUIESCE_TABLE_WORDS, read_words(KEEPER_LAW_TABLE));
    TEST_ASSERT_EQUAL_HEX32_ARRAY(words, back_words, QUIESCE_TABLE_WORDS);
    TEST_ASSERT_EQUAL_UINT32(0, read_words(KEEPER_TRACKER_TABLE));
    TEST_ASSERT_EQUAL_UINT32(1, kept_writes(&kept, KEEPER_LAW_TABLE));
    store(KEEPER_LAW_TABLE, NULL, 0);
    TEST_ASSERT_EQUAL_UINT32(0, read_words(KEEPER_LAW_TABLE));
    TEST_ASSERT_EQUAL_UINT32(2, kept_writes(&kept, KEEPER_LAW_TABLE));
}

static void test_table_of_another_board_is_not_used(void) {
    static quiesce_board_t board;
    const uint32_t words[4] = {1, 2, 3, 4};
    store(KEEPER_LAW_TABLE, words, 4);
    wired = &board;
    start();
    TEST_ASSERT_EQUAL_UINT32(0, read_words(KEEPER_LAW_TABLE));
    store(KEEPER_LAW_TABLE, words, 3);
    start();
    TEST_ASSERT_EQUAL_UINT32(3, read_words(KEEPER_LAW_TABLE));
    TEST_ASSERT_EQUAL_UINT32(2, kept_writes(&kept, KEEPER_LAW_TABLE));
}

// A bit of the record that a start would find.
static void flip(keeper_record_t record) {
    const uint32_t at = kept.nvm.record[record].at + NVM_HEAD_WORDS;
    ((volatile uint32_t *)NVM_MPS2_BASE)[kept.nvm.half * kept.nvm.half_words + at] ^= 1u;
}

static keeper_state_t state_of(keeper_record_t record) {
    start();
    (void)read_words(record);
    return kept.state;
}

static void test_how_each_record_was_found_is_told(void) {
    static const uint32_t words[4] = {1, 2, 3, 4};
    for (uint32_t i = 0; i < KEEPER_RECORDS; i++) {
        const keeper_record_t record = (keeper_record_t)i;
        TEST_ASSERT_EQUAL(KEEPER_WHOLE, state_of(record));
        store(record, words, 4);
        store(record, words, 3);
        TEST_ASSERT_EQUAL(KEEPER_WHOLE, state_of(record));
        flip(record);
        TEST_ASSERT_EQUAL(KEEPER_OLDER, state_of(record));
        flip(record);
        TEST_ASSERT_EQUAL(KEEPER_LOST, state_of(record));
        TEST_ASSERT_EQUAL_UINT32(0, read_words(record));
    }
}

static void test_too_many_words_fail_at_once(void) {
    TEST_ASSERT_EQUAL(KEEPER_FAILED,
                      kept_store(&kept, KEEPER_LAW_TABLE, NULL, HAL_NVM_MAX_WORDS + 1u));
    TEST_ASSERT_EQUAL(KEEPER_FAILED,
                      kept_store(&kept, KEEPER_PARAMS, NULL, QUIESCE_PARAM_COUNT + 1u));
    TEST_ASSERT_EQUAL(HAL_NVM_IDLE, kept_work(&kept));
}

static void test_one_at_a_time(void) {
    const uint32_t words[2] = {1, 2};
    TEST_ASSERT_EQUAL(KEEPER_BEGUN, kept_store(&kept, KEEPER_LEARNT, words, 2));
    TEST_ASSERT_EQUAL(KEEPER_BUSY, kept_store(&kept, KEEPER_LAW_TABLE, words, 2));
    TEST_ASSERT_EQUAL(HAL_NVM_DONE, work());
    TEST_ASSERT_EQUAL(HAL_NVM_IDLE, kept_work(&kept)); // told once
    TEST_ASSERT_EQUAL_UINT32(0, read_words(KEEPER_LAW_TABLE));
    TEST_ASSERT_EQUAL_UINT32(2, read_words(KEEPER_LEARNT));
    TEST_ASSERT_EQUAL_UINT32(2, back_words[1]);
}

// They go on changing while they are written.
static void test_parameters_are_stored_as_they_were_at_the_call(void) {
    quiesce_params_t params = shipped;
    quiesce_params_t back = {0};
    TEST_ASSERT_EQUAL(KEEPER_BEGUN,
                      kept_store(&kept, KEEPER_PARAMS, (const uint32_t *)(const void *)&params,
                                 QUIESCE_PARAM_COUNT));
    params.constant_current_mA++;
    TEST_ASSERT_EQUAL(HAL_NVM_DONE, work());
    TEST_ASSERT_TRUE(kept_read_params(&kept, &back));
    TEST_ASSERT_EQUAL_MEMORY(&shipped, &back, sizeof back);
}

static void test_a_record_that_is_too_long_for_its_reader_is_lost(void) {
    static uint32_t words[4] = {1, 2, 3, 4};
    store(KEEPER_LEARNT, words, 4);
    TEST_ASSERT_EQUAL_UINT32(0, kept_read(&kept, KEEPER_LEARNT, back_words, 3));
    TEST_ASSERT_EQUAL(KEEPER_LOST, kept.state);
    TEST_ASSERT_EQUAL_UINT32(4, kept_read(&kept, KEEPER_LEARNT, back_words, 4));
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(test_parameters_come_back_while_those_that_ship_are_the_same);
    RUN_TEST(test_parameters_of_another_number_or_forgotten_are_none);
    RUN_TEST(test_longest_table_comes_back_and_is_forgotten);
    RUN_TEST(test_table_of_another_board_is_not_used);
    RUN_TEST(test_how_each_record_was_found_is_told);
    RUN_TEST(test_too_many_words_fail_at_once);
    RUN_TEST(test_one_at_a_time);
    RUN_TEST(test_parameters_are_stored_as_they_were_at_the_call);
    RUN_TEST(test_a_record_that_is_too_long_for_its_reader_is_lost);
    return UNITY_END();
}
