/// hal/nvm_memory.h on two sectors of flash of 128 KiB each, which every STM32F4 of 512 KiB and
/// more has at the same place. The processor stands still while a sector is erased, up to 2 s,
/// since its code is in the same flash: an erasure waits until the image allows it. Untested on
/// silicon; what to measure: docs/howto/stm32f4.md.
#ifndef NVM_STM32F4_H
#define NVM_STM32F4_H

#include "hal/nvm_memory.h"

#define NVM_STM32F4_BASE 0x08040000u
#define NVM_STM32F4_SECTOR 6u ///< the first of them
#define NVM_STM32F4_BLOCK_WORDS 0x8000u
#define NVM_STM32F4_WORDS (2u * NVM_STM32F4_BLOCK_WORDS)
/// Of an erased sector, that a call looks at.
#define NVM_STM32F4_LOOK_WORDS 1024u

typedef enum {
    NVM_STM32F4_IDLE = 0,
    NVM_STM32F4_WAITS,  ///< for may_erase
    NVM_STM32F4_ERASES, ///< begun
    NVM_STM32F4_LOOKS,  ///< whether all of it is erased
} nvm_stm32f4_phase_t;

struct hal_nvm_memory {
    bool may_erase; ///< set by the image, where it can stand still: outputs off, watchdog told
    nvm_stm32f4_phase_t phase;
    uint32_t polls; ///< of this erasure
    uint32_t looked_words;
};

#endif
