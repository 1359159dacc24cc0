#include "slcan.h"

#define STANDARD_ID_DIGITS 3u
#define EXTENDED_ID_DIGITS 8u
#define TOO_LONG (SLCAN_MAX_LINE + 1u)

static bool hex_value(uint8_t digit, uint32_t *value) {
    if (digit >= '0' && digit <= '9') {
        *value = (uint32_t)digit - '0';
    } else if (digit >= 'A' && digit <= 'F') {
        *value = (uint32_t)digit - 'A' + 10u;
    } else if (digit >= 'a' && digit <= 'f') {
        *value = (uint32_t)digit - 'a' + 10u;
    } else {
        return false;
    }
    return true;
}

static bool parse_hex(const uint8_t *digits, uint32_t count, uint32_t *value) {
    *value = 0;
    for (uint32_t i = 0; i < count; i++) {
        uint32_t nibble;
        if (!hex_value(digits[i], &nibble)) {
            return false;
        }
        *value = (*value << 4) | nibble;
    }
    return true;
}

static bool starts_like_frame(const slcan_decoder_t *decoder) {
    const uint8_t kind = decoder->line[0];
    return kind == 't' || kind == 'T' || kind == 'r' || kind == 'R';
}

static bool parse_data(const uint8_t *digits, can_frame_t *frame) {
    for (uint32_t i = 0; i < frame->length; i++) {
        uint32_t byte;
        if (!parse_hex(&digits[2 * i], 2, &byte)) {
            return false;
        }
        frame->data[i] = (uint8_t)byte;
    }
    return true;
}

static bool parse_line(const uint8_t *line, uint32_t length, can_frame_t *frame) {
    const bool is_extended = line[0] == 'T' || line[0] == 'R';
    const bool is_remote = line[0] == 'r' || line[0] == 'R';
    const uint32_t id_digits = is_extended ? EXTENDED_ID_DIGITS : STANDARD_ID_DIGITS;
    uint32_t data_length;
    can_frame_t parsed = {.is_extended = is_extended, .is_remote = is_remote};

    if (length < id_digits + 2u || !parse_hex(&line[1], id_digits, &parsed.id) ||
        !parse_hex(&line[1u + id_digits], 1, &data_length)) {
        return false;
    }
    const uint32_t data_digits = is_remote ? 0u : 2u * data_length;
    parsed.length = (uint8_t)data_length;
    if (parsed.id > (is_extended ? CAN_MAX_EXTENDED_ID : CAN_MAX_STANDARD_ID) ||
        data_length > CAN_MAX_BYTES || length != id_digits + 2u + data_digits ||
        (!is_remote && !parse_data(&line[2u + id_digits], &parsed))) {
        return false;
    }
    *frame = parsed;
    return true;
}

void slcan_decoder_init(slcan_decoder_t *decoder) {
    *decoder = (slcan_decoder_t){0};
}

static bool finish_line(slcan_decoder_t *decoder, can_frame_t *frame) {
    const uint32_t length = decoder->length;
    decoder->length = 0;
    if (length == 0) {
        return false;
    }
    if (length < TOO_LONG && !starts_like_frame(decoder)) {
        decoder->ignored_count++;
        return false;
    }
    if (length == TOO_LONG || !parse_line(decoder->line, length, frame)) {
        decoder->malformed_count++;
        return false;
    }
    return true;
}

bool slcan_decode(slcan_decoder_t *decoder, uint8_t byte, can_frame_t *frame) {
    if (byte == '\r' || byte == '\n') {
        return finish_line(decoder, frame);
    }
    if (decoder->length < SLCAN_MAX_LINE) {
        decoder->line[decoder->length] = byte;
        decoder->length++;
    } else {
        decoder->length = TOO_LONG;
    }
    return false;
}

static uint8_t *put_hex(uint8_t *out, uint32_t value, uint32_t digits) {
    for (uint32_t i = digits; i-- > 0;) {
        *out++ = (uint8_t) "0123456789ABCDEF"[(value >> (4u * i)) & 15u];
    }
    return out;
}

static uint8_t kind_letter(const can_frame_t *frame) {
    if (frame->is_remote) {
        return frame->is_extended ? 'R' : 'r';
    }
    return frame->is_extended ? 'T' : 't';
}

size_t slcan_encode(const can_frame_t *frame, uint8_t out[SLCAN_MAX_BYTES]) {
    const uint32_t max_id = frame->is_extended ? CAN_MAX_EXTENDED_ID : CAN_MAX_STANDARD_ID;
    if (frame->id > max_id || frame->length > CAN_MAX_BYTES) {
        return 0;
    }
    uint8_t *end = out;
    *end++ = kind_letter(frame);
    end = put_hex(end, frame->id, frame->is_extended ? EXTENDED_ID_DIGITS : STANDARD_ID_DIGITS);
    end = put_hex(end, frame->length, 1);
    for (uint32_t i = 0; !frame->is_remote && i < frame->length; i++) {
        end = put_hex(end, frame->data[i], 2);
    }
    *end++ = '\r';
    return (size_t)(end - out);
}
