// Flash on fakes: what RM0090 says of its controller, and what goes wrong with it.
#include "fake_registers.h"
#include "nvm_records.h"
#include "nvm_stm32f4.h"
#include "stm32f4_flash.h"
#include "unity.h"

#include <string.h>

#define KEYR (FLASH_BASE + FLASH_KEYR)
#define SR (FLASH_BASE + FLASH_SR)
#define CR (FLASH_BASE + FLASH_CR)
#define OWNER 7u
#define MOST_CALLS 5000u

static hal_nvm_memory_t memory;
static hal_nvm_t nvm;
static uint32_t words[HAL_NVM_MAX_WORDS];
static uint32_t last_key;
static uint32_t erased_sectors;
static uint32_t busy_reads; ///< of SR, that an erasure takes
static uint32_t left;
static uint32_t error;     ///< flags that the next operation sets
static uint32_t worn_word; ///< that no longer takes a zero
static uint32_t unready;   ///< writes to flash that no PG allowed

static void erase(uint32_t cr) {
    const uint32_t sector = (cr & FLASH_CR_SNB) >> FLASH_CR_SNB_AT;
    TEST_ASSERT_EQUAL_UINT32(2u, (cr & FLASH_CR_PSIZE) >> FLASH_CR_PSIZE_AT);
    TEST_ASSERT_TRUE(sector == 6u || sector == 7u); // the code is in the others
    TEST_ASSERT_BITS_HIGH(FLASH_CR_SER, cr);
    TEST_ASSERT_BITS_LOW(FLASH_CR_MER, cr);
    memset(&fake_flash[(sector - 6u) * NVM_STM32F4_BLOCK_WORDS], 0xFF,
           4u * NVM_STM32F4_BLOCK_WORDS);
    erased_sectors++;
    left = busy_reads;
    fake_set(CR, cr & ~FLASH_CR_STRT);
    fake_set(SR, FLASH_SR_BSY | error);
}

// RM0090 Rev 4, page 67, and section 3.5.1: keys unlock, a write with PG programs, STRT with SER
// erases; BSY while it lasts.
static void work(uint32_t address, bool is_write, uint32_t value) {
    if (address == KEYR && is_write) {
        if (last_key == 0x45670123u && value == 0xCDEF89ABu) {
            fake_set(CR, fake_get(CR) & ~FLASH_CR_LOCK);
        }
        last_key = value;
    } else if (address == CR && is_write && (value & FLASH_CR_STRT) != 0u) {
        erase(value);
    } else if (address == SR && !is_write && (fake_get(SR) & FLASH_SR_BSY) != 0u) {
        left -= left > 0u ? 1u : 0u;
        fake_set(SR, left > 0u ? fake_get(SR) : fake_get(SR) & ~FLASH_SR_BSY);
    } else if (address >= FAKE_FLASH_BASE && address < FAKE_FLASH_BASE + sizeof fake_flash) {
        const uint32_t at = (address - FAKE_FLASH_BASE) / 4u;
        const bool may = (fake_get(CR) & (FLASH_CR_PG | FLASH_CR_LOCK)) == FLASH_CR_PG;
        unready += may ? 0u : 1u;
        fake_flash[at] &= may && at != worn_word ? value : UINT32_MAX;
        fake_set(SR, fake_get(SR) | error);
    }
}

static hal_nvm_progress_t erase_block(uint32_t at) {
    hal_nvm_progress_t progress = HAL_NVM_BUSY;
    for (uint32_t i = 0; i < MOST_CALLS && progress == HAL_NVM_BUSY; i++) {
        progress = hal_nvm_memory_erase(&memory, at);
    }
    return progress;
}

void setUp(void) {
    fake_reset(FAKE_F405);
    fake_use_hook(work);
    memset(fake_flash, 0, sizeof fake_flash);
    memory = (hal_nvm_memory_t){.may_erase = true};
    last_key = erased_sectors = error = unready = 0;
    busy_reads = 3;
    worn_word = UINT32_MAX;
}

void tearDown(void) {
    TEST_ASSERT_NULL_MESSAGE(fake_mistake(), fake_mistake());
    TEST_ASSERT_EQUAL_UINT32(0, unready);
    TEST_ASSERT_BITS_HIGH(FLASH_CR_LOCK, fake_get(CR)); // left locked
}

