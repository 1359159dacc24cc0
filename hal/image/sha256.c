#include "sha256.h"

#define BLOCK_BYTES 64u
#define LENGTH_AT 56u ///< of the last block
#define ROUNDS 64u

// FIPS 180-4, 4.2.2: the first 32 bits of the fractional parts of the cube roots of the primes.
static const uint32_t constants[ROUNDS] = {
    0x428a2f98u, 0x71374491u, 0xb5c0fbcfu, 0xe9b5dba5u, 0x3956c25bu, 0x59f111f1u, 0x923f82a4u,
    0xab1c5ed5u, 0xd807aa98u, 0x12835b01u, 0x243185beu, 0x550c7dc3u, 0x72be5d74u, 0x80deb1feu,
    0x9bdc06a7u, 0xc19bf174u, 0xe49b69c1u, 0xefbe4786u, 0x0fc19dc6u, 0x240ca1ccu, 0x2de92c6fu,
    0x4a7484aau, 0x5cb0a9dcu, 0x76f988dau, 0x983e5152u, 0xa831c66du, 0xb00327c8u, 0xbf597fc7u,
    0xc6e00bf3u, 0xd5a79147u, 0x06ca6351u, 0x14292967u, 0x27b70a85u, 0x2e1b2138u, 0x4d2c6dfcu,
    0x53380d13u, 0x650a7354u, 0x766a0abbu, 0x81c2c92eu, 0x92722c85u, 0xa2bfe8a1u, 0xa81a664bu,
    0xc24b8b70u, 0xc76c51a3u, 0xd192e819u, 0xd6990624u, 0xf40e3585u, 0x106aa070u, 0x19a4c116u,
    0x1e376c08u, 0x2748774cu, 0x34b0bcb5u, 0x391c0cb3u, 0x4ed8aa4au, 0x5b9cca4fu, 0x682e6ff3u,
    0x748f82eeu, 0x78a5636fu, 0x84c87814u, 0x8cc70208u, 0x90befffau, 0xa4506cebu, 0xbef9a3f7u,
    0xc67178f2u,
};

static uint32_t turned(uint32_t x, uint32_t by) {
    return x >> by | x << (32u - by);
}

// The next word of the schedule, in the place of the one 16 rounds ago.
static uint32_t extended(uint32_t w[16], uint32_t round) {
    const uint32_t a = w[(round + 1u) % 16u];
    const uint32_t b = w[(round + 14u) % 16u];
    w[round % 16u] += (turned(a, 7) ^ turned(a, 18) ^ a >> 3) + w[(round + 9u) % 16u] +
                      (turned(b, 17) ^ turned(b, 19) ^ b >> 10);
    return w[round % 16u];
}

static void take_block(uint32_t hash[SHA256_WORDS], const uint8_t *block) {
    uint32_t w[16];
    uint32_t a = hash[0], b = hash[1], c = hash[2], d = hash[3];
    uint32_t e = hash[4], f = hash[5], g = hash[6], h = hash[7];
    for (uint32_t i = 0; i < 16u; i++) {
        w[i] = (uint32_t)block[4u * i] << 24 | (uint32_t)block[4u * i + 1u] << 16 |
               (uint32_t)block[4u * i + 2u] << 8 | (uint32_t)block[4u * i + 3u];
    }
    for (uint32_t round = 0; round < ROUNDS; round++) {
        const uint32_t word = round < 16u ? w[round] : extended(w, round);
        const uint32_t one = h + (turned(e, 6) ^ turned(e, 11) ^ turned(e, 25)) +
                             ((e & f) ^ (~e & g)) + constants[round] + word;
        const uint32_t two =
            (turned(a, 2) ^ turned(a, 13) ^ turned(a, 22)) + ((a & b) ^ (a & c) ^ (b & c));
        h = g;
        g = f;
        f = e;
        e = d + one;
        d = c;
        c = b;
        b = a;
        a = one + two;
    }
    const uint32_t added[SHA256_WORDS] = {a, b, c, d, e, f, g, h};
    for (uint32_t i = 0; i < SHA256_WORDS; i++) {
        hash[i] += added[i];
    }
}

// What is left, a one bit, zeros, the length in bits: a block, or two.
static void take_end(uint32_t hash[SHA256_WORDS], const uint8_t *rest, uint32_t count,
                     uint32_t size) {
    uint8_t last[2u * BLOCK_BYTES] = {0};
    const uint32_t bytes = count < LENGTH_AT ? BLOCK_BYTES : 2u * BLOCK_BYTES;
    for (uint32_t i = 0; i < count; i++) {
        last[i] = rest[i];
    }
    last[count] = 0x80u;
    for (uint32_t i = 0; i < 4u; i++) {
        last[bytes - 1u - i] = (uint8_t)(size << 3 >> (8u * i));
    }
    for (uint32_t at = 0; at < bytes; at += BLOCK_BYTES) {
        take_block(hash, &last[at]);
    }
}

void sha256_begin(sha256_t *self, const uint8_t *bytes, uint32_t size) {
    // FIPS 180-4, 5.3.3: likewise of the square roots of the first eight.
    *self = (sha256_t){
        .hash = {0x6a09e667u, 0xbb67ae85u, 0x3c6ef372u, 0xa54ff53au, 0x510e527fu, 0x9b05688cu,
                 0x1f83d9abu, 0x5be0cd19u},
        .bytes = bytes,
        .size = size,
    };
}

bool sha256_work(sha256_t *self, uint32_t blocks) {
    const uint32_t whole = self->size - self->size % BLOCK_BYTES;
    for (uint32_t i = 0; i < blocks && self->at < whole; i++) {
        take_block(self->hash, &self->bytes[self->at]);
        self->at += BLOCK_BYTES;
    }
    return self->at == whole;
}

void sha256_end(sha256_t *self, uint8_t digest[SHA256_BYTES]) {
    take_end(self->hash, &self->bytes[self->at], self->size - self->at, self->size);
    for (uint32_t i = 0; i < SHA256_BYTES; i++) {
        digest[i] = (uint8_t)(self->hash[i / 4u] >> (24u - 8u * (i % 4u)));
    }
}

void sha256(const uint8_t *bytes, uint32_t size, uint8_t digest[SHA256_BYTES]) {
    sha256_t state;
    sha256_begin(&state, bytes, size);
    (void)sha256_work(&state, UINT32_MAX);
    sha256_end(&state, digest);
}
