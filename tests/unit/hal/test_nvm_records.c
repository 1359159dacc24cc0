// Records on simulated flash: blocks of any size, words that fail, and a power cut in the middle of
// any word, of which some bits then got through.
#include "nvm_records.h"
#include "unity.h"

#include <string.h>

#define MOST_WORDS (8u * 3072u)
#define ERASED UINT32_MAX
#define NEVER UINT32_MAX
#define OWNER 5u

struct hal_nvm_memory {
    uint32_t words[MOST_WORDS];
    uint32_t size;
    uint32_t block_words;
    uint32_t left;     ///< words that it still erases or programs; then the power is gone
    uint32_t through;  ///< bits of the word after them that still change
    uint32_t bad_word; ///< keeps its lowest bit
    bool is_unreadable;
    uint32_t busy; ///< calls of the step that is under way
    uint32_t busy_at;
    uint32_t most_written; ///< words in a call
};

static hal_nvm_memory_t memory;
static hal_nvm_t nvm;
static uint32_t back[HAL_NVM_MAX_WORDS];

static void open_memory(void) {
    memory.left = NEVER;
    memory.busy = 0;
    TEST_ASSERT_TRUE(nvm_records_open(&nvm, &memory, OWNER));
}

static void make_memory(uint32_t block_words, uint32_t content) {
    memory = (hal_nvm_memory_t){
        .block_words = block_words, .size = nvm_records_words(block_words), .bad_word = NEVER};
    TEST_ASSERT_LESS_OR_EQUAL_UINT32(MOST_WORDS, memory.size);
    for (uint32_t i = 0; i < memory.size; i++) {
        memory.words[i] = content;
    }
    open_memory();
}

void setUp(void) {
    make_memory(32, 0);
}

void tearDown(void) {}

uint32_t hal_nvm_memory_words(const hal_nvm_memory_t *it) {
    return it->size;
}

uint32_t hal_nvm_memory_block_words(const hal_nvm_memory_t *it) {
    return it->block_words;
}

bool hal_nvm_memory_read(hal_nvm_memory_t *it, uint32_t at, uint32_t *words, uint32_t count) {
    TEST_ASSERT_TRUE(at + count <= it->size);
    memcpy(words, &it->words[at], count * sizeof *words);
    return !it->is_unreadable;
}

// Every step takes two calls, the second one with what the first one had.
static bool is_busy(hal_nvm_memory_t *it, uint32_t at) {
    it->busy ^= 1u;
    if (it->busy == 0u) {
        TEST_ASSERT_EQUAL_UINT32(it->busy_at, at);
    }
    it->busy_at = at;
    return it->busy == 1u;
}

// Once the power is gone nothing changes any more, whatever the program does.
static void change(hal_nvm_memory_t *it, uint32_t at, uint32_t to) {
    const uint32_t bits = it->left > 0u ? UINT32_MAX : it->through;
    it->words[at] = (it->words[at] & ~bits) | (to & bits);
    it->words[at] |= at == it->bad_word ? 1u : 0u;
    it->through = it->left > 0u ? it->through : 0u;
    it->left -= it->left > 0u && it->left != NEVER ? 1u : 0u;
}

hal_nvm_progress_t hal_nvm_memory_erase(hal_nvm_memory_t *it, uint32_t at) {
    TEST_ASSERT_TRUE(at % it->block_words == 0u && at < it->size);
    if (is_busy(it, at)) {
        return HAL_NVM_BUSY;
    }
    for (uint32_t i = 0; i < it->block_words; i++) {
        change(it, at + i, ERASED);
    }
    return HAL_NVM_DONE;
}

hal_nvm_progress_t hal_nvm_memory_program(hal_nvm_memory_t *it, uint32_t at, const uint32_t *words,
                                          uint32_t count) {
    TEST_ASSERT_TRUE(at % 4u == 0u && count > 0u && count <= HAL_NVM_SLICE_WORDS);
    if (is_busy(it, at)) {
        return HAL_NVM_BUSY;
    }
    for (uint32_t i = 0; i < count; i++) {
        if (it->words[at + i] != ERASED) {
            return HAL_NVM_FAILED;
        }
    }
    for (uint32_t i = 0; i < count; i++) {
        change(it, at + i, words[i]);
    }
    return HAL_NVM_DONE;
}

