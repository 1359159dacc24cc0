/// A table's file as frames of TableData, one after the other.
#ifndef TABLE_FEED_H
#define TABLE_FEED_H

#include "can_frame.h"
#include "table_file.h"

typedef struct {
    uint32_t head[TABLE_FILE_HEAD_WORDS];
    const uint32_t *words;
    uint32_t bytes;
    uint32_t done;   ///< bytes that have gone
    uint32_t number; ///< of the next frame
} table_feed_t;

void table_feed_begin(table_feed_t *self, const uint32_t *words, uint32_t count);

/// Returns false iff all of it has gone.
bool table_feed_next(table_feed_t *self, can_frame_t *frame);

#endif
