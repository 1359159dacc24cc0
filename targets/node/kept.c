#include "kept.h"

#include "can_node.h"
#include "table_file.h"

_Static_assert((uint32_t)KEEPER_RECORDS <= HAL_NVM_RECORDS, "a record for each of the node's");
_Static_assert(QUIESCE_TABLE_WORDS <= HAL_NVM_MAX_WORDS, "the longest table fits");

void kept_open(kept_t *kept, hal_nvm_memory_t *memory, const quiesce_board_t *board,
               const quiesce_params_t *shipped) {
    kept->shipped_hash = can_node_param_hash(shipped) ^ QUIESCE_PARAM_LAYOUT;
    kept->is_writing = false;
    (void)nvm_records_open(&kept->nvm, memory, table_file_board(board));
}

static keeper_state_t state_of(hal_nvm_found_t found) {
    switch (found) {
    case HAL_NVM_OLDER:
        return KEEPER_OLDER;
    case HAL_NVM_LOST:
        return KEEPER_LOST;
    case HAL_NVM_NONE:
    case HAL_NVM_KEPT:
    default:
        return KEEPER_WHOLE;
    }
}

uint32_t kept_read(kept_t *kept, keeper_record_t record, uint32_t *words, uint32_t room) {
    uint32_t count;
    kept->state = state_of(hal_nvm_read(&kept->nvm, (uint32_t)record, words, room, &count));
    return count;
}

uint32_t kept_writes(const kept_t *kept, keeper_record_t record) {
    return hal_nvm_writes(&kept->nvm, (uint32_t)record);
}

static void copy(uint32_t *to, const uint32_t *from, uint32_t count) {
    for (uint32_t i = 0; i < count; i++) {
        to[i] = from[i];
    }
}

// Parameters come after the hash of those that ship.
bool kept_read_params(kept_t *kept, quiesce_params_t *params) {
    if (kept_read(kept, KEEPER_PARAMS, kept->params, 1u + QUIESCE_PARAM_COUNT) !=
            1u + QUIESCE_PARAM_COUNT ||
        kept->params[0] != kept->shipped_hash) {
        return false;
    }
    copy((uint32_t *)(void *)params, &kept->params[1], QUIESCE_PARAM_COUNT);
    return true;
}

static keeper_answer_t begin(kept_t *kept, keeper_record_t record, const uint32_t *words,
                             uint32_t count) {
    kept->is_writing = hal_nvm_begin(&kept->nvm, (uint32_t)record, words, count);
    return kept->is_writing ? KEEPER_BEGUN : KEEPER_FAILED;
}

keeper_answer_t kept_store(void *context, keeper_record_t record, const uint32_t *words,
                           uint32_t count) {
    kept_t *const kept = context;
    if (kept->is_writing) {
        return KEEPER_BUSY;
    }
    if (record != KEEPER_PARAMS) {
        return begin(kept, record, words, count);
    }
    if (count > QUIESCE_PARAM_COUNT) {
        return KEEPER_FAILED;
    }
    kept->params[0] = kept->shipped_hash;
    copy(&kept->params[1], words, count);
    return begin(kept, record, kept->params, 1u + count);
}

hal_nvm_progress_t kept_work(kept_t *kept) {
    const hal_nvm_progress_t progress = hal_nvm_work(&kept->nvm);
    kept->is_writing = progress == HAL_NVM_BUSY;
    return progress;
}
