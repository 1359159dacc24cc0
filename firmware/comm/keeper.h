/// What outlives a restart, by the target's non-volatile memory: one record after the other is
/// handed to it, and how that went is kept with the number of times that each was written.
#ifndef KEEPER_H
#define KEEPER_H

#include <stdbool.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

/// Numbers are on the disk of targets and are never reused.
typedef enum {
    KEEPER_PARAMS = 0,        ///< the words of quiesce_params_t
    KEEPER_LAW_TABLE = 1,     ///< of each of these: a table, without the head of its file
    KEEPER_TRACKER_TABLE = 2, ///< likewise
    KEEPER_LEARNT = 3,        ///< likewise: what was learnt (table_file.h)
    KEEPER_RECORDS
} keeper_record_t;

typedef enum {
    KEEPER_FAILED = 0,
    KEEPER_DONE = 1,
    KEEPER_BEGUN = 2, ///< keeper_stored will say how it went; the words are read until then
    KEEPER_BUSY = 3,  ///< ask again in the next tick
} keeper_answer_t;

/// What a start found of a record.
typedef enum {
    KEEPER_WHOLE = 0, ///< what was written last, or nothing was
    KEEPER_OLDER = 1, ///< one copy is damaged, or was cut off: perhaps it is the one before
    KEEPER_LOST = 2,  ///< damaged, or another board's: not used
} keeper_state_t;

/// The target's: replaces a record as a whole or not at all; count 0: there is none from now on.
/// Returns at once.
typedef keeper_answer_t (*keeper_store_t)(void *context, keeper_record_t record,
                                          const uint32_t *words, uint32_t count);

/// Zeros, but under_way KEEPER_RECORDS: nothing is kept.
typedef struct {
    keeper_store_t store; ///< NULL: there is no such memory
    void *context;
    keeper_record_t under_way; ///< KEEPER_RECORDS: none
    uint32_t mark;             ///< of the record under way
    bool is_awaited;           ///< somebody asks for its outcome
    bool has_outcome;
    bool is_stored;
    struct {
        uint32_t mark;        ///< whoever's who asked for it, such as a CRC; 0: none is kept
        uint32_t writes;      ///< so far, saturating
        keeper_state_t state; ///< until it is written again
    } kept[KEEPER_RECORDS];
} keeper_t;

void keeper_init(keeper_t *self);

/// A record that an earlier run has left.
void keeper_found(keeper_t *self, keeper_record_t record, uint32_t mark, uint32_t writes);

/// How that record was found, where it is not whole.
static inline void keeper_found_as(keeper_t *self, keeper_record_t record, keeper_state_t state) {
    self->kept[record].state = state;
}

/// Has a record stored; ask every tick, with the same words, until it returns true: *is_stored then
/// says how it went.
bool keeper_ask(keeper_t *self, keeper_record_t record, uint32_t mark, const uint32_t *words,
                uint32_t count, bool *is_stored);

/// Likewise, without anybody who waits for it. Returns false iff it cannot be begun now.
bool keeper_begin(keeper_t *self, keeper_record_t record, uint32_t mark, const uint32_t *words,
                  uint32_t count);

/// Nobody waits for an outcome any more.
static inline void keeper_give_up(keeper_t *self) {
    self->is_awaited = false;
    self->has_outcome = false;
}

/// The target says how the record under way went.
void keeper_stored(keeper_t *self, bool is_stored);

#ifdef __cplusplus
}
#endif

#endif
