/// What the image keeps over a power-up: the node's records (keeper.h) in non-volatile memory
/// (hal/nvm.h).
#ifndef KEPT_H
#define KEPT_H

#include "keeper.h"
#include "nvm_records.h"
#include "quiesce.h"

typedef struct {
    hal_nvm_t nvm;
    uint32_t shipped_hash; ///< of the parameters that ship, and of what they mean
    keeper_state_t state;  ///< of the record that was read last
    bool is_writing;
    uint32_t params[1u + QUIESCE_PARAM_COUNT]; ///< that are being written
} kept_t;

/// memory: the caller's, for as long as kept is used. board: NULL where parameters say what is
/// wired; another one's records are not used. shipped: the parameters of a start that has none of
/// its own.
void kept_open(kept_t *kept, hal_nvm_memory_t *memory, const quiesce_board_t *board,
               const quiesce_params_t *shipped);

/// Reads a record, at the start, into words, of which there are room. Returns their number, 0 where
/// there is none.
uint32_t kept_read(kept_t *kept, keeper_record_t record, uint32_t *words, uint32_t room);

/// Times that it was written; after kept_read.
uint32_t kept_writes(const kept_t *kept, keeper_record_t record);

/// The parameters that were saved, not checked. Returns false iff there are none, or those that
/// ship are others than when they were saved: who builds an image with other ones means them.
bool kept_read_params(kept_t *kept, quiesce_params_t *params);

/// A keeper_store_t; context: the kept_t. Parameters are copied, other words are read until they
/// are stored. Only for records that have been read.
keeper_answer_t kept_store(void *context, keeper_record_t record, const uint32_t *words,
                           uint32_t count);

/// A slice of what is being written, in idle time. DONE and FAILED are told once.
hal_nvm_progress_t kept_work(kept_t *kept);

#endif
