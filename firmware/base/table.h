/// What tables of all kinds begin with: a magic (kind and version), the CRC-32 of what follows it,
/// and the number of words in all.
#ifndef TABLE_H
#define TABLE_H

#include "quiesce.h"

/// Of a table that is made for no tick rate of its own.
#define TABLE_ANY_RATE UINT32_MAX

enum { TABLE_MAGIC, TABLE_CRC, TABLE_WORDS, TABLE_HEAD_WORDS };

/// Whether count words are a whole table of a kind whose own part begins with further words.
/// Returns OK, or SIZE, MAGIC, SIZE, CRC in this order.
quiesce_table_verdict_t table_check_head(const uint32_t *words, uint32_t count, uint32_t magic,
                                         uint32_t further);

#endif
