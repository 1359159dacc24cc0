/// What the files of the table engine share; nothing for the outside.
#ifndef FUZZY_FORMS_H
#define FUZZY_FORMS_H

#include "fuzzy.h"

/// distance: fuzzy_distance(); below 2^31 wherever the ramp has a slope.
static inline uint32_t fuzzy_membership(const fuzzy_ramp_t *ramp, uint32_t distance) {
    const int64_t a = (int64_t)((uint64_t)(uint32_t)ramp->a_high << 32 | ramp->a_low);
    return fuzzy_ramp(a, ramp->b, distance);
}

static inline uint32_t fuzzy_distance(const fuzzy_cell_t *cell, int32_t input) {
    return ((uint32_t)input - (uint32_t)cell->first) << cell->shift;
}

static inline const fuzzy_output_t *fuzzy_output_of(const fuzzy_table_t *table, uint32_t index) {
    return fuzzy_at(table, table->output_offset[index]);
}

/// Strengths of the terms of an output with sets, and one for a place that has none.
#define FUZZY_STRENGTHS (FUZZY_MAX_SETS + 1u)

/// Centroid of an output of any table. strength: fuzzy_fine_strength() of its terms,
/// FUZZY_STRENGTHS of them; cut at their peaks here. Returns 1, and the default in *value, where
/// all are 0.
uint32_t fuzzy_any_centroid(const fuzzy_table_t *table, const fuzzy_output_t *output,
                            uint64_t *strength, int32_t *value);

/// The partitions of fuzzy_form_t, as fuzzy_evaluate().
uint32_t fuzzy_partition_sum(const fuzzy_table_t *table, const int32_t *input, int32_t *value);
uint32_t fuzzy_partition_max(const fuzzy_table_t *table, const int32_t *input, int32_t *value);
uint32_t fuzzy_partition_centroid(const fuzzy_table_t *table, const int32_t *input, int32_t *value);

/// FUZZY_SURFACE, as fuzzy_evaluate(): some 300 instructions, whatever the rules were.
uint32_t fuzzy_surface(const fuzzy_table_t *table, const int32_t *input, int32_t *value);

#endif