static void test_a_sector_is_erased_looked_at_and_programmed(void) {
    const uint32_t some[3] = {0x12345678u, 0, 0xFFFF0000u};
    uint32_t back[3];
    TEST_ASSERT_EQUAL(HAL_NVM_DONE, erase_block(NVM_STM32F4_BLOCK_WORDS));
    TEST_ASSERT_EQUAL_UINT32(1, erased_sectors);
    TEST_ASSERT_EQUAL_HEX32(0, fake_flash[0]);
    TEST_ASSERT_EQUAL(HAL_NVM_DONE,
                      hal_nvm_memory_program(&memory, NVM_STM32F4_BLOCK_WORDS, some, 3));
    TEST_ASSERT_TRUE(hal_nvm_memory_read(&memory, NVM_STM32F4_BLOCK_WORDS, back, 3));
    TEST_ASSERT_EQUAL_HEX32_ARRAY(some, back, 3);
    TEST_ASSERT_EQUAL(HAL_NVM_FAILED, // a zero would have to become a one
                      hal_nvm_memory_program(&memory, NVM_STM32F4_BLOCK_WORDS + 1u, some, 1));
}

// The processor stands still for up to two seconds.
static void test_an_erasure_waits_until_it_may(void) {
    memory.may_erase = false;
    for (uint32_t i = 0; i < 100u; i++) {
        TEST_ASSERT_EQUAL(HAL_NVM_BUSY, hal_nvm_memory_erase(&memory, 0));
    }
    TEST_ASSERT_EQUAL_UINT32(0, erased_sectors);
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
        error = errors[i];
        TEST_ASSERT_EQUAL(HAL_NVM_FAILED, erase_block(0));
        TEST_ASSERT_EQUAL(HAL_NVM_FAILED, hal_nvm_memory_program(&memory, 0, &word, 1));
        error = 0;
        TEST_ASSERT_EQUAL(HAL_NVM_DONE, erase_block(0)); // of what was before nothing is left
    }
}

static void test_worn_flash_and_an_erasure_that_never_ends_fail(void) {
    const uint32_t word = 1;
    TEST_ASSERT_EQUAL(HAL_NVM_DONE, erase_block(0));
    worn_word = 5;
    TEST_ASSERT_EQUAL(HAL_NVM_FAILED, hal_nvm_memory_program(&memory, 5, &word, 1));
    busy_reads = UINT32_MAX;
    hal_nvm_progress_t progress = HAL_NVM_BUSY;
    for (uint32_t i = 0; i < 1100000u && progress == HAL_NVM_BUSY; i++) {
        progress = hal_nvm_memory_erase(&memory, 0);
    }
    TEST_ASSERT_EQUAL(HAL_NVM_FAILED, progress);
    left = 1; // it ends after all
    busy_reads = 3;
    TEST_ASSERT_EQUAL(HAL_NVM_DONE, erase_block(0));
}

static void test_what_is_outside_is_refused(void) {
    uint32_t word = 0;
    TEST_ASSERT_EQUAL(HAL_NVM_FAILED, hal_nvm_memory_erase(&memory, 1));
    TEST_ASSERT_EQUAL(HAL_NVM_FAILED, hal_nvm_memory_erase(&memory, NVM_STM32F4_WORDS));
    TEST_ASSERT_EQUAL(HAL_NVM_FAILED, hal_nvm_memory_program(&memory, NVM_STM32F4_WORDS, &word, 1));
    TEST_ASSERT_EQUAL(HAL_NVM_FAILED,
                      hal_nvm_memory_program(&memory, 0, words, HAL_NVM_SLICE_WORDS + 1u));
    TEST_ASSERT_FALSE(hal_nvm_memory_read(&memory, NVM_STM32F4_WORDS - 1u, words, 2));
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
    memory = (hal_nvm_memory_t){.may_erase = true};
    TEST_ASSERT_TRUE(nvm_records_open(&nvm, &memory, OWNER));
    for (uint32_t i = 0; i < HAL_NVM_RECORDS; i++) {
        (void)hal_nvm_read(&nvm, i, words, &count);
    }
    (void)hal_nvm_read(&nvm, 2, words, &count);
    return count == 1u ? words[0] : 0u;
}

static void test_records_come_back_after_a_power_up(void) {
    (void)restart();
    for (uint32_t value = 1; value < 40u; value++) {
        save(value);
        TEST_ASSERT_EQUAL_UINT32(value, restart());
    }
    TEST_ASSERT_EQUAL_UINT32(1, erased_sectors);
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(test_a_sector_is_erased_looked_at_and_programmed);
    RUN_TEST(test_an_erasure_waits_until_it_may);
    RUN_TEST(test_errors_of_the_controller_fail);
    RUN_TEST(test_worn_flash_and_an_erasure_that_never_ends_fail);
    RUN_TEST(test_what_is_outside_is_refused);
    RUN_TEST(test_without_a_controller_it_fails_and_does_not_hang);
    RUN_TEST(test_records_come_back_after_a_power_up);
    return UNITY_END();
}
