#include "image_info.h"

#include <stdbool.h>

static bool is_unsealed(const uint8_t *seal) {
    uint32_t ones = 0xFFu;
    for (uint32_t i = 0; i < SHA256_BYTES; i++) {
        ones &= seal[i];
    }
    return ones == 0xFFu;
}

image_state_t image_state(const image_info_t *info) {
    uint8_t digest[SHA256_BYTES];
    uint32_t differences = 0;
    if (is_unsealed(info->seal)) {
        return IMAGE_UNSEALED;
    }
    sha256(info->begin, (uint32_t)(info->seal - info->begin), digest);
    for (uint32_t i = 0; i < SHA256_BYTES; i++) {
        differences |= (uint32_t)(digest[i] ^ info->seal[i]);
    }
    return differences == 0u ? IMAGE_WHOLE : IMAGE_BROKEN;
}