// Words that no other key, place or count has.
static void fill(uint32_t *words, uint32_t count, uint32_t key) {
    for (uint32_t i = 0; i < count; i++) {
        words[i] = (key * 2654435761u) ^ (i * 40503u) ^ count;
    }
}

static hal_nvm_progress_t try_write(uint32_t record, uint32_t count, uint32_t key) {
    static uint32_t words[HAL_NVM_MAX_WORDS];
    hal_nvm_progress_t step = HAL_NVM_BUSY;
    fill(words, count, key);
    TEST_ASSERT_TRUE(hal_nvm_begin(&nvm, record, words, count));
    TEST_ASSERT_FALSE(hal_nvm_begin(&nvm, record, words, count)); // one at a time
    for (uint32_t i = 0; i < 2000u && step == HAL_NVM_BUSY; i++) {
        step = hal_nvm_work(&nvm);
    }
    TEST_ASSERT_TRUE(step == HAL_NVM_DONE || step == HAL_NVM_FAILED);
    TEST_ASSERT_EQUAL(HAL_NVM_IDLE, hal_nvm_work(&nvm));
    return step;
}

static void write_record(uint32_t record, uint32_t count, uint32_t key) {
    TEST_ASSERT_EQUAL(HAL_NVM_DONE, try_write(record, count, key));
}

static bool is_record(uint32_t count, uint32_t key, uint32_t found_count) {
    static uint32_t words[HAL_NVM_MAX_WORDS];
    fill(words, count, key);
    return found_count == count && memcmp(words, back, count * sizeof *words) == 0;
}

static hal_nvm_found_t read_record(uint32_t record, uint32_t *count) {
    memset(back, 0x5A, sizeof back);
    return hal_nvm_read(&nvm, record, back, count);
}

static void assert_record(hal_nvm_found_t found, uint32_t record, uint32_t count, uint32_t key) {
    uint32_t found_count;
    TEST_ASSERT_EQUAL(found, read_record(record, &found_count));
    TEST_ASSERT_TRUE(is_record(count, key, found_count));
}

static void assert_nothing(hal_nvm_found_t found, uint32_t record) {
    uint32_t count = 7;
    TEST_ASSERT_EQUAL(found, read_record(record, &count));
    TEST_ASSERT_EQUAL_UINT32(0, count);
}

static void read_all(void) {
    uint32_t count;
    for (uint32_t i = 0; i < HAL_NVM_RECORDS; i++) {
        (void)read_record(i, &count);
    }
}

static void test_fresh_memory_has_nothing(void) {
    static const uint32_t contents[] = {0, ERASED, 1, 0x5A5A5A5Au, NVM_MAGIC + 0x0F000000u};
    for (uint32_t i = 0; i < sizeof contents / sizeof contents[0]; i++) {
        make_memory(32, contents[i]);
        for (uint32_t record = 0; record < HAL_NVM_RECORDS; record++) {
            assert_nothing(HAL_NVM_NONE, record);
            TEST_ASSERT_EQUAL_UINT32(0, hal_nvm_writes(&nvm, record));
            write_record(record, 3, record);
            assert_record(HAL_NVM_KEPT, record, 3, record);
        }
    }
}

static void test_records_of_all_lengths_come_back_and_keep_apart(void) {
    static const uint32_t counts[] = {0, 1, 15, 16, 17, 28, 29, 1000, 2047, 2048};
    static const uint32_t blocks[] = {4, 32, 1024, 3072};
    for (uint32_t b = 0; b < sizeof blocks / sizeof blocks[0]; b++) {
        make_memory(blocks[b], 0);
        read_all();
        for (uint32_t i = 0; i < sizeof counts / sizeof counts[0]; i++) {
            for (uint32_t record = 0; record < HAL_NVM_RECORDS; record++) {
                write_record(record, counts[i], 4u * i + record);
            }
            open_memory();
            for (uint32_t record = 0; record < HAL_NVM_RECORDS; record++) {
                assert_record(HAL_NVM_KEPT, record, counts[i], 4u * i + record);
                TEST_ASSERT_EQUAL_UINT32(i + 1u, hal_nvm_writes(&nvm, record));
            }
        }
    }
}

