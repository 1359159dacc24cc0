/// Flash without ECC, as an STM32F4 has it, and its owner's bad luck: hal/nvm_memory.h with rules
/// that end the test, and a power cut at any operation, which is a word programmed or a block
/// erased.
///
/// A bit that was being programmed or erased when the power went may be weak: each read finds it
/// otherwise, until it is programmed to zero or its block is erased.
#ifndef FLASH_MODEL_H
#define FLASH_MODEL_H

#include "hal/nvm_memory.h"

#define FLASH_MOST_WORDS (2u * 15u * 1024u)
#define FLASH_NEVER UINT32_MAX

/// What a cut leaves of the operation that it cuts.
typedef enum {
    FLASH_NOTHING, ///< it has not begun
    FLASH_ALL,     ///< it was complete
    FLASH_SOME,    ///< of the bits that change some have, the others have not
    FLASH_WEAK,    ///< all bits that change are weak
    FLASH_MIXED,   ///< each of them is as it was, as it was to be, or weak
    FLASH_BEGUN,   ///< one bit is weak, the others have not changed
    FLASH_NEARLY,  ///< one bit is weak, the others have changed
    FLASH_TORN,    ///< kinds of tearing
} flash_torn_t;

struct hal_nvm_memory {
    uint32_t words[FLASH_MOST_WORDS];
    uint32_t weak[FLASH_MOST_WORDS]; ///< bits
    uint32_t size;
    uint32_t block_words;
    uint32_t seed; ///< of what weak bits read as

    uint32_t operations; ///< so far
    uint32_t cut_at;     ///< the operation of that number, from 0; FLASH_NEVER
    flash_torn_t torn;
    bool is_off; ///< nothing changes any more

    uint32_t bad_word; ///< keeps its lowest bit; FLASH_NEVER
    bool is_unreadable;
    uint32_t busy; ///< calls of the step that is under way
    uint32_t busy_at;
};

/// Every word is content.
void flash_make(hal_nvm_memory_t *it, uint32_t size, uint32_t block_words, uint32_t content);

/// The power comes back, or stays: no cut from here on.
void flash_power_up(hal_nvm_memory_t *it);

/// The power goes at the operation after that many others.
void flash_cut_after(hal_nvm_memory_t *it, uint32_t operations, flash_torn_t torn);

#endif
