/// The head that every table's file has before its words, as a transfer and a disk have them
/// (docs/reference/table-files.md): what is checked before the table itself is.
#ifndef TABLE_FILE_H
#define TABLE_FILE_H

#include "quiesce.h"

#ifdef __cplusplus
extern "C" {
#endif

#define TABLE_FILE_MAGIC UINT32_C(0x31465451) ///< "QTF1": kind and version

enum { TABLE_FILE_KIND, TABLE_FILE_BOARD, TABLE_FILE_WORDS, TABLE_FILE_CRC, TABLE_FILE_HEAD_WORDS };

#define TABLE_FILE_MOST_BYTES (4u * (TABLE_FILE_HEAD_WORDS + QUIESCE_TABLE_WORDS))

/// The first word of what was learnt, as a table: then CRC-32 of what follows, the number of words
/// in all, and the words of quiesce_learnt_t.
#define TABLE_FILE_LEARNT UINT32_C(0x31544C51) ///< "QLT1"

/// Writes the head of so many words of a table. board: CRC-32 of the words of the board that it is
/// made for, 0: any.
void table_file_head(uint32_t head[TABLE_FILE_HEAD_WORDS], uint32_t board, uint32_t words);

/// Whether a head is one, of so many words of a table.
bool table_file_is_head(const uint32_t head[TABLE_FILE_HEAD_WORDS], uint32_t words);

/// CRC-32 of a board's words; 0 without one.
uint32_t table_file_board(const quiesce_board_t *board);

#ifdef __cplusplus
}
#endif

#endif
