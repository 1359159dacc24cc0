// Records on simulated flash: blocks of any size, bits that flip, words that fail.
#include "nvm_rig.h"
#include "unity.h"

#define HALF_OF(rig) ((rig).nvm.half * (rig).nvm.half_words)

static nvm_rig_t rig;

void setUp(void) {
    rig_make(&rig, 32, 0);
}

void tearDown(void) {}

static uint32_t *word_of(uint32_t record, uint32_t word) {
    return &rig.memory.words[HALF_OF(rig) + rig.nvm.record[record].at + word];
}

static void test_fresh_memory_has_nothing(void) {
    static const uint32_t contents[] = {0, UINT32_MAX, 1, 0x5A5A5A5Au, NVM_ENTRY, NVM_HALF};
    for (uint32_t i = 0; i < sizeof contents / sizeof contents[0]; i++) {
        rig_make(&rig, 32, contents[i]);
        TEST_ASSERT_EQUAL_UINT32(0, hal_nvm_erases(&rig.nvm));
        for (uint32_t record = 0; record < HAL_NVM_RECORDS; record++) {
            rig_assert_nothing(&rig, HAL_NVM_NONE, record);
            TEST_ASSERT_EQUAL_UINT32(0, hal_nvm_writes(&rig.nvm, record));
            rig_write(&rig, record, 3, record);
            rig_assert(&rig, HAL_NVM_KEPT, record, 3, record);
        }
        TEST_ASSERT_EQUAL_UINT32(1, hal_nvm_erases(&rig.nvm));
    }
}

// Many times round both halves; each time the counts grow by what was done.
static void test_records_of_all_lengths_come_back_and_keep_apart(void) {
    static const uint32_t counts[] = {0, 1, 15, 16, 17, 28, 29, 1000, 2047, 2048};
    static const uint32_t blocks[] = {4, 32, 1024, 3072};
    for (uint32_t b = 0; b < sizeof blocks / sizeof blocks[0]; b++) {
        rig_make(&rig, blocks[b], 0);
        for (uint32_t i = 0; i < sizeof counts / sizeof counts[0]; i++) {
            for (uint32_t record = 0; record < HAL_NVM_RECORDS; record++) {
                rig_write(&rig, record, counts[i], 8u * i + record);
            }
            const uint32_t erases = hal_nvm_erases(&rig.nvm);
            rig_start(&rig);
            TEST_ASSERT_EQUAL_UINT32(erases, hal_nvm_erases(&rig.nvm));
            for (uint32_t record = 0; record < HAL_NVM_RECORDS; record++) {
                rig_assert(&rig, HAL_NVM_KEPT, record, counts[i], 8u * i + record);
                TEST_ASSERT_EQUAL_UINT32(i + 1u, hal_nvm_writes(&rig.nvm, record));
            }
        }
        TEST_ASSERT_GREATER_THAN_UINT32(2, hal_nvm_erases(&rig.nvm));
    }
}

static void test_what_cannot_be_written_is_refused(void) {
    static uint32_t words[1];
    TEST_ASSERT_FALSE(hal_nvm_begin(&rig.nvm, HAL_NVM_RECORDS, words, 1));
    TEST_ASSERT_FALSE(hal_nvm_begin(&rig.nvm, 0, words, HAL_NVM_MAX_WORDS + 1u));
    TEST_ASSERT_EQUAL(HAL_NVM_IDLE, hal_nvm_work(&rig.nvm));
    rig_assert_nothing(&rig, HAL_NVM_NONE, HAL_NVM_RECORDS);
    TEST_ASSERT_EQUAL_UINT32(0, hal_nvm_writes(&rig.nvm, HAL_NVM_RECORDS));
    rig.memory.size--;
    TEST_ASSERT_FALSE(nvm_records_open(&rig.nvm, &rig.memory, RIG_OWNER));
    TEST_ASSERT_FALSE(hal_nvm_begin(&rig.nvm, 0, words, 1));
}

// A record that changes often wears the memory by its words, not by an erasure each time.
static void test_wear_is_shared(void) {
    const uint32_t writes = 1200;
    for (uint32_t i = 0; i < writes; i++) {
        rig_write(&rig, 4, 20, i);
    }
    const uint32_t per_half = (rig.nvm.half_words - NVM_FIRST_AT) / (20u + NVM_ENTRY_EXTRA_WORDS);
    TEST_ASSERT_EQUAL_UINT32((writes + per_half - 1u) / per_half, hal_nvm_erases(&rig.nvm));
    TEST_ASSERT_EQUAL_UINT32(writes, hal_nvm_writes(&rig.nvm, 4));
}

static void prepare(uint32_t writes, uint32_t count) {
    rig_make(&rig, 32, 0);
    rig_write(&rig, 0, 20, 7);
    for (uint32_t i = 1; i <= writes; i++) {
        rig_write(&rig, 1, count, i);
    }
}

