#include "table_feed.h"

#include "isotp.h"
#include "quiesce_can.h"

#define SHORT_MOST 4095u ///< bytes that the short first frame tells

void table_feed_begin(table_feed_t *self, const uint32_t *words, uint32_t count) {
    *self = (table_feed_t){.words = words, .bytes = 4u * (TABLE_FILE_HEAD_WORDS + count)};
    table_file_head(self->head, 0, count);
}

static uint8_t byte_of(const table_feed_t *self, uint32_t at) {
    const uint32_t word = at / 4u;
    const uint32_t value =
        word < TABLE_FILE_HEAD_WORDS ? self->head[word] : self->words[word - TABLE_FILE_HEAD_WORDS];
    return (uint8_t)(value >> (8u * (at % 4u)));
}

// What comes before the bytes of the file. Returns its length.
static uint32_t put_control(const table_feed_t *self, uint8_t *data) {
    if (self->number > 0u) {
        data[0] = (uint8_t)(0x20u | self->number % 16u);
        return 1;
    }
    if (self->bytes <= SHORT_MOST) {
        data[0] = (uint8_t)(0x10u | self->bytes >> 8);
        data[1] = (uint8_t)self->bytes;
        return 2;
    }
    data[0] = 0x10;
    data[1] = 0;
    for (uint32_t i = 0; i < 4u; i++) {
        data[2u + i] = (uint8_t)(self->bytes >> (24u - 8u * i));
    }
    return 6;
}

bool table_feed_next(table_feed_t *self, can_frame_t *frame) {
    if (self->done == self->bytes) {
        return false;
    }
    *frame = (can_frame_t){.id = QUIESCE_CAN_TABLE_DATA_FRAME_ID, .length = ISOTP_FRAME_BYTES};
    for (uint32_t at = put_control(self, frame->data);
         at < ISOTP_FRAME_BYTES && self->done < self->bytes; at++) {
        frame->data[at] = byte_of(self, self->done);
        self->done++;
    }
    self->number++;
    return true;
}
