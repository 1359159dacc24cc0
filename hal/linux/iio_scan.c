#include "iio_scan.h"

#define MAX_BITS 32u
#define MAX_STORAGE_BITS 64u

/// A number of at most 64 at *text, which moves behind it.
static bool take_number(const char **text, uint32_t *number) {
    uint32_t value = 0;
    const char *digit = *text;
    while (*digit >= '0' && *digit <= '9' && value <= MAX_STORAGE_BITS) {
        value = 10u * value + (uint32_t)(*digit - '0');
        digit++;
    }
    const bool is_number = digit != *text && value <= MAX_STORAGE_BITS;
    *text = digit;
    *number = value;
    return is_number;
}

static bool take(const char **text, char expected) {
    if (**text != expected) {
        return false;
    }
    (*text)++;
    return true;
}

static bool take_shift(const char **text, uint32_t *shift) {
    *shift = 0;
    if (**text == '\0') {
        return true;
    }
    const bool is_first = take(text, '>');
    const bool is_second = take(text, '>');
    return is_first && is_second && take_number(text, shift);
}

static bool is_storage(uint32_t bits) {
    return bits == 8u || bits == 16u || bits == 32u || bits == 64u;
}

bool iio_parse_type(const char *text, iio_channel_t *channel) {
    iio_channel_t out = *channel;
    uint32_t storage_bits = 0;
    const char *at = text;
    out.is_big_endian = *at == 'b';
    if ((!take(&at, 'b') && !take(&at, 'l')) || !take(&at, 'e') || !take(&at, ':')) {
        return false;
    }
    out.is_signed = *at == 's' || *at == 'S';
    const bool has_sign = out.is_signed || *at == 'u' || *at == 'U';
    if (!has_sign) {
        return false;
    }
    at++;
    if (!take_number(&at, &out.bits) || !take(&at, '/') || !take_number(&at, &storage_bits) ||
        !take_shift(&at, &out.shift) || *at != '\0') {
        return false;
    }
    const uint32_t most_bits = out.is_signed ? MAX_BITS : MAX_BITS - 1u;
    if (out.bits == 0u || out.bits > most_bits || !is_storage(storage_bits) ||
        out.bits + out.shift > storage_bits) {
        return false;
    }
    out.storage = storage_bits / 8u;
    *channel = out;
    return true;
}

static uint32_t align(uint32_t offset, uint32_t bytes) {
    return (offset + bytes - 1u) / bytes * bytes;
}

/// The channel with the least index from `from` on; NULL: there is none.
static iio_channel_t *next_channel(iio_channel_t *channels, uint32_t count, uint32_t from) {
    iio_channel_t *next = NULL;
    for (uint32_t i = 0; i < count; i++) {
        if (channels[i].index >= from && (next == NULL || channels[i].index < next->index)) {
            next = &channels[i];
        }
    }
    return next;
}

uint32_t iio_lay_out(iio_channel_t *channels, uint32_t count) {
    uint32_t offset = 0;
    uint32_t largest = 1;
    for (iio_channel_t *at = next_channel(channels, count, 0); at != NULL;
         at = next_channel(channels, count, at->index + 1u)) {
        at->offset = align(offset, at->storage);
        offset = at->offset + at->storage;
        largest = at->storage > largest ? at->storage : largest;
    }
    return align(offset, largest);
}

int32_t iio_value(const iio_channel_t *channel, const uint8_t *scan) {
    const uint8_t *const bytes = &scan[channel->offset];
    uint64_t word = 0;
    for (uint32_t i = 0; i < channel->storage; i++) {
        const uint32_t at = channel->is_big_endian ? i : channel->storage - 1u - i;
        word = word << 8 | bytes[at];
    }
    const uint64_t mask = (UINT64_C(1) << channel->bits) - 1u;
    const uint64_t value = word >> channel->shift & mask;
    const uint64_t sign = UINT64_C(1) << (channel->bits - 1u);
    return channel->is_signed && (value & sign) != 0u
               ? (int32_t)((int64_t)value - (int64_t)mask - 1)
               : (int32_t)value;
}
