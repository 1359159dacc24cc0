#include "image_place.h"

#include "image_info.h"
#include "sha256.h"

#define WORD_BYTES 4u
#define INFO_WITHIN 4096u ///< bytes from the image's beginning

/// Of image_info_t, in words.
enum { INFO_MAGIC, INFO_LAYOUT, INFO_VERSION, INFO_PARAMS, INFO_BEGIN, INFO_SEAL, INFO_BOARD };
#define INFO_WORDS 8u

/// Behind the room.
#define NOWHERE UINT32_MAX

static uint32_t word_at(const image_place_t *place, uint32_t at) {
    const uint8_t *const byte = &place->bytes[at];
    return (uint32_t)byte[0] | (uint32_t)byte[1] << 8 | (uint32_t)byte[2] << 16 |
           (uint32_t)byte[3] << 24;
}

// Where so many bytes from that address on lie in the place; NOWHERE where they do not.
static uint32_t offset_of(const image_place_t *place, uint32_t address, uint32_t bytes) {
    const uint32_t at = address - place->address;
    const bool is_inside = bytes <= place->count && at <= place->count - bytes;
    return address >= place->address && is_inside ? at : NOWHERE;
}

static uint32_t find_info(const image_place_t *place) {
    for (uint32_t at = 0; at < INFO_WITHIN && at + INFO_WORDS * WORD_BYTES <= place->count;
         at += WORD_BYTES) {
        if (word_at(place, at) == IMAGE_INFO_MAGIC &&
            word_at(place, at + WORD_BYTES * INFO_LAYOUT) == IMAGE_INFO_LAYOUT) {
            return at;
        }
    }
    return NOWHERE;
}

static bool is_for(const image_place_t *place, uint32_t pointer, const char *board) {
    const uint32_t at = offset_of(place, pointer, WORD_BYTES);
    if (at == NOWHERE) {
        return false;
    }
    uint32_t name = offset_of(place, word_at(place, at), 1);
    while (name < place->count && place->bytes[name] == (uint8_t)*board && *board != '\0') {
        name++;
        board++;
    }
    return name < place->count && place->bytes[name] == 0u && *board == '\0';
}

static bool is_whole(const image_place_t *place, uint32_t seal) {
    uint8_t digest[SHA256_BYTES];
    uint32_t differences = 0;
    sha256(place->bytes, seal, digest);
    for (uint32_t i = 0; i < SHA256_BYTES; i++) {
        differences |= (uint32_t)(digest[i] ^ place->bytes[seal + i]);
    }
    return differences == 0u;
}

bool image_is_in(const image_place_t *place, const char *board) {
    const uint32_t info = find_info(place);
    if (info == NOWHERE || word_at(place, info + WORD_BYTES * INFO_BEGIN) != place->address) {
        return false;
    }
    const uint32_t seal =
        offset_of(place, word_at(place, info + WORD_BYTES * INFO_SEAL), SHA256_BYTES);
    return seal != NOWHERE && seal > info &&
           is_for(place, word_at(place, info + WORD_BYTES * INFO_BOARD), board) &&
           is_whole(place, seal);
}
