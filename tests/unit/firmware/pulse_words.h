// Pulse tables for tests: the words of phase_table.h, made from points.
#ifndef PULSE_WORDS_H
#define PULSE_WORDS_H

#include <string.h>

#include "crc32.h"
#include "phase_table.h"

enum { PULSE_WORDS_HEADER = 5, PULSE_WORDS_POINT = 4 };

/// Gives words their CRC, whatever they hold. count >= 2.
static inline void pulse_words_seal(uint32_t *words, uint32_t count) {
    words[1] = crc32_words(&words[2], count - 2u);
}

/// Writes a table of two settings. words: PHASE_TABLE_MAX_WORDS long. Returns how many there are.
static inline uint32_t pulse_words_make(uint32_t *words, const phase_point_t *first,
                                        uint32_t first_count, const phase_point_t *second,
                                        uint32_t second_count) {
    const uint32_t count = PULSE_WORDS_HEADER + PULSE_WORDS_POINT * (first_count + second_count);
    words[0] = PHASE_TABLE_MAGIC;
    words[2] = count;
    words[3] = first_count | second_count << 16;
    words[4] = 5000;
    memcpy(&words[PULSE_WORDS_HEADER], first, first_count * sizeof *first);
    memcpy(&words[PULSE_WORDS_HEADER + PULSE_WORDS_POINT * first_count], second,
           second_count * sizeof *second);
    pulse_words_seal(words, count);
    return count;
}

#endif
