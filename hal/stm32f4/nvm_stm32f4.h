/// hal/nvm_memory.h on two blocks of flash, each of some sectors in a row. The processor stands
/// still while a sector is erased, up to 2 s, since its code is in the same flash: an erasure waits
/// until the image allows it. Untested on silicon; what to measure: docs/howto/stm32f4.md.
///
/// Every STM32F4 of 512 KiB and more has its sectors at the same places: 0 for the boot code, 1 to
/// 4 and 5 for an image each (slots.h), 6 and 7 for records.
#ifndef NVM_STM32F4_H
#define NVM_STM32F4_H

#include "hal/nvm_memory.h"

/// Of an erased block, that a call looks at.
#define NVM_STM32F4_LOOK_WORDS 1024u
#define NVM_STM32F4_BLOCKS 2u

typedef struct {
    uint32_t block_words; ///< of both; a multiple of NVM_STM32F4_LOOK_WORDS
    struct {
        uint32_t begin; ///< address
        uint8_t sector; ///< the first of them
        uint8_t sectors;
    } block[NVM_STM32F4_BLOCKS];
} nvm_stm32f4_area_t;

extern const nvm_stm32f4_area_t nvm_stm32f4_records;
extern const nvm_stm32f4_area_t nvm_stm32f4_images;

/// The bytes of a block, to be read.
const uint8_t *nvm_stm32f4_bytes(const nvm_stm32f4_area_t *area, uint32_t block);

typedef enum {
    NVM_STM32F4_IDLE = 0,
    NVM_STM32F4_WAITS,  ///< for may_erase
    NVM_STM32F4_ERASES, ///< begun
    NVM_STM32F4_LOOKS,  ///< whether all of it is erased
} nvm_stm32f4_phase_t;

/// area: set by the image, all else zero.
struct hal_nvm_memory {
    const nvm_stm32f4_area_t *area;
    bool may_erase; ///< set by the image, where it can stand still: outputs off, watchdog told
    nvm_stm32f4_phase_t phase;
    uint32_t erased_sectors; ///< of the block
    uint32_t polls;          ///< of this erasure
    uint32_t looked_words;
};

#endif
