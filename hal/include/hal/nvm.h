/// Non-volatile memory: a few records by number, each replaced as a whole or not at all, whatever
/// moment the power goes.
///
/// Writing is sliced: hal_nvm_begin, then hal_nvm_work once a tick or in idle time until it is done
/// or has failed; until then a start finds the record before it. What a number means is the
/// target's: room is for parameters, a law's and a tracker's table, what was learnt, faults and
/// calibration.
#ifndef HAL_NVM_H
#define HAL_NVM_H

#include <stdbool.h>
#include <stdint.h>

#define HAL_NVM_RECORDS 6u
#define HAL_NVM_MAX_WORDS 2048u ///< of a record
/// Most that hal_nvm_work writes in a call.
#define HAL_NVM_SLICE_WORDS 16u

typedef struct hal_nvm hal_nvm_t;

typedef enum {
    HAL_NVM_NONE = 0,  ///< never written
    HAL_NVM_KEPT = 1,  ///< what was written last
    HAL_NVM_OLDER = 2, ///< perhaps the one before: a later one is damaged, or was cut off
    HAL_NVM_LOST = 3,  ///< damaged, or another owner's
} hal_nvm_found_t;

typedef enum {
    HAL_NVM_IDLE = 0, ///< nothing is being written
    HAL_NVM_BUSY = 1,
    HAL_NVM_DONE = 2,
    HAL_NVM_FAILED = 3,
} hal_nvm_progress_t;

/// Reads a record, 0 .. HAL_NVM_RECORDS - 1, into words, of which there are room; they may be
/// overwritten whatever is found. A longer record is LOST to who reads so. *count: of words; 0
/// where there is none. Takes as long as the record's CRC, so at the start; not while hal_nvm_work
/// is busy.
hal_nvm_found_t hal_nvm_read(hal_nvm_t *nvm, uint32_t record, uint32_t *words, uint32_t room,
                             uint32_t *count);

/// Begins to replace a record; count 0: from then on it has no words. words: the caller's,
/// unchanged until it is done or has failed. Returns false iff a write is under way, there is no
/// such record, it has not been read since the start, or count is above HAL_NVM_MAX_WORDS.
bool hal_nvm_begin(hal_nvm_t *nvm, uint32_t record, const uint32_t *words, uint32_t count);

/// One slice. DONE and FAILED are told once. After FAILED the record is the one before, or the new
/// one where the very last word is what failed. Some writes erase first, which takes longer.
hal_nvm_progress_t hal_nvm_work(hal_nvm_t *nvm);

/// Times that a record was written; one that was cut off may count.
uint32_t hal_nvm_writes(const hal_nvm_t *nvm, uint32_t record);

/// The memory's wear: times that a half of it was erased, the two halves in turn. Those that were
/// cut off do not count.
uint32_t hal_nvm_erases(const hal_nvm_t *nvm);

#endif
