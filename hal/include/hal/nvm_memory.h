/// Memory that hal/nvm.h keeps its records in: an area of flash, or what behaves like it. Erased
/// words are all ones; programming turns ones into zeros, also in a word that has been programmed
/// before (flash without ECC); only whole blocks are erased.
///
/// A backend defines struct hal_nvm_memory. Places are words from the area's begin. Erasing and
/// programming may take several calls: while they return HAL_NVM_BUSY they are called again with
/// the same arguments, and nothing else is. Each call is bounded.
#ifndef HAL_NVM_MEMORY_H
#define HAL_NVM_MEMORY_H

#include "hal/nvm.h"

typedef struct hal_nvm_memory hal_nvm_memory_t;

/// Size of the area, and of a block, in words; they do not change.
uint32_t hal_nvm_memory_words(const hal_nvm_memory_t *memory);
uint32_t hal_nvm_memory_block_words(const hal_nvm_memory_t *memory);

/// Returns false iff the memory refuses.
bool hal_nvm_memory_read(hal_nvm_memory_t *memory, uint32_t at, uint32_t *words, uint32_t count);

/// Erases the block that begins there. Returns BUSY, DONE or FAILED.
hal_nvm_progress_t hal_nvm_memory_erase(hal_nvm_memory_t *memory, uint32_t at);

/// Programs up to HAL_NVM_SLICE_WORDS words, in their order; at and all but the last count of a
/// record are multiples of 4. Returns BUSY, DONE, or FAILED: a zero would have to become a one, and
/// none has been programmed, or the memory refused.
hal_nvm_progress_t hal_nvm_memory_program(hal_nvm_memory_t *memory, uint32_t at,
                                          const uint32_t *words, uint32_t count);

#endif
