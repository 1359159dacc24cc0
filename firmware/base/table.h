/// What tables of all kinds begin with: a magic (kind and version), the CRC-32 of what follows it,
/// and the number of words in all.
#ifndef TABLE_H
#define TABLE_H

#include "quiesce.h"

/// Of a table that is made for no tick rate of its own.
#define TABLE_ANY_RATE UINT32_MAX

enum { TABLE_MAGIC, TABLE_CRC, TABLE_WORDS, TABLE_HEAD_WORDS };

/// A kind of table, of a law or a tracker.
typedef struct {
    const char *name;        ///< for people
    uint32_t magic;          ///< no other kind has it
    uint32_t least_words;    ///< of a table
    const uint32_t *shipped; ///< used until another one is; NULL: none ships, and until one is in
                             ///< use the law or tracker is not stepped
    /// What the head does not say: SHAPE and what follows it. words: of a table with a good head.
    quiesce_table_verdict_t (*check)(const uint32_t *words);
    /// VIEW_ bits that a checked table needs beside the law or tracker, VIEW_EACH of each that
    /// there is; one that the board cannot serve is refused. NULL: none.
    uint64_t (*needs)(const uint32_t *words);
    /// Ticks a second that a checked table is made for, TABLE_ANY_RATE, or 0 where its parts
    /// differ; at another rate it is refused. NULL: any.
    uint32_t (*rate_Hz)(const uint32_t *words);
} table_kind_t;

/// Whether count words are a good table of a kind: SIZE, MAGIC, SIZE, CRC, then what its check
/// says.
quiesce_table_verdict_t table_check(const table_kind_t *kind, const uint32_t *words,
                                    uint32_t count);

/// The same of words whose CRC has just been found right.
quiesce_table_verdict_t table_check_summed(const table_kind_t *kind, const uint32_t *words,
                                           uint32_t count);

/// Where the sum of a table begins.
#define TABLE_SUMMED_FROM TABLE_WORDS

#endif
