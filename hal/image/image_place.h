/// Whether bytes of flash are an image that may run there: what boot code asks before it starts
/// one, and an update before it says that one is to be tried.
#ifndef IMAGE_PLACE_H
#define IMAGE_PLACE_H

#include "sha256.h"

#include <stdbool.h>
#include <stdint.h>

typedef struct {
    const uint8_t *bytes;
    uint32_t count;   ///< room for an image
    uint32_t address; ///< of the first byte, where it runs
} image_place_t;

/// Sealed, whole, linked for that address, and of that board (image_info.h). Looks at nothing
/// outside of the place, whatever the bytes say. Takes some 70 instructions a byte.
bool image_is_in(const image_place_t *place, const char *board);

/// The same in parts, for who has other things to do.
typedef enum { IMAGE_CHECK_BUSY, IMAGE_CHECK_GOOD, IMAGE_CHECK_BAD } image_check_result_t;

typedef struct {
    const uint8_t *seal; ///< NULL: it is none
    sha256_t hash;
} image_check_t;

void image_check_begin(image_check_t *self, const image_place_t *place, const char *board);

/// At most so many blocks of 64 bytes, some 4,300 instructions each, until it is not BUSY.
image_check_result_t image_check_work(image_check_t *self, uint32_t blocks);

#endif
