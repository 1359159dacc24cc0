/// A good surface, made here: its answers can be told by hand.
#ifndef SURFACE_CASE_H
#define SURFACE_CASE_H

#include "crc32.h"
#include "fuzzy.h"

enum {
    SURFACE_ROWS = 3,
    SURFACE_COLUMNS = 3,
    SURFACE_VALUES = FUZZY_HEADER_WORDS + 6 * FUZZY_NODE_WORDS,
    SURFACE_WORDS = SURFACE_VALUES + 5
};

// Widths 2^10, 2^12 of the first input; 3, 2^32 - 1 - 3 of the second, which covers all integers.
static const int32_t rows_at[SURFACE_ROWS] = {-1024, 0, 4096};
static const int32_t columns_at[SURFACE_COLUMNS] = {INT32_MIN, INT32_MIN + 3, INT32_MAX};
static const uint32_t surface_values[SURFACE_ROWS][SURFACE_COLUMNS] = {
    {0, 65535, 100}, {1000, 3000, 200}, {8, 16, 65535}};

static uint32_t surface_words[SURFACE_WORDS];

static inline fuzzy_table_t *surface(void) {
    return (fuzzy_table_t *)(void *)surface_words;
}

static inline fuzzy_node_t *surface_node(uint32_t input, uint32_t k) {
    return (fuzzy_node_t *)(void *)(surface_words + surface()->axis[input].offset) + k;
}

static inline void write_nodes(uint32_t input, const int32_t *at, uint32_t count) {
    for (uint32_t k = 0; k < count; k++) {
        *surface_node(input, k) = (fuzzy_node_t){.at = at[k]};
        if (k + 1u < count) {
            const uint32_t width = (uint32_t)at[k + 1u] - (uint32_t)at[k];
            surface_node(input, k)->shift = (uint32_t)__builtin_clz(width);
            surface_node(input, k)->scale =
                (uint32_t)((UINT64_C(1) << 62) /
                           ((uint64_t)width << surface_node(input, k)->shift));
        }
    }
}

static inline void repair_surface_crc(void) {
    surface()->crc = crc32_words(surface_words + 2, surface()->size_words - 2u);
}

static inline void load_surface(void) {
    for (uint32_t i = 0; i < SURFACE_WORDS; i++) {
        surface_words[i] = 0;
    }
    *surface() = (fuzzy_table_t){
        .magic = FUZZY_MAGIC,
        .size_words = SURFACE_WORDS,
        .inputs = 2,
        .outputs = 1,
        .form = FUZZY_SURFACE,
        .axis = {{FUZZY_HEADER_WORDS, SURFACE_ROWS - 1, FUZZY_NODE_WORDS},
                 {FUZZY_HEADER_WORDS + SURFACE_ROWS * FUZZY_NODE_WORDS, SURFACE_COLUMNS - 1,
                  FUZZY_NODE_WORDS}},
        .output_offset = {SURFACE_VALUES},
        .origin = -500,
        .fraction = 30,
    };
    write_nodes(0, rows_at, SURFACE_ROWS);
    write_nodes(1, columns_at, SURFACE_COLUMNS);
    for (uint32_t k = 0; k < SURFACE_ROWS * SURFACE_COLUMNS; k++) {
        surface_words[SURFACE_VALUES + k / 2u] |=
            surface_values[k / SURFACE_COLUMNS][k % SURFACE_COLUMNS] << 16u * (k & 1u);
    }
    repair_surface_crc();
}

#endif