static void test_what_cannot_be_written_is_refused(void) {
    TEST_ASSERT_FALSE(hal_nvm_begin(&nvm, 0, back, 1)); // has not been read
    read_all();
    TEST_ASSERT_FALSE(hal_nvm_begin(&nvm, HAL_NVM_RECORDS, back, 1));
    TEST_ASSERT_FALSE(hal_nvm_begin(&nvm, 0, back, HAL_NVM_MAX_WORDS + 1u));
    TEST_ASSERT_EQUAL(HAL_NVM_IDLE, hal_nvm_work(&nvm));
    assert_nothing(HAL_NVM_NONE, HAL_NVM_RECORDS);
    TEST_ASSERT_EQUAL_UINT32(0, hal_nvm_writes(&nvm, HAL_NVM_RECORDS));
    memory.size--;
    TEST_ASSERT_FALSE(nvm_records_open(&nvm, &memory, OWNER));
}

// What was known before a cut: whatever the power leaves is this or the next write, and never
// anything else; the other record is untouched, and writing goes on.
static void cut(uint32_t writes, uint32_t count, uint32_t left, uint32_t through) {
    static hal_nvm_memory_t saved;
    const uint32_t before_count = writes == 0u ? 0u : count;
    uint32_t found_count;
    saved = memory;
    memory.left = left;
    memory.through = through;
    (void)try_write(1, count, writes + 1u);
    open_memory();

    const hal_nvm_found_t found = read_record(1, &found_count);
    const bool is_new = is_record(count, writes + 1u, found_count);
    TEST_ASSERT_TRUE(is_new || is_record(before_count, writes, found_count));
    TEST_ASSERT_NOT_EQUAL(HAL_NVM_LOST, found);
    TEST_ASSERT_EQUAL(writes == 0u && !is_new, found == HAL_NVM_NONE);
    TEST_ASSERT_EQUAL_UINT32(writes + (is_new ? 1u : 0u), hal_nvm_writes(&nvm, 1));
    write_record(1, count, 99);
    open_memory();
    assert_record(HAL_NVM_KEPT, 1, count, 99);
    TEST_ASSERT_EQUAL_UINT32(writes + (is_new ? 2u : 1u), hal_nvm_writes(&nvm, 1));
    assert_record(HAL_NVM_KEPT, 0, 20, 7);
    assert_record(HAL_NVM_KEPT, 2, 20, 8);
    memory = saved;
    open_memory();
    read_all();
}

static void prepare(uint32_t block_words, uint32_t writes, uint32_t count) {
    make_memory(block_words, writes % 2u == 0u ? 0u : ERASED);
    read_all();
    write_record(0, 20, 7);
    write_record(2, 20, 8);
    for (uint32_t i = 1; i <= writes; i++) {
        write_record(1, count, i);
    }
}

static void test_cut_anywhere_leaves_the_old_or_the_new_record(void) {
    static const uint32_t through[] = {0, 0xFFFFu, 0x55555555u, 0xAAAAAAAAu, 0xFFFFFFFEu};
    const uint32_t count = 40;
    const uint32_t operations = 2u * 32u + NVM_HEAD_WORDS + count; // two blocks
    for (uint32_t writes = 0; writes < 4u; writes++) {
        prepare(32, writes, count);
        for (uint32_t left = 0; left <= operations; left++) {
            for (uint32_t i = 0; i < sizeof through / sizeof through[0]; i++) {
                cut(writes, count, left, through[i]);
            }
        }
    }
}

