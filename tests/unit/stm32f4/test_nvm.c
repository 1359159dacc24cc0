// Flash on fakes: what RM0090 says of its controller, and what goes wrong with it.
#include "fake_flash.h"
#include "fake_registers.h"
#include "nvm_records.h"
#include "nvm_stm32f4.h"
#include "stm32f4_flash.h"
#include "unity.h"

#include <string.h>

#define OWNER 7u
#define MOST_CALLS 5000u
#define BLOCK_WORDS 0x8000u ///< of the records
#define WORDS (2u * BLOCK_WORDS)
#define SLOT_WORDS 0x7000u

static hal_nvm_memory_t memory;
static hal_nvm_t nvm;
static uint32_t words[HAL_NVM_MAX_WORDS];
static hal_nvm_progress_t erase_block(uint32_t at) {
    hal_nvm_progress_t progress = HAL_NVM_BUSY;
    for (uint32_t i = 0; i < MOST_CALLS && progress == HAL_NVM_BUSY; i++) {
        progress = hal_nvm_memory_erase(&memory, at);
    }
    return progress;
}

void setUp(void) {
    fake_reset(FAKE_F405);
    fake_flash_reset(6, 7);
    fake_use_hook(fake_flash_behave);
    memory = (hal_nvm_memory_t){.area = &nvm_stm32f4_records, .may_erase = true};
}

void tearDown(void) {
    TEST_ASSERT_NULL_MESSAGE(fake_mistake(), fake_mistake());
    fake_flash_assert_at_rest();
}

static void test_a_sector_is_erased_looked_at_and_programmed(void) {
    const uint32_t some[3] = {0x12345678u, 0, 0xFFFF0000u};
    uint32_t back[3];
    TEST_ASSERT_EQUAL(HAL_NVM_DONE, erase_block(BLOCK_WORDS));
    TEST_ASSERT_EQUAL_UINT32(1, fake_flash_state.erased_sectors);
    TEST_ASSERT_EQUAL_HEX32(0, fake_flash[(fake_flash_sectors[6] - FAKE_FLASH_BASE) / 4u]);
    TEST_ASSERT_EQUAL(HAL_NVM_DONE, hal_nvm_memory_program(&memory, BLOCK_WORDS, some, 3));
    TEST_ASSERT_TRUE(hal_nvm_memory_read(&memory, BLOCK_WORDS, back, 3));
    TEST_ASSERT_EQUAL_HEX32_ARRAY(some, back, 3);
    TEST_ASSERT_EQUAL(HAL_NVM_FAILED, // a zero would have to become a one
                      hal_nvm_memory_program(&memory, BLOCK_WORDS + 1u, some, 1));
}

// The processor stands still for up to two seconds.
static void test_an_erasure_waits_until_it_may(void) {
    memory.may_erase = false;
    for (uint32_t i = 0; i < 100u; i++) {
        TEST_ASSERT_EQUAL(HAL_NVM_BUSY, hal_nvm_memory_erase(&memory, 0));
    }
    TEST_ASSERT_EQUAL_UINT32(0, fake_flash_state.erased_sectors);
    TEST_ASSERT_EQUAL(NVM_STM32F4_WAITS, memory.phase);
    memory.may_erase = true;
    TEST_ASSERT_EQUAL(HAL_NVM_DONE, erase_block(0));
    TEST_ASSERT_EQUAL(NVM_STM32F4_IDLE, memory.phase);
}

static void test_errors_of_the_controller_fail(void) {
    static const uint32_t errors[] = {FLASH_SR_OPERR, FLASH_SR_WRPERR, FLASH_SR_PGAERR,
                                      FLASH_SR_PGPERR, FLASH_SR_PGSERR};
    const uint32_t word = 0;
    for (uint32_t i = 0; i < sizeof errors / sizeof errors[0]; i++) {
        fake_flash_state.error = errors[i];
        TEST_ASSERT_EQUAL(HAL_NVM_FAILED, erase_block(0));
        TEST_ASSERT_EQUAL(HAL_NVM_FAILED, hal_nvm_memory_program(&memory, 0, &word, 1));
        fake_flash_state.error = 0;
        // Of what was before nothing is left.
        TEST_ASSERT_EQUAL(HAL_NVM_DONE, erase_block(0));
    }
}

