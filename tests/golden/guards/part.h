/// The guarding blocks on random inputs at the edges of their ranges, recorded: what each of them
/// says, not what it remembers.
#ifndef PART_H
#define PART_H

#include "draw.h"
#include "record.h"

typedef struct {
    record_t record;
    uint32_t seed;
} part_t;

/// Names the case guards/NAME_NUMBER and seeds it.
void part_open(part_t *self, const char *name, uint32_t number);
void part_word(part_t *self, int64_t word);
/// Prints what was recorded.
void part_close(part_t *self);

/// low .. high: an end, one beside it, something small, or anything.
int32_t part_edge(part_t *self, int32_t low, int32_t high);
/// Around a value, at most 2 away from it.
int32_t part_near(part_t *self, int64_t value);
bool part_one_in(part_t *self, uint32_t count);

#endif
