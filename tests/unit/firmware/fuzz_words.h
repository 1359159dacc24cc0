/// What fuzz targets of tables share: a good table whose words the input changes, or raw words.
#ifndef FUZZ_WORDS_H
#define FUZZ_WORDS_H

#include "fuzz_bytes.h"

enum { MAX_RAW_WORDS = 2048 };

typedef struct {
    uint32_t *words; // as long as the table, so that the sanitizer sees every read beyond it
    uint32_t count;
} copy_t;

static inline copy_t new_copy(uint32_t count) {
    const copy_t copy = {malloc(count * sizeof(uint32_t)), count};
    REQUIRE(copy.words != NULL);
    return copy;
}

static inline uint32_t changed(bytes_t *bytes, uint32_t kind, uint32_t word, uint32_t count) {
    static const uint32_t special[] = {
        0,          1,          0xFF,       0xFFFF,     0x10000,    0x003FFFFF, 0x00FFFFFE,
        0x00FFFFFF, 0x01000000, 0x10000000, 0x10000001, 0x7FFFFFFF, 0x80000000, 0xFFFFFFFF,
    };
    const uint32_t shift = 8u * (kind >> 4 & 3u);
    switch (kind & 7u) {
    case 0:
        return take(bytes, 4);
    case 1:
        return word ^ 1u << take(bytes, 1) % 32u;
    case 2:
        return (word & ~(0xFFu << shift)) | take(bytes, 1) << shift;
    case 3:
        return (word & ~(0xFFFFu << (shift & 16u))) | take(bytes, 2) << (shift & 16u);
    case 4:
        return special[take(bytes, 1) % (sizeof special / sizeof special[0])];
    case 5:
        return word + (uint32_t)(int32_t)(int8_t)take(bytes, 1);
    case 6:
        return count - take(bytes, 1);
    default:
        return word << 1;
    }
}

// Words of the table, changed where the input says.
static inline copy_t damaged_words(bytes_t *bytes, const uint32_t *words, uint32_t count) {
    copy_t copy = new_copy(count);
    memcpy(copy.words, words, count * sizeof(uint32_t));
    while (bytes->left > 0) {
        const uint32_t at = take(bytes, 2) % count;
        const uint32_t kind = take(bytes, 1);
        copy.words[at] = changed(bytes, kind, copy.words[at], count);
        // The same number in a whole stretch, such as all values of a partition.
        const uint32_t end = at + ((kind & 8u) != 0 ? take(bytes, 1) : 0);
        for (uint32_t i = at; i < end && i + 1u < count; i++) {
            copy.words[i + 1u] = copy.words[i];
        }
    }
    return copy;
}

static inline copy_t raw_words(bytes_t *bytes) {
    const size_t words = bytes->left / sizeof(uint32_t);
    copy_t copy = new_copy(words < MAX_RAW_WORDS ? (uint32_t)words : MAX_RAW_WORDS);
    for (uint32_t i = 0; i < copy.count; i++) {
        copy.words[i] = take(bytes, 4);
    }
    return copy;
}

static inline uint32_t random_u32(uint32_t *state) {
    *state = *state * 1664525u + 1013904223u;
    return *state >> 16 ^ *state << 16;
}

#endif
