#include "e2e.h"

#define CRC_START 0xFFu
#define ALIVE_MASK (E2E_ALIVE_PERIOD - 1u)

// The remainder of each nibble, polynomial 0x1D.
static const uint8_t nibble[16] = {
    0x00, 0x1D, 0x3A, 0x27, 0x74, 0x69, 0x4E, 0x53, 0xE8, 0xF5, 0xD2, 0xCF, 0x9C, 0x81, 0xA6, 0xBB,
};

static uint32_t add_byte(uint32_t crc, uint32_t byte) {
    crc ^= byte & 0xFFu;
    crc = ((crc << 4) & 0xFFu) ^ nibble[crc >> 4];
    return ((crc << 4) & 0xFFu) ^ nibble[crc >> 4];
}

uint8_t e2e_crc(const e2e_layout_t *layout, const can_frame_t *frame) {
    uint32_t crc = add_byte(add_byte(CRC_START, layout->id), layout->id >> 8);
    for (uint32_t i = 0; i < layout->crc_byte; i++) {
        crc = add_byte(crc, frame->data[i]);
    }
    return (uint8_t)~crc;
}

void e2e_protect(const e2e_layout_t *layout, uint8_t *alive, can_frame_t *frame) {
    uint8_t *const byte = &frame->data[layout->alive_bit / 8u];
    const uint32_t shift = layout->alive_bit % 8u;
    *byte = (uint8_t)((*byte & ~(ALIVE_MASK << shift)) | (*alive & ALIVE_MASK) << shift);
    frame->data[layout->crc_byte] = e2e_crc(layout, frame);
    *alive = (uint8_t)((*alive + 1u) & ALIVE_MASK);
}

static bool has_shape(const e2e_layout_t *layout, const can_frame_t *frame) {
    return frame->length == layout->length && !frame->is_extended && !frame->is_remote;
}

e2e_verdict_t e2e_check(const e2e_layout_t *layout, const can_frame_t *frame) {
    if (!has_shape(layout, frame)) {
        return E2E_WRONG_SHAPE;
    }
    const bool is_right = frame->data[layout->crc_byte] == e2e_crc(layout, frame);
    return is_right ? E2E_OK : E2E_WRONG_CRC;
}

uint8_t e2e_alive(const e2e_layout_t *layout, const can_frame_t *frame) {
    const uint32_t bits = (uint32_t)frame->data[layout->alive_bit / 8u] >> layout->alive_bit % 8u;
    return (uint8_t)(bits & ALIVE_MASK);
}
