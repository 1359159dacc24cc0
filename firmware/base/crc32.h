/// CRC-32 (IEEE 802.3, reflected, as zlib's): guards what is stored or sent.
#ifndef CRC32_H
#define CRC32_H

#include <stdint.h>

/// Of words in little-endian byte order. Bounded: a table of 16 entries, 8 look-ups a word.
/// before: CRC of the words before these, 0 where there are none.
uint32_t crc32_continue(uint32_t before, const uint32_t *words, uint32_t count);
uint32_t crc32_words(const uint32_t *words, uint32_t count);

#endif
