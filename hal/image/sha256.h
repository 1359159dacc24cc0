/// SHA-256 (FIPS 180-4): tells whether an image is the one that was built.
#ifndef SHA256_H
#define SHA256_H

#include <stdbool.h>
#include <stdint.h>

#define SHA256_BYTES 32u
#define SHA256_WORDS 8u

typedef struct {
    uint32_t hash[SHA256_WORDS];
    const uint8_t *bytes;
    uint32_t size;
    uint32_t at; ///< so far
} sha256_t;

/// Of size bytes, below 2^29. Bounded: 64 rounds for each 64 bytes begun, and one more block.
void sha256(const uint8_t *bytes, uint32_t size, uint8_t digest[SHA256_BYTES]);

/// The same in parts: at most so many blocks of 64 bytes a call, until it returns true; then the
/// end. The bytes stay where they are.
void sha256_begin(sha256_t *self, const uint8_t *bytes, uint32_t size);
bool sha256_work(sha256_t *self, uint32_t blocks);
void sha256_end(sha256_t *self, uint8_t digest[SHA256_BYTES]);

#endif
