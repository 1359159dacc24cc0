#include "table_file.h"

#include <stddef.h>

#include "crc32.h"

void table_file_head(uint32_t head[TABLE_FILE_HEAD_WORDS], uint32_t board, uint32_t words) {
    head[TABLE_FILE_KIND] = TABLE_FILE_MAGIC;
    head[TABLE_FILE_BOARD] = board;
    head[TABLE_FILE_WORDS] = words;
    head[TABLE_FILE_CRC] = crc32_words(head, TABLE_FILE_CRC);
}

bool table_file_is_head(const uint32_t head[TABLE_FILE_HEAD_WORDS], uint32_t words) {
    return head[TABLE_FILE_KIND] == TABLE_FILE_MAGIC && head[TABLE_FILE_WORDS] == words &&
           head[TABLE_FILE_CRC] == crc32_words(head, TABLE_FILE_CRC);
}

uint32_t table_file_board(const quiesce_board_t *board) {
    return board == NULL ? 0u
                         : crc32_words((const uint32_t *)(const void *)board,
                                       sizeof *board / sizeof(uint32_t));
}
