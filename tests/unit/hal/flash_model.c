#include "flash_model.h"

#include <string.h>

#include "unity.h"

#define ERASED UINT32_MAX

void flash_make(hal_nvm_memory_t *it, uint32_t size, uint32_t block_words, uint32_t content) {
    TEST_ASSERT_LESS_OR_EQUAL_UINT32(FLASH_MOST_WORDS, size);
    memset(it, 0, sizeof *it);
    it->size = size;
    it->block_words = block_words;
    it->seed = 1;
    it->bad_word = FLASH_NEVER;
    for (uint32_t i = 0; i < size; i++) {
        it->words[i] = content;
    }
    flash_power_up(it);
}

void flash_power_up(hal_nvm_memory_t *it) {
    it->is_off = false;
    it->cut_at = FLASH_NEVER;
    it->busy = 0;
}

void flash_cut_after(hal_nvm_memory_t *it, uint32_t operations, flash_torn_t torn) {
    it->cut_at = it->operations + operations;
    it->torn = torn;
}

// xorshift32
static uint32_t any(hal_nvm_memory_t *it) {
    it->seed ^= it->seed << 13;
    it->seed ^= it->seed >> 17;
    it->seed ^= it->seed << 5;
    return it->seed;
}

uint32_t hal_nvm_memory_words(const hal_nvm_memory_t *it) {
    return it->size;
}

uint32_t hal_nvm_memory_block_words(const hal_nvm_memory_t *it) {
    return it->block_words;
}

bool hal_nvm_memory_read(hal_nvm_memory_t *it, uint32_t at, uint32_t *words, uint32_t count) {
    TEST_ASSERT_TRUE(at < it->size && count <= it->size - at);
    for (uint32_t i = 0; i < count; i++) {
        const uint32_t weak = it->weak[at + i];
        words[i] = weak == 0u ? it->words[at + i] : (it->words[at + i] & ~weak) | (any(it) & weak);
    }
    return !it->is_unreadable;
}

static void put(hal_nvm_memory_t *it, uint32_t at, uint32_t word, uint32_t weak) {
    it->words[at] = word | (at == it->bad_word ? 1u : 0u);
    it->weak[at] = weak;
}

// Bits of the mask become those of to, or what the cut leaves of them.
static void change(hal_nvm_memory_t *it, uint32_t at, uint32_t to, uint32_t mask, bool is_cut) {
    const flash_torn_t torn = is_cut ? it->torn : FLASH_ALL;
    const uint32_t one = mask & (~mask + 1u); // of its bits
    const uint32_t done_of[FLASH_TORN] = {0, ERASED, any(it), 0, any(it), 0, ~one};
    const uint32_t weak_of[FLASH_TORN] = {0, 0, 0, ERASED, any(it), one, one};
    const uint32_t done = mask & done_of[torn];
    const uint32_t weak = mask & weak_of[torn] & ~done;
    put(it, at, (it->words[at] & ~done) | (to & done), (it->weak[at] & ~done) | weak);
}

// Returns whether this operation is the one that the power goes in.
static bool is_cut(hal_nvm_memory_t *it) {
    it->is_off = it->operations == it->cut_at;
    it->operations++;
    return it->is_off;
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

hal_nvm_progress_t hal_nvm_memory_erase(hal_nvm_memory_t *it, uint32_t at) {
    TEST_ASSERT_TRUE(at % it->block_words == 0u && at < it->size);
    if (it->is_off) {
        return HAL_NVM_FAILED;
    }
    if (is_busy(it, at)) {
        return HAL_NVM_BUSY;
    }
    const bool is_last = is_cut(it);
    for (uint32_t i = 0; i < it->block_words; i++) {
        change(it, at + i, ERASED, ERASED, is_last);
    }
    return is_last ? HAL_NVM_FAILED : HAL_NVM_DONE;
}

hal_nvm_progress_t hal_nvm_memory_program(hal_nvm_memory_t *it, uint32_t at, const uint32_t *words,
                                          uint32_t count) {
    TEST_ASSERT_TRUE(at % 4u == 0u && count > 0u && count <= HAL_NVM_SLICE_WORDS);
    TEST_ASSERT_TRUE(at < it->size && count <= it->size - at);
    if (it->is_off) {
        return HAL_NVM_FAILED;
    }
    if (is_busy(it, at)) {
        return HAL_NVM_BUSY;
    }
    for (uint32_t i = 0; i < count; i++) {
        if (((it->words[at + i] | it->weak[at + i]) & words[i]) != words[i]) {
            return HAL_NVM_FAILED; // a zero does not become a one
        }
    }
    for (uint32_t i = 0; i < count; i++) {
        const bool is_last = is_cut(it);
        const uint32_t ones = it->words[at + i] | it->weak[at + i];
        change(it, at + i, 0, ones & ~words[i], is_last);
        if (is_last) {
            return HAL_NVM_FAILED;
        }
    }
    return HAL_NVM_DONE;
}
