// The board's memory keeps the contract of flash, and records on it outlive a program.
#include "nvm_mps2.h"
#include "nvm_records.h"
#include "unity.h"

static hal_nvm_memory_t memory;
static uint32_t words[HAL_NVM_MAX_WORDS];

void setUp(void) {
    memory = (hal_nvm_memory_t){.words = (volatile uint32_t *)NVM_MPS2_BASE};
}

void tearDown(void) {}

static uint32_t word_at(uint32_t at) {
    uint32_t word = 0;
    TEST_ASSERT_TRUE(hal_nvm_memory_read(&memory, at, &word, 1));
    return word;
}

static void erase(uint32_t at) {
    uint32_t calls = 1;
    while (hal_nvm_memory_erase(&memory, at) == HAL_NVM_BUSY) {
        calls++;
    }
    TEST_ASSERT_EQUAL_UINT32(NVM_MPS2_BLOCK_WORDS / NVM_MPS2_ERASE_WORDS, calls);
}

static void test_no_zero_is_programmed_to_a_one(void) {
    const uint32_t some[3] = {1, UINT32_MAX, 3};
    const uint32_t two = 2;
    memory.words[1026] = 5; // what the machine left there
    TEST_ASSERT_EQUAL(HAL_NVM_FAILED, hal_nvm_memory_program(&memory, 1024, some, 3));
    TEST_ASSERT_EQUAL_HEX32(5, word_at(1026));
    memory.words[1023] = 6;
    memory.words[2048] = 7;
    erase(1024);
    TEST_ASSERT_EQUAL_HEX32(6, word_at(1023));
    TEST_ASSERT_EQUAL_HEX32(UINT32_MAX, word_at(1024));
    TEST_ASSERT_EQUAL_HEX32(UINT32_MAX, word_at(2047));
    TEST_ASSERT_EQUAL_HEX32(7, word_at(2048));
    TEST_ASSERT_EQUAL(HAL_NVM_DONE, hal_nvm_memory_program(&memory, 1024, some, 3));
    TEST_ASSERT_EQUAL_HEX32(3, word_at(1026));
    TEST_ASSERT_EQUAL(HAL_NVM_DONE, hal_nvm_memory_program(&memory, 1026, some, 1)); // bit 1 goes
    TEST_ASSERT_EQUAL_HEX32(1, word_at(1026));
    TEST_ASSERT_EQUAL(HAL_NVM_FAILED, hal_nvm_memory_program(&memory, 1026, &two, 1));
    TEST_ASSERT_EQUAL_HEX32(1, word_at(1026));
    TEST_ASSERT_EQUAL(HAL_NVM_DONE, hal_nvm_memory_program(&memory, 1025, some, 1)); // all ones
}

static void test_what_is_outside_is_refused(void) {
    TEST_ASSERT_FALSE(hal_nvm_memory_read(&memory, NVM_MPS2_WORDS - 1u, words, 2));
    TEST_ASSERT_FALSE(hal_nvm_memory_read(&memory, UINT32_MAX, words, 2));
    TEST_ASSERT_EQUAL(HAL_NVM_FAILED, hal_nvm_memory_erase(&memory, 1));
    TEST_ASSERT_EQUAL(HAL_NVM_FAILED, hal_nvm_memory_erase(&memory, NVM_MPS2_WORDS));
    TEST_ASSERT_EQUAL(HAL_NVM_FAILED,
                      hal_nvm_memory_program(&memory, NVM_MPS2_WORDS - 1u, words, 2));
    TEST_ASSERT_EQUAL(HAL_NVM_FAILED,
                      hal_nvm_memory_program(&memory, 0, words, HAL_NVM_SLICE_WORDS + 1u));
}

static void test_records_fit_and_are_found_again(void) {
    hal_nvm_t nvm;
    uint32_t count = 0;
    TEST_ASSERT_TRUE(nvm_records_open(&nvm, &memory, 0));
    for (uint32_t record = 0; record < HAL_NVM_RECORDS; record++) {
        (void)hal_nvm_read(&nvm, record, words, HAL_NVM_MAX_WORDS, &count);
        words[0] = record;
        words[HAL_NVM_MAX_WORDS - 1u] = ~record;
        TEST_ASSERT_TRUE(hal_nvm_begin(&nvm, record, words, HAL_NVM_MAX_WORDS));
        while (hal_nvm_work(&nvm) == HAL_NVM_BUSY) {
        }
    }
    TEST_ASSERT_TRUE(nvm_records_open(&nvm, &memory, 0));
    for (uint32_t record = 0; record < HAL_NVM_RECORDS; record++) {
        TEST_ASSERT_EQUAL(HAL_NVM_KEPT,
                          hal_nvm_read(&nvm, record, words, HAL_NVM_MAX_WORDS, &count));
        TEST_ASSERT_EQUAL_UINT32(HAL_NVM_MAX_WORDS, count);
        TEST_ASSERT_EQUAL_HEX32(record, words[0]);
        TEST_ASSERT_EQUAL_HEX32(~record, words[HAL_NVM_MAX_WORDS - 1u]);
    }
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(test_no_zero_is_programmed_to_a_one);
    RUN_TEST(test_what_is_outside_is_refused);
    RUN_TEST(test_records_fit_and_are_found_again);
    return UNITY_END();
}
