/// hal/nvm.h on any memory of hal/nvm_memory.h: two slots a record, written in turn.
///
/// A slot is a head of four words and the record's words after it. The head is programmed last, its
/// magic as the last word of all, so that a slot counts only once everything is in it; the CRC-32
/// covers owner, head and record. The newer one of two whole slots holds the record.
#ifndef NVM_RECORDS_H
#define NVM_RECORDS_H

#include "hal/nvm.h"
#include "hal/nvm_memory.h"

typedef enum {
    NVM_HEAD_CRC,
    NVM_HEAD_SEQUENCE, ///< number of this write, from 1
    NVM_HEAD_COUNT,    ///< of the record's words
    NVM_HEAD_MAGIC,    ///< kind and version, and the record's number
    NVM_HEAD_WORDS,
} nvm_head_t;

#define NVM_MAGIC 0x304D5651u ///< "QVM0": of record 0

typedef enum { NVM_REST, NVM_ERASE, NVM_WORDS, NVM_HEAD } nvm_phase_t;

struct hal_nvm {
    hal_nvm_memory_t *memory;
    uint32_t owner;
    uint32_t slot_words;
    struct {
        bool is_read;
        uint32_t sequence;  ///< of what was written last, as far as is known
        uint32_t next_slot; ///< 0 or 1
    } record[HAL_NVM_RECORDS];
    nvm_phase_t phase; ///< of the write under way
    uint32_t writing;  ///< its record
    uint32_t done;     ///< words of the slot that are erased, or of the record that are programmed
    const uint32_t *words;
    uint32_t head[NVM_HEAD_WORDS];
};

/// Words of memory that blocks of this size make necessary.
uint32_t nvm_records_words(uint32_t block_words);

/// memory: the caller's, of nothing else. owner: such as a board's CRC. Reads and writes nothing
/// yet. Returns false iff the memory is too small.
bool nvm_records_open(hal_nvm_t *nvm, hal_nvm_memory_t *memory, uint32_t owner);

#endif
