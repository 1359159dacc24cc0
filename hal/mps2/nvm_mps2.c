#include "nvm_mps2.h"

#define ERASED UINT32_MAX

uint32_t hal_nvm_memory_words(const hal_nvm_memory_t *memory) {
    (void)memory;
    return NVM_MPS2_WORDS;
}

uint32_t hal_nvm_memory_block_words(const hal_nvm_memory_t *memory) {
    (void)memory;
    return NVM_MPS2_BLOCK_WORDS;
}

static bool is_inside(uint32_t at, uint32_t count) {
    return at <= NVM_MPS2_WORDS && count <= NVM_MPS2_WORDS - at;
}

bool hal_nvm_memory_read(hal_nvm_memory_t *memory, uint32_t at, uint32_t *words, uint32_t count) {
    if (!is_inside(at, count)) {
        return false;
    }
    for (uint32_t i = 0; i < count; i++) {
        words[i] = memory->words[at + i];
    }
    return true;
}

hal_nvm_progress_t hal_nvm_memory_erase(hal_nvm_memory_t *memory, uint32_t at) {
    if (at % NVM_MPS2_BLOCK_WORDS != 0u || !is_inside(at, NVM_MPS2_BLOCK_WORDS)) {
        return HAL_NVM_FAILED;
    }
    for (uint32_t i = 0; i < NVM_MPS2_ERASE_WORDS; i++) {
        memory->words[at + memory->erased + i] = ERASED;
    }
    memory->erased = (memory->erased + NVM_MPS2_ERASE_WORDS) % NVM_MPS2_BLOCK_WORDS;
    return memory->erased == 0u ? HAL_NVM_DONE : HAL_NVM_BUSY;
}

hal_nvm_progress_t hal_nvm_memory_program(hal_nvm_memory_t *memory, uint32_t at,
                                          const uint32_t *words, uint32_t count) {
    if (count > HAL_NVM_SLICE_WORDS || !is_inside(at, count)) {
        return HAL_NVM_FAILED;
    }
    for (uint32_t i = 0; i < count; i++) {
        if ((memory->words[at + i] & words[i]) != words[i]) {
            return HAL_NVM_FAILED;
        }
    }
    for (uint32_t i = 0; i < count; i++) {
        memory->words[at + i] = words[i];
    }
    return HAL_NVM_DONE;
}
