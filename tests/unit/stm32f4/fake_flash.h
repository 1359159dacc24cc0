/// The flash controller of an STM32F4 on fakes, and what goes wrong with it.
#ifndef FAKE_FLASH_H
#define FAKE_FLASH_H

#include "fake_registers.h"

#define FAKE_FLASH_SECTORS 8u

/// Where the sectors begin, and where the last one ends.
extern const uint32_t fake_flash_sectors[FAKE_FLASH_SECTORS + 1u];

typedef struct {
    uint32_t first_sector; ///< that may be erased: the code is in others
    uint32_t last_sector;
    uint32_t last_key;
    uint32_t erased_sectors; ///< so far
    uint32_t busy_reads;     ///< of SR, that an erasure takes
    uint32_t left;
    uint32_t error;     ///< flags that the next operation sets
    uint32_t worn_word; ///< that no longer takes a zero
    uint32_t unready;   ///< writes to flash that no PG allowed
} fake_flash_state_t;

extern fake_flash_state_t fake_flash_state;

/// All flash is programmed to zeros, and locked.
void fake_flash_reset(uint32_t first_sector, uint32_t last_sector);

/// A hook for fake_use_hook.
void fake_flash_behave(uint32_t address, bool is_write, uint32_t value);

/// It was left locked, and nothing was written without leave.
void fake_flash_assert_at_rest(void);

#endif
