/// Whether bytes of flash are an image that may run there: what boot code asks before it starts
/// one, and an update before it says that one is to be tried.
#ifndef IMAGE_PLACE_H
#define IMAGE_PLACE_H

#include <stdbool.h>
#include <stdint.h>

typedef struct {
    const uint8_t *bytes;
    uint32_t count;   ///< room for an image
    uint32_t address; ///< of the first byte, where it runs
} image_place_t;

/// Sealed, whole, linked for that address, and of that board (image_info.h). Looks at nothing
/// outside of the place, whatever the bytes say.
bool image_is_in(const image_place_t *place, const char *board);

#endif
