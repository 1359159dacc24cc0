/// What an image says of itself, for those who read its file or its flash, and whether it is whole.
///
/// `quiesce firmware build` seals an image: the SHA-256 of all that is loaded, up to the seal, goes
/// into the seal. That finds damage and mix-ups; it keeps nobody out (no secure boot).
#ifndef IMAGE_INFO_H
#define IMAGE_INFO_H

#include "sha256.h"

#include <stdint.h>

#define IMAGE_INFO_MAGIC 0x474D4951u ///< "QIMG"
#define IMAGE_INFO_LAYOUT 1u

/// Behind the vectors (image.ld). Words, little-endian; pointers are addresses of the target.
typedef struct {
    uint32_t magic;
    uint32_t layout;
    uint32_t version;      ///< major << 16 | minor << 8 | patch
    uint32_t param_layout; ///< QUIESCE_PARAM_LAYOUT
    const uint8_t *begin;  ///< of what is loaded
    const uint8_t *seal;   ///< its end: SHA256_BYTES, all ones where nobody has sealed it
    const char *const *board;
    const uint32_t *const *tables; ///< those linked in (shipped.h); NULL after the last
} image_info_t;

typedef enum { IMAGE_WHOLE, IMAGE_UNSEALED, IMAGE_BROKEN } image_state_t;

/// Takes some 70 instructions a byte.
image_state_t image_state(const image_info_t *info);

#endif
