/// Lists of inputs over which an image walks.
#ifndef INPUT_LIST_H
#define INPUT_LIST_H

#include <stdint.h>

#define LIST_MAX 2048u

typedef struct {
    uint32_t count; ///< LIST_MAX: full, some may be missing
    int32_t value[LIST_MAX];
} list_t;

static inline void list_add(list_t *list, int64_t value) {
    if (list->count < LIST_MAX && value >= INT32_MIN && value <= INT32_MAX) {
        list->value[list->count++] = (int32_t)value;
    }
}

/// steps equal steps from 0 to universe, both included.
static inline void list_add_even(list_t *list, uint32_t steps, uint32_t universe) {
    for (uint32_t i = 0; i <= steps; i++) {
        list_add(list, (int64_t)((uint64_t)universe * i / steps));
    }
}

/// A border, and one beside.
static inline void list_add_around(list_t *list, int32_t border) {
    for (int32_t beside = -1; beside <= 1; beside++) {
        list_add(list, (int64_t)border + beside);
    }
}

static inline void list_add_beyond(list_t *list, uint32_t universe) {
    list_add(list, INT32_MIN);
    list_add(list, -1);
    list_add(list, (int64_t)universe + 1);
    list_add(list, INT32_MAX);
}

#endif
