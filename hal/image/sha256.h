/// SHA-256 (FIPS 180-4): tells whether an image is the one that was built.
#ifndef SHA256_H
#define SHA256_H

#include <stdint.h>

#define SHA256_BYTES 32u

/// Of size bytes, below 2^29. Bounded: 64 rounds for each 64 bytes begun, and one more block.
void sha256(const uint8_t *bytes, uint32_t size, uint8_t digest[SHA256_BYTES]);

#endif
