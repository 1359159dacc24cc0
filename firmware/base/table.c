#include "table.h"

#include "crc32.h"

static quiesce_table_verdict_t check_head(const table_kind_t *kind, const uint32_t *words,
                                          uint32_t count) {
    if (count < TABLE_HEAD_WORDS || count < kind->least_words || count > QUIESCE_TABLE_WORDS) {
        return QUIESCE_TABLE_SIZE;
    }
    if (words[TABLE_MAGIC] != kind->magic) {
        return QUIESCE_TABLE_MAGIC;
    }
    return words[TABLE_WORDS] == count ? QUIESCE_TABLE_OK : QUIESCE_TABLE_SIZE;
}

quiesce_table_verdict_t table_check_summed(const table_kind_t *kind, const uint32_t *words,
                                           uint32_t count) {
    const quiesce_table_verdict_t verdict = check_head(kind, words, count);
    return verdict == QUIESCE_TABLE_OK ? kind->check(words) : verdict;
}

quiesce_table_verdict_t table_check(const table_kind_t *kind, const uint32_t *words,
                                    uint32_t count) {
    const quiesce_table_verdict_t verdict = check_head(kind, words, count);
    if (verdict != QUIESCE_TABLE_OK) {
        return verdict;
    }
    const uint32_t crc = crc32_words(&words[TABLE_SUMMED_FROM], count - TABLE_SUMMED_FROM);
    return crc == words[TABLE_CRC] ? kind->check(words) : QUIESCE_TABLE_CRC;
}
