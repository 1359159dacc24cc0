/// Hashes of what the controller puts out: CRC-32 a block of ticks, and one a column of a case.
#ifndef RECORD_H
#define RECORD_H

#include "quiesce.h"

#define RECORD_BLOCK_TICKS 1000u
#define RECORD_MAX_BLOCKS 64u
/// The command, the driver's enable, all telemetry, and the law's own words that were telemetry in
/// the first recording.
#define RECORD_COLUMNS (2u + sizeof(quiesce_telemetry_t) / sizeof(uint32_t) + RECORD_LAW_WORDS)
#define RECORD_LAW_WORDS 9u

/// Of a case, with the end of the text; a longer name is cut.
#define RECORD_NAME_BYTES 32u

typedef struct {
    char name[RECORD_NAME_BYTES];
    uint32_t ticks;
    uint32_t blocks[RECORD_MAX_BLOCKS];
    uint32_t columns[RECORD_COLUMNS];
} record_t;

/// Prints the columns' names in their order, one line.
void record_print_columns(void);

/// Names the case GROUP/NAME_NUMBER, of two digits.
void record_start(record_t *self, const char *group, const char *name, uint32_t number);

/// Everything that one tick put out and the law has to tell. At most RECORD_MAX_BLOCKS x
/// RECORD_BLOCK_TICKS of them.
void record_tick(record_t *self, const quiesce_t *controller, int32_t law,
                 const quiesce_out_t *out);

/// Something beside the ticks: a verdict, what was learnt. It goes into the current block.
void record_words(record_t *self, const uint32_t *words, uint32_t count);
void record_word(record_t *self, uint32_t word);

/// Prints the case: `NAME out WORD...`, a word a block, and `NAME col WORD...`, a word a column.
void record_end(const record_t *self);

#endif