static void test_worn_flash_and_an_erasure_that_never_ends_fail(void) {
    const uint32_t word = 1;
    TEST_ASSERT_EQUAL(HAL_NVM_DONE, erase_block(0));
    fake_flash_state.worn_word = (fake_flash_sectors[6] - FAKE_FLASH_BASE) / 4u + 5u;
    TEST_ASSERT_EQUAL(HAL_NVM_FAILED, hal_nvm_memory_program(&memory, 5, &word, 1));
    fake_flash_state.busy_reads = UINT32_MAX;
    hal_nvm_progress_t progress = HAL_NVM_BUSY;
    for (uint32_t i = 0; i < 1100000u && progress == HAL_NVM_BUSY; i++) {
        progress = hal_nvm_memory_erase(&memory, 0);
    }
    TEST_ASSERT_EQUAL(HAL_NVM_FAILED, progress);
    fake_flash_state.left = 1; // it ends after all
    fake_flash_state.busy_reads = 3;
    TEST_ASSERT_EQUAL(HAL_NVM_DONE, erase_block(0));
}

static void test_what_is_outside_is_refused(void) {
    uint32_t word = 0;
    TEST_ASSERT_EQUAL(HAL_NVM_FAILED, hal_nvm_memory_erase(&memory, 1));
    TEST_ASSERT_EQUAL(HAL_NVM_FAILED, hal_nvm_memory_erase(&memory, WORDS));
    TEST_ASSERT_EQUAL(HAL_NVM_FAILED, hal_nvm_memory_program(&memory, WORDS, &word, 1));
    TEST_ASSERT_EQUAL(HAL_NVM_FAILED,
                      hal_nvm_memory_program(&memory, 0, words, HAL_NVM_SLICE_WORDS + 1u));
    TEST_ASSERT_FALSE(hal_nvm_memory_read(&memory, WORDS - 1u, words, 2));
    TEST_ASSERT_EQUAL_UINT32(0, fake_all_writes());
}

// Flash without a controller, as QEMU's machine has it.
static void test_without_a_controller_it_fails_and_does_not_hang(void) {
    const uint32_t word = 0;
    fake_absent();
    TEST_ASSERT_EQUAL(HAL_NVM_FAILED, erase_block(0));
    TEST_ASSERT_EQUAL(HAL_NVM_DONE, hal_nvm_memory_program(&memory, 0, &word, 1)); // it reads 0
    const uint32_t one = 1;
    TEST_ASSERT_EQUAL(HAL_NVM_FAILED, hal_nvm_memory_program(&memory, 0, &one, 1));
}

// Four sectors for the first image, one for the second, of which the end stays as it is.
static void test_an_image_has_all_sectors_of_its_slot(void) {
    const uint32_t word = 0x1234u;
    memory = (hal_nvm_memory_t){.area = &nvm_stm32f4_images, .may_erase = true};
    fake_flash_state.first_sector = 1;
    fake_flash_state.last_sector = 5;
    TEST_ASSERT_EQUAL_UINT32(2u * SLOT_WORDS, hal_nvm_memory_words(&memory));
    TEST_ASSERT_EQUAL(HAL_NVM_DONE, erase_block(0));
    TEST_ASSERT_EQUAL_UINT32(4, fake_flash_state.erased_sectors);
    TEST_ASSERT_EQUAL_HEX32(UINT32_MAX, fake_flash[0x7FFF]);
    TEST_ASSERT_EQUAL_HEX32(0, fake_flash[0x8000]);
    TEST_ASSERT_EQUAL_HEX32(0, fake_flash[0x0FFF]); // the boot code's sector
    TEST_ASSERT_EQUAL(HAL_NVM_DONE, hal_nvm_memory_program(&memory, SLOT_WORDS - 4u, &word, 1));
    TEST_ASSERT_EQUAL_HEX32(word, fake_flash[0x7FFC]);
    TEST_ASSERT_EQUAL(HAL_NVM_DONE, erase_block(SLOT_WORDS));
    TEST_ASSERT_EQUAL_UINT32(5, fake_flash_state.erased_sectors);
    TEST_ASSERT_EQUAL(HAL_NVM_DONE, hal_nvm_memory_program(&memory, SLOT_WORDS, &word, 1));
    TEST_ASSERT_EQUAL_HEX32(word, fake_flash[0x8000]);
    TEST_ASSERT_EQUAL_HEX32(word, fake_flash[0x7FFC]);
}

