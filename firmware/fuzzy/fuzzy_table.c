#include "fuzzy_table.h"

#include "crc32.h"

#define CRC_FROM_WORD 2u
#define RAMP_WORDS 4u
#define CELL_WORDS 4u
#define PAIR_CELL_WORDS 12u
#define MAX_VALUE (UINT32_C(1) << 24)
#define MAX_PARTITION_BITS 20u

// The largest set that each input's cells name: what a partition's grid must have room for.
typedef struct {
    uint32_t set[FUZZY_MAX_INPUTS];
} largest_t;

static bool is_partition(const fuzzy_table_t *table) {
    return table->form >= FUZZY_PARTITION_SUM;
}

static bool has_shape(const fuzzy_table_t *table) {
    if (table->inputs == 0 || table->inputs > FUZZY_MAX_INPUTS || table->outputs == 0 ||
        table->outputs > FUZZY_MAX_OUTPUTS || table->bits < FUZZY_MIN_BITS ||
        table->bits > FUZZY_MAX_BITS || table->one != UINT32_C(1) << table->bits) {
        return false;
    }
    if (table->form > FUZZY_PARTITION_CENTROID ||
        (is_partition(table) &&
         (table->inputs != 2u || table->outputs != 1u || table->bits > MAX_PARTITION_BITS))) {
        return false;
    }
    return table->rules != 0 && table->rules <= FUZZY_MAX_RULES;
}

// ---- cells --------------------------------------------------------------------------------------

static int64_t ramp_start(const fuzzy_ramp_t *ramp) {
    return (int64_t)((uint64_t)(uint32_t)ramp->a_high << 32 | ramp->a_low);
}

static bool is_membership(const fuzzy_table_t *table, int64_t scaled) {
    return scaled >= 0 && scaled >> 32 <= table->one;
}

static bool is_ramp_good(const fuzzy_table_t *table, const fuzzy_cell_t *cell,
                         const fuzzy_ramp_t *ramp) {
    const int64_t start = ramp_start(ramp);
    if (ramp->set >= FUZZY_MAX_SETS || !is_membership(table, start)) {
        return false;
    }
    if (ramp->b == 0) {
        return true;
    }
    const uint64_t length = (uint64_t)((int64_t)cell->last - cell->first) << cell->shift;
    return length < UINT32_C(1) << 31 && is_membership(table, start + ramp->b * (int64_t)length);
}

static bool adds_up_to_one(const fuzzy_table_t *table, const fuzzy_cell_t *cell,
                           const fuzzy_ramp_t *ramp) {
    if (cell->ramps == 1u) {
        return ramp->b == 0 && ramp_start(ramp) >> 32 == table->one;
    }
    const int64_t total = ((int64_t)table->one << 32) + UINT32_MAX;
    return cell->ramps == 2u && ramp[1].set == ramp[0].set + 1u &&
           ramp[1].b == -(int64_t)ramp[0].b && ramp_start(&ramp[0]) + ramp_start(&ramp[1]) == total;
}

static bool is_cell_good(const fuzzy_table_t *table, uint32_t i, const fuzzy_cell_t *cell,
                         uint32_t *largest) {
    const uint32_t room = (table->axis[i].stride - CELL_WORDS) / RAMP_WORDS;
    if (cell->first > cell->last || cell->shift > 31u || cell->ramps > room ||
        cell->ramps > FUZZY_MAX_SETS) {
        return false;
    }
    const fuzzy_ramp_t *ramp = (const fuzzy_ramp_t *)(const void *)(cell + 1);
    for (uint32_t k = 0; k < cell->ramps; k++) {
        if (!is_ramp_good(table, cell, &ramp[k])) {
            return false;
        }
        *largest = fuzzy_max(*largest, ramp[k].set);
    }
    return !is_partition(table) || adds_up_to_one(table, cell, ramp);
}

