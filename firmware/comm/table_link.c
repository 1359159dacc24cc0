#include "table_link.h"

#include <stddef.h>

#include "quiesce_can.h"

#define WORD_BYTES 4u
#define SUMMED_A_TICK 8u ///< words; a frame brings less than two

static void take_word(table_link_t *self, quiesce_tables_t *tables) {
    if (self->words < TABLE_FILE_HEAD_WORDS) {
        self->head[self->words] = self->word;
    } else {
        (void)quiesce_tables_write(tables, self->words - TABLE_FILE_HEAD_WORDS, &self->word, 1);
    }
    self->words++;
    self->word = 0;
}

void table_link_take(table_link_t *self, const can_frame_t *frame, quiesce_tables_t *tables) {
    const uint32_t room = quiesce_tables_have_room(tables) ? TABLE_FILE_MOST_BYTES : 0u;
    const isotp_part_t part = isotp_take(&self->isotp, frame->data, room);
    if (part.count > 0u && part.at == 0u) {
        self->words = 0;
        self->word = 0;
    }
    for (uint32_t i = 0; i < part.count; i++) {
        const uint32_t byte = (part.at + i) % WORD_BYTES;
        self->word |= (uint32_t)part.bytes[i] << (8u * byte);
        if (byte == WORD_BYTES - 1u) {
            take_word(self, tables);
        }
    }
}

bool table_link_has_file(const table_link_t *self) {
    return isotp_is_whole(&self->isotp) && self->isotp.length == WORD_BYTES * self->words &&
           self->words > TABLE_FILE_HEAD_WORDS &&
           table_file_is_head(self->head, self->words - TABLE_FILE_HEAD_WORDS);
}

uint32_t table_link_send(table_link_t *self, const uint32_t *words, uint32_t board) {
    const uint32_t count = words[2]; // of every table
    const uint32_t bytes = WORD_BYTES * (TABLE_FILE_HEAD_WORDS + count);
    table_file_head(self->head, board, count);
    self->sent = words;
    isotp_send(&self->isotp, bytes);
    return bytes;
}

void table_link_drop(table_link_t *self) {
    *self = (table_link_t){0};
}

static uint8_t byte_of(const void *context, uint32_t at) {
    const table_link_t *self = context;
    const uint32_t index = at / WORD_BYTES;
    const uint32_t word = index < TABLE_FILE_HEAD_WORDS ? self->head[index]
                                                        : self->sent[index - TABLE_FILE_HEAD_WORDS];
    return (uint8_t)(word >> (8u * (at % WORD_BYTES)));
}

bool table_link_tick(table_link_t *self, uint32_t passed_ms, quiesce_tables_t *tables,
                     can_frame_t *frame) {
    if (self->isotp.state == ISOTP_RECEIVING) {
        (void)quiesce_tables_sum(tables, SUMMED_A_TICK);
    }
    if (!isotp_tick(&self->isotp, passed_ms, byte_of, self, frame->data)) {
        return false;
    }
    frame->id = QUIESCE_CAN_TABLE_FLOW_FRAME_ID;
    frame->length = QUIESCE_CAN_TABLE_FLOW_LENGTH;
    frame->is_extended = false;
    frame->is_remote = false;
    return true;
}
