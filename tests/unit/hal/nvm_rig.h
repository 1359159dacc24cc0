/// A store on the model of flash, and records that tell themselves apart.
#ifndef NVM_RIG_H
#define NVM_RIG_H

#include "flash_model.h"
#include "nvm_records.h"

#define RIG_OWNER 5u

typedef struct {
    hal_nvm_memory_t memory;
    hal_nvm_t nvm;
} nvm_rig_t;

/// Memory that is just large enough.
void rig_make(nvm_rig_t *rig, uint32_t block_words, uint32_t content);

/// The power comes back: only the memory is left.
void rig_start(nvm_rig_t *rig);

/// Writes count words that no other key, place or count has, to the end or until the power goes.
/// Returns DONE or FAILED.
hal_nvm_progress_t rig_try(nvm_rig_t *rig, uint32_t record, uint32_t count, uint32_t key);

void rig_write(nvm_rig_t *rig, uint32_t record, uint32_t count, uint32_t key);

/// Reads a record and says whether it is that one, and how it was found.
bool rig_has(nvm_rig_t *rig, uint32_t record, uint32_t count, uint32_t key, hal_nvm_found_t *found);

void rig_assert(nvm_rig_t *rig, hal_nvm_found_t found, uint32_t record, uint32_t count,
                uint32_t key);
void rig_assert_nothing(nvm_rig_t *rig, hal_nvm_found_t found, uint32_t record);

#endif
