#include "image_place.h"

#include <stddef.h>

#include "image_info.h"

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

// Where its seal is; NULL where the bytes are no image of that board for that place.
static const uint8_t *seal_of(const image_place_t *place, const char *board) {
    const uint32_t info = find_info(place);
    if (info == NOWHERE || word_at(place, info + WORD_BYTES * INFO_BEGIN) != place->address) {
        return NULL;
    }
    const uint32_t seal =
        offset_of(place, word_at(place, info + WORD_BYTES * INFO_SEAL), SHA256_BYTES);
    if (seal == NOWHERE || seal <= info ||
        !is_for(place, word_at(place, info + WORD_BYTES * INFO_BOARD), board)) {
        return NULL;
    }
    return &place->bytes[seal];
}

void image_check_begin(image_check_t *self, const image_place_t *place, const char *board) {
    self->seal = seal_of(place, board);
    if (self->seal != NULL) {
        sha256_begin(&self->hash, place->bytes, (uint32_t)(self->seal - place->bytes));
    }
}

image_check_result_t image_check_work(image_check_t *self, uint32_t blocks) {
    uint8_t digest[SHA256_BYTES];
    uint32_t differences = 0;
    if (self->seal == NULL) {
        return IMAGE_CHECK_BAD;
    }
    if (!sha256_work(&self->hash, blocks)) {
        return IMAGE_CHECK_BUSY;
    }
    sha256_end(&self->hash, digest);
    for (uint32_t i = 0; i < SHA256_BYTES; i++) {
        differences |= (uint32_t)(digest[i] ^ self->seal[i]);
    }
    return differences == 0u ? IMAGE_CHECK_GOOD : IMAGE_CHECK_BAD;
}

bool image_is_in(const image_place_t *place, const char *board) {
    image_check_t check;
    image_check_begin(&check, place, board);
    return image_check_work(&check, UINT32_MAX) == IMAGE_CHECK_GOOD;
}
