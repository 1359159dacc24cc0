/// hal/nvm.h on any memory of hal/nvm_memory.h: a log of records in one half of it, continued in
/// the other one once it is full.
///
/// A half begins with its number, twice. Entries follow: a head of four words, the record's words,
/// and a tail of two, the CRC-32 of owner, head and record, and last of all a magic word. The last
/// whole entry of a record holds it. Where an entry finds no room, the other half is erased, the
/// record of each other number is copied there with the entry behind them, and its number, one
/// more, is programmed last: from then on that half counts.
///
/// Of what a power cut leaves nothing is believed: a bit that was being programmed or erased may
/// read otherwise at each start. The first write after a start therefore programs again what it was
/// found by (number and last entry), clears what did not count, so that it never does, and leaves a
/// gap of four words.
#ifndef NVM_RECORDS_H
#define NVM_RECORDS_H

#include "hal/nvm.h"
#include "hal/nvm_memory.h"

/// Programmed at once; places and sizes in the log are multiples of it.
#define NVM_HEAD_WORDS 4u

/// Of an entry and of a half.
typedef enum {
    NVM_HEAD_MAGIC,  ///< NVM_ENTRY and the record's number, or NVM_HALF
    NVM_HEAD_COUNT,  ///< of the record's words; 0 of a half
    NVM_HEAD_NUMBER, ///< of this write of the record, or of this half, from 1
    NVM_HEAD_CRC,    ///< of the three words before
} nvm_head_t;

#define NVM_ENTRY 0x454D5651u    ///< "QVME": of record 0
#define NVM_HALF 0x484D5651u     ///< "QVMH"
#define NVM_WHOLE 0x57505651u    ///< "QVPW": the last word of an entry
#define NVM_FIRST_AT 8u          ///< in a half, after its two heads
#define NVM_ENTRY_EXTRA_WORDS 8u ///< head and tail

typedef enum {
    NVM_REST,
    NVM_MEND_HALF,  ///< programs its heads again
    NVM_MEND_OTHER, ///< clears the other half's, where they could come to count
    NVM_MEND_LAST,  ///< programs the last entry's tail again, or clears it
    NVM_ERASE,      ///< the other half
    NVM_COPY,       ///< the records that are not written
    NVM_ENTRY_HEAD,
    NVM_ENTRY_WORDS,
    NVM_ENTRY_TAIL,
    NVM_NUMBER, ///< of the other half, which counts with it
} nvm_phase_t;

/// Places are words from the half's begin.
struct hal_nvm {
    hal_nvm_memory_t *memory;
    uint32_t owner;
    uint32_t half_words;
    uint32_t half;    ///< the one that counts
    uint32_t number;  ///< its own; 0: there is none yet
    uint32_t end;     ///< of its log
    uint32_t last_at; ///< its last entry; 0: none
    uint32_t last_tail_at;
    bool is_last_whole;
    bool is_mended; ///< since the start
    struct {
        uint32_t at; ///< its last whole entry; 0: none
        uint32_t writes;
        uint16_t count;  ///< of its words
        bool is_doubted; ///< something after that entry is not whole and may have been another one
    } record[HAL_NVM_RECORDS];

    nvm_phase_t phase;       ///< of the write under way
    hal_nvm_progress_t step; ///< what the call of hal_nvm_work has come to
    uint32_t writing;        ///< its record
    uint32_t to;             ///< half that it goes to
    uint32_t place;          ///< in it
    uint32_t copying;        ///< record
    uint32_t done;           ///< words of the phase
    uint32_t bad_heads;
    const uint32_t *words;
    uint32_t head[NVM_HEAD_WORDS];
    uint32_t crc; ///< of the entry so far
};

/// Words of memory that blocks of this size make necessary: all records at their longest, twice.
uint32_t nvm_records_words(uint32_t block_words);

/// memory: the caller's, of nothing else. owner: such as a board's CRC. Reads the log, with the CRC
/// of each entry, and writes nothing. Returns false iff the memory is too small.
bool nvm_records_open(hal_nvm_t *nvm, hal_nvm_memory_t *memory, uint32_t owner);

#endif