static void test_flipped_bit_of_the_newer_entry_gives_the_older_and_says_so(void) {
    prepare(4, 5);
    const uint32_t at = HALF_OF(rig) + rig.nvm.record[1].at;
    const uint32_t words = NVM_HEAD_WORDS + 8u + 2u;
    for (uint32_t bit = 0; bit < 32u * words; bit++) {
        if (bit / 32u >= NVM_HEAD_WORDS + 5u && bit / 32u < NVM_HEAD_WORDS + 8u) {
            continue; // a gap
        }
        rig.memory.words[at + bit / 32u] ^= 1u << bit % 32u;
        rig_start(&rig);
        rig_assert(&rig, HAL_NVM_OLDER, 1, 5, 3);
        rig.memory.words[at + bit / 32u] ^= 1u << bit % 32u;
    }
    rig_start(&rig);
    rig_assert(&rig, HAL_NVM_KEPT, 1, 5, 4);
}

// Anywhere before it, and in the heads of the half.
static void test_flipped_bit_elsewhere_does_no_harm(void) {
    prepare(3, 5);
    const uint32_t base = HALF_OF(rig);
    const uint32_t end = rig.nvm.record[1].at;
    for (uint32_t bit = 0; bit < 32u * end; bit++) {
        rig.memory.words[base + bit / 32u] ^= 1u << bit % 32u;
        rig_start(&rig);
        rig_assert(&rig, HAL_NVM_KEPT, 1, 5, 3);
        rig.memory.words[base + bit / 32u] ^= 1u << bit % 32u;
    }
}

// No bit that has flipped keeps a record from being written.
static void test_flipped_bit_anywhere_leaves_the_store_writable(void) {
    prepare(3, 5);
    static nvm_rig_t saved;
    saved = rig;
    const uint32_t base = HALF_OF(rig);
    for (uint32_t bit = 0; bit < 32u * saved.nvm.end; bit += 37u) {
        rig = saved;
        rig.memory.words[base + bit / 32u] ^= 1u << bit % 32u;
        rig_start(&rig);
        rig_write(&rig, 1, 6, 40);
        rig_start(&rig);
        rig_assert(&rig, HAL_NVM_KEPT, 1, 6, 40);
    }
}

static void test_lost_record_is_told_until_it_is_written_anew(void) {
    prepare(2, 5);
    *word_of(1, NVM_HEAD_WORDS) ^= 4u;
    rig_start(&rig);
    *word_of(1, NVM_HEAD_WORDS) ^= 1u;
    rig_start(&rig);
    rig_assert_nothing(&rig, HAL_NVM_LOST, 1);
    TEST_ASSERT_EQUAL_UINT32(2, hal_nvm_writes(&rig.nvm, 1));
    const uint32_t erases = hal_nvm_erases(&rig.nvm);
    for (uint32_t i = 0; hal_nvm_erases(&rig.nvm) < erases + 2u; i++) { // round both halves
        rig_write(&rig, 3, 1000, i);
    }
    rig_start(&rig);
    rig_assert_nothing(&rig, HAL_NVM_LOST, 1);
    rig_assert(&rig, HAL_NVM_KEPT, 0, 20, 7);
    rig_write(&rig, 1, 9, 50);
    rig_assert(&rig, HAL_NVM_KEPT, 1, 9, 50);
    rig_start(&rig);
    rig_assert(&rig, HAL_NVM_KEPT, 1, 9, 50);
    TEST_ASSERT_EQUAL_UINT32(3, hal_nvm_writes(&rig.nvm, 1));
}

static void test_doubt_outlives_a_change_of_halves(void) {
    prepare(2, 5);
    *word_of(1, NVM_HEAD_WORDS) ^= 4u;
    rig_start(&rig);
    rig_assert(&rig, HAL_NVM_OLDER, 1, 5, 1);
    const uint32_t erases = hal_nvm_erases(&rig.nvm);
    for (uint32_t i = 0; hal_nvm_erases(&rig.nvm) < erases + 3u; i++) {
        rig_write(&rig, 3, 1000, i);
        rig_assert(&rig, HAL_NVM_OLDER, 1, 5, 1);
    }
    rig_start(&rig);
    rig_assert(&rig, HAL_NVM_OLDER, 1, 5, 1);
    TEST_ASSERT_EQUAL_UINT32(2, hal_nvm_writes(&rig.nvm, 1));
}

// An entry that moved belongs to the record in its head.
static void test_entry_of_another_record_is_not_taken(void) {
    prepare(1, 5);
    word_of(1, 0)[NVM_HEAD_MAGIC] += 2u;
    rig_start(&rig);
    rig_assert_nothing(&rig, HAL_NVM_NONE, 3);
    rig_assert_nothing(&rig, HAL_NVM_NONE, 1);
}

// Not used, but how often it was written is known.
static void test_record_of_another_owner_is_lost(void) {
    prepare(3, 5);
    TEST_ASSERT_TRUE(nvm_records_open(&rig.nvm, &rig.memory, RIG_OWNER + 1u));
    rig_assert_nothing(&rig, HAL_NVM_LOST, 1);
    TEST_ASSERT_EQUAL_UINT32(3, hal_nvm_writes(&rig.nvm, 1));
    rig_write(&rig, 1, 5, 60);
    TEST_ASSERT_TRUE(nvm_records_open(&rig.nvm, &rig.memory, RIG_OWNER + 1u));
    rig_assert(&rig, HAL_NVM_KEPT, 1, 5, 60);
    rig_assert_nothing(&rig, HAL_NVM_LOST, 0);
}

