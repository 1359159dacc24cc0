#include "table.h"

#include "crc32.h"

quiesce_table_verdict_t table_check_head(const uint32_t *words, uint32_t count, uint32_t magic,
                                         uint32_t further) {
    if (count < TABLE_HEAD_WORDS + further || count > QUIESCE_TABLE_WORDS) {
        return QUIESCE_TABLE_SIZE;
    }
    if (words[TABLE_MAGIC] != magic) {
        return QUIESCE_TABLE_MAGIC;
    }
    if (words[TABLE_WORDS] != count) {
        return QUIESCE_TABLE_SIZE;
    }
    return crc32_words(&words[TABLE_WORDS], count - TABLE_WORDS) == words[TABLE_CRC]
               ? QUIESCE_TABLE_OK
               : QUIESCE_TABLE_CRC;
}