static bool is_axis_good(const fuzzy_table_t *table, uint32_t i, uint32_t *largest) {
    const fuzzy_axis_t axis = table->axis[i];
    if (axis.cells == 0 || axis.stride < PAIR_CELL_WORDS || axis.stride % RAMP_WORDS != 0 ||
        (is_partition(table) && axis.stride != PAIR_CELL_WORDS) ||
        !fuzzy_is_inside(table, axis.offset, (uint32_t)axis.cells * axis.stride)) {
        return false;
    }
    int64_t next = INT32_MIN;
    for (uint32_t k = 0; k < axis.cells; k++) {
        const fuzzy_cell_t *cell = fuzzy_at(table, axis.offset + k * axis.stride);
        if (cell->first != next || !is_cell_good(table, i, cell, largest)) {
            return false;
        }
        next = (int64_t)cell->last + 1;
    }
    return next == (int64_t)INT32_MAX + 1;
}

static bool are_cells_good(const fuzzy_table_t *table, largest_t *largest) {
    for (uint32_t i = 0; i < table->inputs; i++) {
        if (!is_axis_good(table, i, &largest->set[i])) {
            return false;
        }
    }
    return true;
}

// ---- outputs ------------------------------------------------------------------------------------

// Words `values` up to the one that the last four rules of a grid read.
static uint32_t grid_words(const largest_t *largest) {
    return largest->set[0] * FUZZY_GRID_STRIDE + largest->set[1] + 1u;
}

static bool are_below(const fuzzy_table_t *table, uint32_t offset, uint32_t count, uint32_t limit) {
    if (!fuzzy_is_inside(table, offset, count)) {
        return false;
    }
    const uint32_t *words = fuzzy_at(table, offset);
    for (uint32_t i = 0; i < count; i++) {
        if (words[i] >= limit) {
            return false;
        }
    }
    return true;
}

static bool fits_above(int32_t origin, uint32_t range) {
    return (int64_t)origin + range <= INT32_MAX;
}

static bool is_layer_good(const fuzzy_table_t *table, const fuzzy_output_t *output,
                          const fuzzy_layer_t *layer, bool is_term) {
    return layer->first <= layer->second && layer->second < output->terms &&
           is_term == (layer->first == layer->second) && layer->start <= table->one &&
           layer->height <= table->one - layer->start && layer->steep < 32u &&
           (layer->steep == 0 || !is_partition(table));
}

static bool is_centroid_good(const fuzzy_table_t *table, const fuzzy_output_t *output) {
    const uint32_t words = (uint32_t)(sizeof(fuzzy_layer_t) / sizeof(uint32_t));
    const uint32_t layers = output->terms_offset + output->terms;
    if (output->terms > FUZZY_MAX_SETS || output->span == 0 || output->span >= MAX_VALUE ||
        !fits_above(output->origin, output->span) || output->term_layers > output->layers ||
        !are_below(table, output->terms_offset, output->terms, table->one + 1u) ||
        !fuzzy_is_inside(table, layers, output->layers * words)) {
        return false;
    }
    const bool is_stacked = output->term_layers == 0;
    const fuzzy_layer_t *layer = fuzzy_at(table, layers);
    for (uint32_t i = 0; i < output->layers; i++) {
        if (!is_layer_good(table, output, &layer[i], is_stacked || i < output->term_layers)) {
            return false;
        }
    }
    return true;
}

static bool is_output_good(const fuzzy_table_t *table, uint32_t offset) {
    if (!fuzzy_is_inside(table, offset, (uint32_t)(sizeof(fuzzy_output_t) / sizeof(uint32_t)))) {
        return false;
    }
    const fuzzy_output_t *output = fuzzy_at(table, offset);
    if (output->method > FUZZY_CENTROID || output->terms == 0 || output->terms > FUZZY_MAX_TERMS) {
        return false;
    }
    if (output->method == FUZZY_CENTROID) {
        return is_centroid_good(table, output);
    }
    return fits_above(output->origin, MAX_VALUE) && output->fraction <= FUZZY_MAX_FRACTION &&
           are_below(table, output->terms_offset, output->terms, MAX_VALUE);
}

static bool are_outputs_good(const fuzzy_table_t *table) {
    for (uint32_t i = 0; i < table->outputs; i++) {
        if (!is_output_good(table, table->output_offset[i])) {
            return false;
        }
    }
    return true;
}