static void test_cut_of_the_longest_record(void) {
    const uint32_t operations = 3072u + NVM_HEAD_WORDS + HAL_NVM_MAX_WORDS;
    prepare(1024, 2, HAL_NVM_MAX_WORDS);
    for (uint32_t left = 0; left < operations; left += 397u) {
        cut(2, HAL_NVM_MAX_WORDS, left, 0xFFFFu);
    }
    for (uint32_t left = operations - NVM_HEAD_WORDS - 1u; left <= operations; left++) {
        cut(2, HAL_NVM_MAX_WORDS, left, 0x0F0F0F0Fu);
    }
}

// Power that goes again while the record is written that the cut before has kept from being
// written.
static void test_cuts_one_after_the_other_lose_nothing(void) {
    prepare(32, 3, 40);
    for (uint32_t left = 0; left < 108u; left += 5u) {
        memory.left = left;
        memory.through = 0x00FF00FFu;
        (void)try_write(1, 40, 4);
        open_memory();
        uint32_t count;
        TEST_ASSERT_NOT_EQUAL(HAL_NVM_LOST, read_record(1, &count));
        TEST_ASSERT_TRUE(is_record(40, 3, count));
    }
    write_record(1, 40, 5);
    assert_record(HAL_NVM_KEPT, 1, 40, 5);
}

// The first write goes to slot 1.
static uint32_t slot_of(uint32_t record, uint32_t slot) {
    return (record * 2u + slot) * nvm.slot_words;
}

static void test_flipped_bit_of_the_newer_slot_gives_the_older_and_says_so(void) {
    for (uint32_t writes = 2; writes < 10u; writes++) {
        prepare(32, writes, 5);
        const uint32_t newer = slot_of(1, writes % 2u);
        for (uint32_t bit = 0; bit < 32u * (NVM_HEAD_WORDS + 5u); bit++) {
            memory.words[newer + bit / 32u] ^= 1u << bit % 32u;
            open_memory();
            assert_record(HAL_NVM_OLDER, 1, 5, writes - 1u);
            memory.words[newer + bit / 32u] ^= 1u << bit % 32u;
        }
        open_memory();
        assert_record(HAL_NVM_KEPT, 1, 5, writes);
    }
}

static void test_flipped_bit_of_the_older_slot_does_no_harm(void) {
    for (uint32_t writes = 2; writes < 10u; writes++) {
        prepare(32, writes, 5);
        const uint32_t older = slot_of(1, 1u - writes % 2u);
        for (uint32_t bit = 0; bit < 32u * (NVM_HEAD_WORDS + 5u); bit++) {
            memory.words[older + bit / 32u] ^= 1u << bit % 32u;
            open_memory();
            uint32_t count;
            const hal_nvm_found_t found = read_record(1, &count);
            TEST_ASSERT_TRUE(found == HAL_NVM_KEPT || found == HAL_NVM_OLDER);
            TEST_ASSERT_TRUE(is_record(5, writes, count));
            memory.words[older + bit / 32u] ^= 1u << bit % 32u;
        }
    }
}

static void test_two_damaged_slots_are_told_and_written_anew(void) {
    prepare(32, 6, 5);
    memory.words[slot_of(1, 0) + NVM_HEAD_WORDS] ^= 4u;
    memory.words[slot_of(1, 1) + NVM_HEAD_WORDS + 4u] ^= 1u;
    open_memory();
    assert_nothing(HAL_NVM_LOST, 1);
    TEST_ASSERT_EQUAL_UINT32(6, hal_nvm_writes(&nvm, 1));
    write_record(1, 9, 50);
    open_memory();
    uint32_t count;
    TEST_ASSERT_EQUAL(HAL_NVM_OLDER, read_record(1, &count)); // the other one is damaged still
    TEST_ASSERT_TRUE(is_record(9, 50, count));
    write_record(1, 9, 51);
    assert_record(HAL_NVM_KEPT, 1, 9, 51);
    TEST_ASSERT_EQUAL_UINT32(8, hal_nvm_writes(&nvm, 1));
}

// A slot elsewhere is another record's.
static void test_slot_of_another_record_is_not_taken(void) {
    prepare(32, 1, 5);
    memcpy(&memory.words[slot_of(3, 1)], &memory.words[slot_of(1, 1)], 9u * sizeof(uint32_t));
    open_memory();
    assert_nothing(HAL_NVM_NONE, 3);
}

