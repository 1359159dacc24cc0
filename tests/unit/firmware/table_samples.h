// Good tables that fit the default board, of which a number tells one from another: rules, a law
// that demands forces, a damper's map. Each writes words and returns how many there are.
#ifndef TABLE_SAMPLES_H
#define TABLE_SAMPLES_H

#include <string.h>

#include "crc32.h"
#include "law_words.h"
#include "rule_cases.h"
#include "table.h"

static inline void sample_seal(uint32_t *words) {
    const uint32_t count = words[TABLE_WORDS];
    words[TABLE_CRC] = crc32_words(&words[TABLE_SUMMED_FROM], count - TABLE_SUMMED_FROM);
}

/// Rules whose current at rest is this one. The shipped ones say 0 mA.
static inline uint32_t sample_rules(uint32_t *words, int32_t at_rest_mA) {
    const rule_case_t *one = &rule_cases[CASE_SUM_PHYSICAL];
    memcpy(words, one->words, one->count * sizeof *words);
    fuzzy_table_t *header = (fuzzy_table_t *)(void *)words;
    fuzzy_output_t *output = (fuzzy_output_t *)(void *)(words + header->output_offset[0]);
    header->origin = at_rest_mA;
    output->origin = at_rest_mA;
    sample_seal(words);
    return one->count;
}

/// For law friction.
static inline uint32_t sample_friction(uint32_t *words, uint32_t gain_N_m) {
    const uint32_t made[] = {0x31524651, 0, 9, 1, gain_N_m, 1000, 800000, 200, 3};
    memcpy(words, made, sizeof made);
    sample_seal(words);
    return made[TABLE_WORDS];
}

/// For tracker inverse. force_mN: the largest, from 400000 on.
static inline uint32_t sample_map(uint32_t *words, uint32_t force_mN) {
    const uint32_t count = map_of_damper.count;
    memcpy(words, map_of_damper.words, count * sizeof *words);
    words[TABLE_WORDS] = count;
    words[count - 1u] = force_mN;
    sample_seal(words);
    return count;
}

#endif