// The tick runs between two of them: each waits for leave.
static void test_leave_is_asked_for_each_sector(void) {
    memory = (hal_nvm_memory_t){.area = &nvm_stm32f4_images, .may_erase = true};
    fake_flash_state.first_sector = 1;
    fake_flash_state.last_sector = 4;
    TEST_ASSERT_EQUAL(HAL_NVM_BUSY, hal_nvm_memory_erase(&memory, 0));
    memory.may_erase = false;
    TEST_ASSERT_EQUAL(HAL_NVM_BUSY, erase_block(0));
    TEST_ASSERT_EQUAL_UINT32(1, fake_flash_state.erased_sectors);
    TEST_ASSERT_EQUAL(NVM_STM32F4_WAITS, memory.phase);
    memory.may_erase = true;
    TEST_ASSERT_EQUAL(HAL_NVM_DONE, erase_block(0));
    TEST_ASSERT_EQUAL_UINT32(4, fake_flash_state.erased_sectors);
}

static void save(uint32_t value) {
    words[0] = value;
    TEST_ASSERT_TRUE(hal_nvm_begin(&nvm, 2, words, 1));
    hal_nvm_progress_t progress = HAL_NVM_BUSY;
    for (uint32_t i = 0; i < MOST_CALLS && progress == HAL_NVM_BUSY; i++) {
        progress = hal_nvm_work(&nvm);
    }
    TEST_ASSERT_EQUAL(HAL_NVM_DONE, progress);
}

static uint32_t restart(void) {
    uint32_t count = 0;
    memory = (hal_nvm_memory_t){.area = &nvm_stm32f4_records, .may_erase = true};
    TEST_ASSERT_TRUE(nvm_records_open(&nvm, &memory, OWNER));
    for (uint32_t i = 0; i < HAL_NVM_RECORDS; i++) {
        (void)hal_nvm_read(&nvm, i, words, HAL_NVM_MAX_WORDS, &count);
    }
    (void)hal_nvm_read(&nvm, 2, words, HAL_NVM_MAX_WORDS, &count);
    return count == 1u ? words[0] : 0u;
}

static void test_records_come_back_after_a_power_up(void) {
    (void)restart();
    for (uint32_t value = 1; value < 40u; value++) {
        save(value);
        TEST_ASSERT_EQUAL_UINT32(value, restart());
    }
    TEST_ASSERT_EQUAL_UINT32(1, fake_flash_state.erased_sectors);
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(test_a_sector_is_erased_looked_at_and_programmed);
    RUN_TEST(test_an_erasure_waits_until_it_may);
    RUN_TEST(test_errors_of_the_controller_fail);
    RUN_TEST(test_worn_flash_and_an_erasure_that_never_ends_fail);
    RUN_TEST(test_what_is_outside_is_refused);
    RUN_TEST(test_without_a_controller_it_fails_and_does_not_hang);
    RUN_TEST(test_an_image_has_all_sectors_of_its_slot);
    RUN_TEST(test_leave_is_asked_for_each_sector);
    RUN_TEST(test_records_come_back_after_a_power_up);
    return UNITY_END();
}