// Not used, but the memory's wear is known.
static void test_record_of_another_owner_is_lost(void) {
    prepare(32, 3, 5);
    TEST_ASSERT_TRUE(nvm_records_open(&nvm, &memory, OWNER + 1u));
    assert_nothing(HAL_NVM_LOST, 1);
    TEST_ASSERT_EQUAL_UINT32(3, hal_nvm_writes(&nvm, 1));
    write_record(1, 5, 60);
    uint32_t count;
    TEST_ASSERT_EQUAL(HAL_NVM_OLDER, read_record(1, &count)); // beside one of the other owner
    TEST_ASSERT_TRUE(is_record(5, 60, count));
}

static void test_sequence_goes_round(void) {
    read_all();
    nvm.record[1].sequence = UINT32_MAX - 2u;
    for (uint32_t i = 0; i < 6u; i++) {
        write_record(1, 5, i);
        open_memory();
        assert_record(HAL_NVM_KEPT, 1, 5, i);
    }
}

static void test_failed_word_leaves_the_record_before(void) {
    prepare(32, 3, 40);
    for (uint32_t i = 0; i < 44u; i++) {
        memory.bad_word = slot_of(1, 0) + i;
        const hal_nvm_progress_t step = try_write(1, 40, 4);
        memory.bad_word = NEVER;
        open_memory();
        uint32_t count;
        (void)read_record(1, &count);
        TEST_ASSERT_TRUE(is_record(40, step == HAL_NVM_DONE ? 4 : 3, count));
        if (step == HAL_NVM_DONE) { // that bit is one in the word
            prepare(32, 3, 40);
        }
    }
    write_record(1, 40, 6);
    assert_record(HAL_NVM_KEPT, 1, 40, 6);
}

static void test_unreadable_memory_has_nothing_and_takes_nothing(void) {
    prepare(32, 2, 5);
    memory.is_unreadable = true;
    open_memory();
    assert_nothing(HAL_NVM_NONE, 1);
    TEST_ASSERT_EQUAL(HAL_NVM_FAILED, try_write(1, 5, 9));
}

static void test_a_call_writes_a_slice_at_most(void) {
    static uint32_t words[HAL_NVM_MAX_WORDS];
    make_memory(3072, 0);
    read_all();
    TEST_ASSERT_TRUE(hal_nvm_begin(&nvm, 1, words, HAL_NVM_MAX_WORDS));
    uint32_t calls = 0;
    while (hal_nvm_work(&nvm) == HAL_NVM_BUSY) {
        calls++;
    }
    TEST_ASSERT_EQUAL_UINT32(2u * (1u + HAL_NVM_MAX_WORDS / HAL_NVM_SLICE_WORDS + 1u) - 1u, calls);
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(test_fresh_memory_has_nothing);
    RUN_TEST(test_records_of_all_lengths_come_back_and_keep_apart);
    RUN_TEST(test_what_cannot_be_written_is_refused);
    RUN_TEST(test_cut_anywhere_leaves_the_old_or_the_new_record);
    RUN_TEST(test_cut_of_the_longest_record);
    RUN_TEST(test_cuts_one_after_the_other_lose_nothing);
    RUN_TEST(test_flipped_bit_of_the_newer_slot_gives_the_older_and_says_so);
    RUN_TEST(test_flipped_bit_of_the_older_slot_does_no_harm);
    RUN_TEST(test_two_damaged_slots_are_told_and_written_anew);
    RUN_TEST(test_slot_of_another_record_is_not_taken);
    RUN_TEST(test_record_of_another_owner_is_lost);
    RUN_TEST(test_sequence_goes_round);
    RUN_TEST(test_failed_word_leaves_the_record_before);
    RUN_TEST(test_unreadable_memory_has_nothing_and_takes_nothing);
    RUN_TEST(test_a_call_writes_a_slice_at_most);
    return UNITY_END();
}
