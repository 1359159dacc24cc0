/// A record of words kept with its twin: the complement of each word, and their sum. Any flip of
/// one bit or of two bits, in record or twin, is seen: the complement misses a bit that has flipped
/// in both, and that changes the sum. Bounded, about 6 instructions a word.
#ifndef TWIN_H
#define TWIN_H

#include <stdbool.h>
#include <stdint.h>

/// Words of the twin of a record of so many words.
#define TWIN_WORDS(words) ((words) + 1u)

/// Words of a type that has words only.
#define WORDS_OF(type) (sizeof(type) / sizeof(uint32_t))

/// Makes the twin; sums wrap.
static inline void twin_make(const void *record, uint32_t words, uint32_t *twin) {
    const uint32_t *word = (const uint32_t *)record;
    uint32_t sum = 0;
    for (uint32_t i = 0; i < words; i++) {
        sum += word[i];
        twin[i] = ~word[i];
    }
    twin[words] = sum;
}

/// A word of the record has been replaced. The others stay as the twin has them: what has flipped
/// in them meanwhile is still seen.
static inline void twin_replace(uint32_t *twin, uint32_t words, uint32_t at, uint32_t before,
                                uint32_t word) {
    twin[at] = ~word;
    twin[words] += word - before;
}

/// Whether the record still is what its twin was made of.
static inline bool twin_holds(const void *record, uint32_t words, const uint32_t *twin) {
    const uint32_t *word = (const uint32_t *)record;
    uint32_t sum = 0;
    uint32_t differing = 0;
    for (uint32_t i = 0; i < words; i++) {
        sum += word[i];
        differing |= word[i] ^ ~twin[i];
    }
    return (differing | (sum ^ twin[words])) == 0u;
}

#endif
