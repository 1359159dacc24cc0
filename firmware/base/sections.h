/// Tables whose own part is sections, one a damper from the first on: after the head of all tables
/// their number, 1 .. QUIESCE_MAX_DAMPERS, then one after the other.
#ifndef SECTIONS_H
#define SECTIONS_H

#include "table.h"

enum { SECTIONS_COUNT = TABLE_HEAD_WORDS, SECTIONS_FIRST };

/// What a section of a kind is.
typedef struct {
    /// Words of the section that begins here. 0 iff a number in it is out of its range, or it would
    /// need more than left words, of which it reads none behind.
    uint32_t (*size)(const uint32_t *section, uint32_t left);
    /// Whether the values of a section of good size are in their ranges.
    bool (*is_good)(const uint32_t *section);
    /// VIEW_ bits that damper i's section needs beside the damper itself.
    uint64_t (*needs)(const uint32_t *section, uint32_t i);
} sections_kind_t;

/// What a kind's check says of such tables: SHAPE for numbers and sizes, POINT for values. They
/// have SECTIONS_FIRST words at least.
quiesce_table_verdict_t sections_check(const sections_kind_t *kind, const uint32_t *words);

/// VIEW_ bits that a checked table needs: each of its dampers, and what their sections need.
uint64_t sections_need(const sections_kind_t *kind, const uint32_t *words);

/// Of tables whose only section, where there is one, is of every damper: the section of a damper.
/// NULL iff there are several and none is its own.
const uint32_t *sections_shared(const sections_kind_t *kind, const uint32_t *words,
                                uint32_t damper);

/// As sections_need, of such tables: VIEW_EACH of what an only section needs.
uint64_t sections_shared_need(const sections_kind_t *kind, const uint32_t *words);

static inline uint32_t sections_count(const uint32_t *words) {
    return words[SECTIONS_COUNT];
}

static inline const void *sections_first(const uint32_t *words) {
    return &words[SECTIONS_FIRST];
}

#endif
