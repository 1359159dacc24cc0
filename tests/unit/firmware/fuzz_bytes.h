/// What all fuzz targets share: a check that ends the program, and the input, taken bit by bit.
#ifndef FUZZ_BYTES_H
#define FUZZ_BYTES_H

#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define REQUIRE(holds)                                                                             \
    do {                                                                                           \
        if (!(holds)) {                                                                            \
            fprintf(stderr, "%s:%d: %s\n", __FILE__, __LINE__, #holds);                            \
            abort();                                                                               \
        }                                                                                          \
    } while (0)

typedef struct {
    const uint8_t *at;
    size_t left;
} bytes_t;

// Little-endian; 0 beyond the end.
static inline uint32_t take(bytes_t *bytes, uint32_t width) {
    uint32_t value = 0;
    for (uint32_t i = 0; i < width && bytes->left > 0; i++, bytes->left--) {
        value |= (uint32_t)*bytes->at++ << (8u * i);
    }
    return value;
}

#endif
