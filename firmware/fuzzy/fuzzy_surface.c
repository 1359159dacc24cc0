// Surfaces: what rules of any kind answer, as values on a grid with straight lines between them.
// The cost does not depend on the rules.
#include "fuzzy_forms.h"

#define ONE_q15 (UINT32_C(1) << 15)
#define SCALE_BITS 62u ///< of scale times width
#define MIN_SHIFT 16u
#define MAX_SHIFT 46u

// A place between two nodes that follow one another: 0 .. 2^15 from the first to the second.
typedef struct {
    uint32_t node;
    uint32_t share_q15;
} place_t;

static const fuzzy_node_t *nodes_of(const fuzzy_table_t *table, uint32_t i) {
    return fuzzy_at(table, table->axis[i].offset);
}

// At most 8 rounds. Beyond the nodes their ends hold. The share is rounded down.
static place_t find_place(const fuzzy_table_t *table, uint32_t i, int32_t input) {
    const fuzzy_node_t *node = nodes_of(table, i);
    uint32_t low = 0;
    uint32_t high = table->axis[i].cells;
    while (high - low > 1u) {
        const uint32_t middle = (low + high) / 2u;
        if (input < node[middle].at) {
            high = middle;
        } else {
            low = middle;
        }
    }
    if (input <= node[low].at) {
        return (place_t){low, 0};
    }
    if (input >= node[high].at) {
        return (place_t){low, ONE_q15};
    }
    const uint32_t distance = ((uint32_t)input - (uint32_t)node[low].at) << node[low].shift;
    return (place_t){low, (uint32_t)((uint64_t)distance * node[low].scale >> (SCALE_BITS - 15u))};
}

// Half words, the lower one first.
static uint32_t value_at(const uint32_t *words, uint32_t k) {
    return words[k / 2u] >> 16u * (k & 1u) & UINT16_MAX;
}

// Between the values k and k + 1, Q15; below 2^31.
static uint32_t along(const uint32_t *values, uint32_t k, uint32_t share_q15) {
    return value_at(values, k) * (ONE_q15 - share_q15) + value_at(values, k + 1u) * share_q15;
}

// To nearest, half up. q30: below 2^46.
static uint32_t counts_of(uint64_t q30, uint32_t shift) {
    return (uint32_t)((q30 + (UINT64_C(1) << shift) / 2u) >> shift);
}

uint32_t fuzzy_surface(const fuzzy_table_t *table, const int32_t *input, int32_t *value) {
    const place_t row = find_place(table, 0, input[0]);
    const place_t column = find_place(table, 1, input[1]);
    const uint32_t columns = table->axis[1].cells + 1u;
    const uint32_t *values = fuzzy_at(table, table->output_offset[0]);
    const uint32_t first = row.node * columns + column.node;
    const uint64_t q30 =
        (uint64_t)along(values, first, column.share_q15) * (ONE_q15 - row.share_q15) +
        (uint64_t)along(values, first + columns, column.share_q15) * row.share_q15;
    *value = table->origin + (int32_t)counts_of(q30, table->fraction);
    return 0;
}

static bool is_node_good(const fuzzy_node_t *node) {
    const int64_t width = (int64_t)node[1].at - node[0].at;
    if (width <= 0 || node->shift > 31u) {
        return false;
    }
    const uint64_t scaled = (uint64_t)width << node->shift;
    return scaled <= UINT32_MAX && scaled * node->scale <= UINT64_C(1) << SCALE_BITS;
}

static bool is_axis_good(const fuzzy_table_t *table, uint32_t i) {
    const fuzzy_axis_t axis = table->axis[i];
    const uint32_t words = (axis.cells + 1u) * FUZZY_NODE_WORDS;
    if (axis.cells == 0 || axis.stride != FUZZY_NODE_WORDS ||
        !fuzzy_is_inside(table, axis.offset, words)) {
        return false;
    }
    for (uint32_t k = 0; k < axis.cells; k++) {
        if (!is_node_good(nodes_of(table, i) + k)) {
            return false;
        }
    }
    return true;
}

fuzzy_verdict_t fuzzy_surface_check(const fuzzy_table_t *table) {
    if (table->inputs != 2u || table->outputs != 1u) {
        return FUZZY_TABLE_SHAPE;
    }
    if (!is_axis_good(table, 0) || !is_axis_good(table, 1)) {
        return FUZZY_TABLE_CELL;
    }
    const uint32_t values = (table->axis[0].cells + 1u) * (table->axis[1].cells + 1u);
    const bool has_values =
        table->fraction >= MIN_SHIFT && table->fraction <= MAX_SHIFT &&
        fuzzy_is_inside(table, table->output_offset[0], (values + 1u) / 2u) &&
        table->origin + (int64_t)counts_of((uint64_t)UINT16_MAX << 30, table->fraction) <=
            INT32_MAX;
    return has_values ? FUZZY_TABLE_OK : FUZZY_TABLE_OUTPUT;
}
