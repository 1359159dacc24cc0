#include "nvm_rig.h"

#include <string.h>

#include "unity.h"

void rig_make(nvm_rig_t *rig, uint32_t block_words, uint32_t content) {
    flash_make(&rig->memory, nvm_records_words(block_words), block_words, content);
    rig_start(rig);
}

void rig_start(nvm_rig_t *rig) {
    flash_power_up(&rig->memory);
    TEST_ASSERT_TRUE(nvm_records_open(&rig->nvm, &rig->memory, RIG_OWNER));
}

static void fill(uint32_t *words, uint32_t count, uint32_t key) {
    for (uint32_t i = 0; i < count; i++) {
        words[i] = (key * 2654435761u) ^ (i * 40503u) ^ count;
    }
}

hal_nvm_progress_t rig_try(nvm_rig_t *rig, uint32_t record, uint32_t count, uint32_t key) {
    static uint32_t words[HAL_NVM_MAX_WORDS];
    hal_nvm_progress_t step = HAL_NVM_BUSY;
    fill(words, count, key);
    TEST_ASSERT_TRUE(hal_nvm_begin(&rig->nvm, record, words, count));
    TEST_ASSERT_FALSE(hal_nvm_begin(&rig->nvm, record, words, count)); // one at a time
    for (uint32_t i = 0; i < 20000u && step == HAL_NVM_BUSY; i++) {
        step = hal_nvm_work(&rig->nvm);
    }
    TEST_ASSERT_TRUE(step == HAL_NVM_DONE || step == HAL_NVM_FAILED);
    TEST_ASSERT_EQUAL(HAL_NVM_IDLE, hal_nvm_work(&rig->nvm));
    return step;
}

void rig_write(nvm_rig_t *rig, uint32_t record, uint32_t count, uint32_t key) {
    TEST_ASSERT_EQUAL(HAL_NVM_DONE, rig_try(rig, record, count, key));
}

bool rig_has(nvm_rig_t *rig, uint32_t record, uint32_t count, uint32_t key,
             hal_nvm_found_t *found) {
    static uint32_t back[HAL_NVM_MAX_WORDS];
    static uint32_t words[HAL_NVM_MAX_WORDS];
    uint32_t found_count;
    memset(back, 0x5A, sizeof back);
    fill(words, count, key);
    *found = hal_nvm_read(&rig->nvm, record, back, HAL_NVM_MAX_WORDS, &found_count);
    return (*found == HAL_NVM_KEPT || *found == HAL_NVM_OLDER) && found_count == count &&
           memcmp(words, back, count * sizeof *words) == 0;
}

void rig_assert(nvm_rig_t *rig, hal_nvm_found_t found, uint32_t record, uint32_t count,
                uint32_t key) {
    hal_nvm_found_t told;
    TEST_ASSERT_TRUE(rig_has(rig, record, count, key, &told));
    TEST_ASSERT_EQUAL(found, told);
}

void rig_assert_nothing(nvm_rig_t *rig, hal_nvm_found_t found, uint32_t record) {
    static uint32_t back[HAL_NVM_MAX_WORDS];
    uint32_t count = 7;
    TEST_ASSERT_EQUAL(found, hal_nvm_read(&rig->nvm, record, back, HAL_NVM_MAX_WORDS, &count));
    TEST_ASSERT_EQUAL_UINT32(0, count);
}
