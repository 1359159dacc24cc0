/// What a run of laws is to be: words of one layout for the program and the image.
#ifndef LAW_ORDER_H
#define LAW_ORDER_H

#include <stddef.h>

#include "quiesce.h"

enum {
    LAW_ORDER_WHOLE, ///< the controller, on counts of its board's sensors
    LAW_ORDER_ALONE, ///< law and tracker, on made-up pictures
    LAW_ORDER_SPOIL, ///< likewise, over and over with the law's or the tracker's table spoilt
};

/// What follows these words: the law's table, the tracker's, then a count of each sensor a tick.
typedef struct {
    uint32_t mode;
    uint32_t ticks; ///< in all
    uint32_t seed;
    uint32_t block_ticks; ///< outputs of so many ticks get a CRC-32 each
    uint32_t law_words;   ///< 0: the table that ships, or none
    uint32_t map_words;   ///< 0: none
    quiesce_params_t params;
    quiesce_board_t board;
} law_order_t;

/// A count that no sensor reports: no sample came.
#define LAW_ORDER_NO_SAMPLE INT32_MIN

static inline const uint32_t *law_order_table(const law_order_t *order) {
    return order->law_words > 0 ? (const uint32_t *)(const void *)(order + 1) : NULL;
}

static inline const uint32_t *law_order_map(const law_order_t *order) {
    return order->map_words > 0 ? (const uint32_t *)(const void *)(order + 1) + order->law_words
                                : NULL;
}

static inline const int32_t *law_order_counts(const law_order_t *order) {
    return (const int32_t *)(const void *)(order + 1) + order->law_words + order->map_words;
}

/// What the program or the image lends.
typedef struct {
    void (*say)(const char *name, uint32_t value);                 ///< one line
    void (*count)(void (*function)(void *context), void *context); ///< calls it, counted
} law_door_t;

/// Runs it and says lines "name value". Returns false iff it was refused.
bool law_runs(const law_order_t *order, const law_door_t *door);

#endif