// The block that the four rules of a partition read reaches one row and one column further.
static bool is_partition_good(const fuzzy_table_t *table, const largest_t *largest) {
    const fuzzy_output_t *output = fuzzy_at(table, table->output_offset[0]);
    const uint32_t words = grid_words(largest) + FUZZY_GRID_STRIDE + 1u;
    const uint32_t method = (uint32_t)table->form - FUZZY_PARTITION_SUM;
    if (output->method != method || output->origin != table->origin ||
        output->fraction != table->fraction || table->bits + table->fraction > MAX_PARTITION_BITS) {
        return false;
    }
    if (output->method == FUZZY_CENTROID) {
        return are_below(table, FUZZY_HEADER_WORDS, words, output->terms);
    }
    // Strengths add up to twice `one` at most; fuzzy_short_quotient() takes 43 bits, half of what
    // it divides by included.
    const uint32_t half = (1u << table->fraction) / 2u;
    const uint32_t limit = (uint32_t)((UINT64_C(1) << 42) / table->one) - half;
    return are_below(table, FUZZY_HEADER_WORDS, words, fuzzy_min(limit, MAX_VALUE)) &&
           (output->method == FUZZY_SUM || fuzzy_is_inside(table, table->twins_offset, words));
}

// ---- rules --------------------------------------------------------------------------------------

static bool are_conditions_good(const fuzzy_table_t *table, const fuzzy_rule_t *rule) {
    const uint32_t count = rule->head >> 24;
    if (count == 0 || count > FUZZY_MAX_CONDITIONS) {
        return false;
    }
    for (uint32_t k = 0; k < count; k++) {
        const uint32_t input = rule->condition[k] >> 3 & 15u;
        if (input >= table->inputs || (rule->condition[k] & 7u) >= FUZZY_MAX_SETS) {
            return false;
        }
    }
    return true;
}

static bool are_conclusions_good(const fuzzy_table_t *table, const fuzzy_rule_t *rule) {
    for (uint32_t i = 0; i < table->outputs; i++) {
        const fuzzy_output_t *output = fuzzy_at(table, table->output_offset[i]);
        if (rule->conclusion[i] >= output->terms && rule->conclusion[i] != FUZZY_NO_TERM) {
            return false;
        }
    }
    return true;
}

static bool are_rules_good(const fuzzy_table_t *table) {
    const uint32_t words = (uint32_t)(sizeof(fuzzy_rule_t) / sizeof(uint32_t));
    if (!fuzzy_is_inside(table, table->rules_offset, table->rules * words)) {
        return false;
    }
    const fuzzy_rule_t *rule = fuzzy_at(table, table->rules_offset);
    for (uint32_t i = 0; i < table->rules; i++) {
        if ((rule[i].head & FUZZY_WEIGHT_MASK) > FUZZY_WEIGHT_ONE_q19 ||
            !are_conditions_good(table, &rule[i]) || !are_conclusions_good(table, &rule[i])) {
            return false;
        }
    }
    return true;
}

fuzzy_verdict_t fuzzy_table_check_summed(const fuzzy_table_t *table) {
    if (table->form == FUZZY_SURFACE) {
        return fuzzy_surface_check(table);
    }
    largest_t largest = {{0}};
    if (!has_shape(table)) {
        return FUZZY_TABLE_SHAPE;
    }
    if (!are_cells_good(table, &largest)) {
        return FUZZY_TABLE_CELL;
    }
    if (!are_outputs_good(table) || (is_partition(table) && !is_partition_good(table, &largest))) {
        return FUZZY_TABLE_OUTPUT;
    }
    return are_rules_good(table) ? FUZZY_TABLE_OK : FUZZY_TABLE_RULE;
}

fuzzy_verdict_t fuzzy_table_check(const fuzzy_table_t *table, uint32_t words) {
    if (words < FUZZY_HEADER_WORDS) {
        return FUZZY_TABLE_SIZE;
    }
    if (table->magic != FUZZY_MAGIC) {
        return FUZZY_TABLE_MAGIC;
    }
    if (table->size_words < FUZZY_HEADER_WORDS || table->size_words > words ||
        table->size_words > FUZZY_MAX_WORDS) {
        return FUZZY_TABLE_SIZE;
    }
    const uint32_t *all = (const uint32_t *)(const void *)table;
    const uint32_t crc = crc32_words(all + CRC_FROM_WORD, table->size_words - CRC_FROM_WORD);
    return crc == table->crc ? fuzzy_table_check_summed(table) : FUZZY_TABLE_CRC;
}
