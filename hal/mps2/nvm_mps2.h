/// hal/nvm_memory.h in RAM that behaves like flash. QEMU keeps it in a file where it is told to
/// back the board's PSRAM with one (docs/reference/targets.md); else it lives as long as the
/// emulator. Start-up leaves it alone.
#ifndef NVM_MPS2_H
#define NVM_MPS2_H

#include "hal/nvm_memory.h"

/// The last 128 KiB of the 16 MiB of PSRAM, whose begin is the mailbox's (mailbox.h).
#define NVM_MPS2_BASE 0x21FE0000u
#define NVM_MPS2_WORDS 0x8000u
#define NVM_MPS2_BLOCK_WORDS 1024u
/// Most that a call erases.
#define NVM_MPS2_ERASE_WORDS 64u

struct hal_nvm_memory {
    volatile uint32_t *words; ///< NVM_MPS2_WORDS, set by the caller; a cut leaves what is written
    uint32_t erased;          ///< of the block that is being erased
};

#endif