static void test_numbers_go_round(void) {
    rig_write(&rig, 1, 5, 9);
    rig.nvm.record[1].writes = UINT32_MAX - 2u;
    rig.nvm.number = UINT32_MAX - 2u;
    rig.nvm.is_mended = true;
    for (uint32_t i = 0; i < 24u; i++) {
        rig_write(&rig, 1, 2000, i);
        rig_start(&rig);
        rig_assert(&rig, HAL_NVM_KEPT, 1, 2000, i);
    }
    TEST_ASSERT_LESS_THAN_UINT32(100, hal_nvm_erases(&rig.nvm));
}

// The write after one that has failed goes behind it.
static void test_failed_word_leaves_the_record_before(void) {
    static nvm_rig_t saved;
    prepare(3, 40);
    saved = rig;
    const uint32_t begin = HALF_OF(rig) + rig.nvm.end;
    uint32_t failed = 0;
    for (uint32_t i = 0; i < 40u + NVM_ENTRY_EXTRA_WORDS; i++) {
        rig = saved;
        rig.memory.bad_word = begin + i;
        const bool is_done = rig_try(&rig, 1, 40, 4) == HAL_NVM_DONE;
        failed += is_done ? 0u : 1u;
        hal_nvm_found_t found;
        TEST_ASSERT_TRUE(rig_has(&rig, 1, 40, is_done ? 4 : 3, &found));
        rig_start(&rig);
        TEST_ASSERT_TRUE(rig_has(&rig, 1, 40, is_done ? 4 : 3, &found));
        rig_write(&rig, 1, 40, 5);
        rig_start(&rig);
        rig_assert(&rig, HAL_NVM_KEPT, 1, 40, 5);
    }
    TEST_ASSERT_GREATER_THAN_UINT32(20, failed);
}

static void test_unreadable_memory_has_nothing_and_takes_nothing(void) {
    prepare(2, 5);
    rig.memory.is_unreadable = true;
    rig_start(&rig);
    rig_assert_nothing(&rig, HAL_NVM_NONE, 1);
    TEST_ASSERT_EQUAL(HAL_NVM_FAILED, rig_try(&rig, 1, 5, 9));
}

static void test_memory_that_becomes_unreadable_loses_nothing(void) {
    prepare(2, 5);
    rig.memory.is_unreadable = true;
    rig_assert_nothing(&rig, HAL_NVM_LOST, 1);
    TEST_ASSERT_EQUAL(HAL_NVM_FAILED, rig_try(&rig, 1, 5, 9));
    rig.memory.is_unreadable = false;
    rig_start(&rig);
    hal_nvm_found_t found;
    TEST_ASSERT_TRUE(rig_has(&rig, 1, 5, 2, &found));
    rig_write(&rig, 1, 5, 10);
    rig_assert(&rig, HAL_NVM_KEPT, 1, 5, 10);
}

static void test_a_call_writes_a_slice_at_most(void) {
    static uint32_t words[HAL_NVM_MAX_WORDS];
    rig_make(&rig, 3072, 0);
    rig_write(&rig, 0, 1, 1);
    TEST_ASSERT_TRUE(hal_nvm_begin(&rig.nvm, 1, words, HAL_NVM_MAX_WORDS));
    uint32_t calls = 1;
    for (uint32_t before = rig.memory.operations; hal_nvm_work(&rig.nvm) == HAL_NVM_BUSY;
         before = rig.memory.operations) {
        TEST_ASSERT_LESS_OR_EQUAL_UINT32(HAL_NVM_SLICE_WORDS, rig.memory.operations - before);
        calls++;
    }
    TEST_ASSERT_EQUAL_UINT32(2u * (1u + HAL_NVM_MAX_WORDS / HAL_NVM_SLICE_WORDS + 1u), calls);
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(test_fresh_memory_has_nothing);
    RUN_TEST(test_records_of_all_lengths_come_back_and_keep_apart);
    RUN_TEST(test_what_cannot_be_written_is_refused);
    RUN_TEST(test_wear_is_shared);
    RUN_TEST(test_flipped_bit_of_the_newer_entry_gives_the_older_and_says_so);
    RUN_TEST(test_flipped_bit_elsewhere_does_no_harm);
    RUN_TEST(test_flipped_bit_anywhere_leaves_the_store_writable);
    RUN_TEST(test_lost_record_is_told_until_it_is_written_anew);
    RUN_TEST(test_doubt_outlives_a_change_of_halves);
    RUN_TEST(test_entry_of_another_record_is_not_taken);
    RUN_TEST(test_record_of_another_owner_is_lost);
    RUN_TEST(test_numbers_go_round);
    RUN_TEST(test_failed_word_leaves_the_record_before);
    RUN_TEST(test_unreadable_memory_has_nothing_and_takes_nothing);
    RUN_TEST(test_memory_that_becomes_unreadable_loses_nothing);
    RUN_TEST(test_a_call_writes_a_slice_at_most);
    return UNITY_END();
}
