// libFuzzer: rule tables that were damaged by somebody who knows how to make the checksum right
// again. A table that fuzzy_table_check() accepts is safe at any inputs: nothing is undefined (the
// sanitizers watch), nothing is read beyond its words, every output is a default or in its range.
//
// The input: number of a good table, 254 a surface, then changes of single words; or, with number
// 255, the words themselves behind a good header.
#include "fuzzy.h"

#include "crc32.h"
#include "fuzz_words.h"
#include "rule_cases.h"
#include "surface_case.h"

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t count);

enum {
    SURFACE = 254,
    RAW = 255,
    POINTS = 24, // inside the cells, beside their ends
};

static void make_crc_right(copy_t copy, uint32_t size_words) {
    if (copy.count >= sizeof(fuzzy_table_t) / sizeof(uint32_t)) {
        copy.words[0] = FUZZY_MAGIC;
        copy.words[2] = size_words;
        copy.words[1] = crc32_words(copy.words + 2, size_words - 2u);
    }
}

// ---- accepted -----------------------------------------------------------------------------------

static uint32_t greatest(const uint32_t *values, uint32_t count) {
    uint32_t most = 0;
    for (uint32_t i = 0; i < count; i++) {
        most = fuzzy_max(most, values[i]);
    }
    return most;
}

// The largest value above the origin that a table's numbers allow, to nearest.
static uint32_t range_of(const fuzzy_table_t *table, const fuzzy_output_t *output) {
    if (output->method == FUZZY_CENTROID) {
        return output->span;
    }
    // A partition has the terms of its rules behind its header, too; nobody compares them.
    const uint32_t most = table->form == FUZZY_ANY
                              ? greatest(fuzzy_at(table, output->terms_offset), output->terms)
                              : (UINT32_C(1) << 24) - 1u;
    return (most + (1u << output->fraction) / 2u) >> output->fraction;
}

static void check_value(const fuzzy_table_t *table, int32_t value) {
    const uint64_t most = ((uint64_t)UINT16_MAX << 30) + (UINT64_C(1) << table->fraction) / 2u;
    REQUIRE(value >= table->origin);
    REQUIRE((int64_t)value <= table->origin + (int64_t)(most >> table->fraction));
}

static void check_outputs(const fuzzy_table_t *table, uint32_t is_default, const int32_t *value) {
    REQUIRE(is_default >> table->outputs == 0);
    if (table->form == FUZZY_SURFACE) {
        check_value(table, value[0]);
        return;
    }
    for (uint32_t i = 0; i < table->outputs; i++) {
        const fuzzy_output_t *output = fuzzy_at(table, table->output_offset[i]);
        if ((is_default >> i & 1u) != 0) {
            REQUIRE(value[i] == output->value_default);
        } else {
            REQUIRE(value[i] >= output->origin);
            REQUIRE((int64_t)value[i] <= (int64_t)output->origin + range_of(table, output));
        }
    }
}

static void evaluate(const fuzzy_table_t *table, const int32_t *point) {
    // Exactly as many as the table has, for the sanitizer.
    int32_t *input = malloc(table->inputs * sizeof(int32_t));
    int32_t *output = malloc(table->outputs * sizeof(int32_t));
    REQUIRE(input != NULL && output != NULL);
    memcpy(input, point, table->inputs * sizeof(int32_t));
    check_outputs(table, fuzzy_evaluate(table, input, output), output);
    uint64_t fired = 0;
    REQUIRE(fuzzy_fired(table, input, &fired) <= table->rules);
    free(input);
    free(output);
}

// A node, or beside it.
static int32_t place_of(const fuzzy_table_t *table, uint32_t i, uint32_t *state) {
    const fuzzy_node_t *node = fuzzy_at(table, table->axis[i].offset);
    const uint32_t k = random_u32(state) % (table->axis[i].cells + 1u);
    return (int32_t)((uint32_t)node[k].at + random_u32(state) % 3u - 1u);
}

// An end of a cell, or near it.
static int32_t edge_of(const fuzzy_table_t *table, uint32_t i, uint32_t *state) {
    if (table->form == FUZZY_SURFACE) {
        return place_of(table, i, state);
    }
    const fuzzy_axis_t axis = table->axis[i];
    const uint32_t k = random_u32(state) % axis.cells;
    const fuzzy_cell_t *cell = fuzzy_at(table, axis.offset + k * axis.stride);
    const uint64_t length = (uint64_t)((int64_t)cell->last - cell->first) + 1u;
    switch (random_u32(state) % 4u) {
    case 0:
        return cell->first;
    case 1:
        return cell->last;
    case 2:
        return (int32_t)(cell->first + (int64_t)(length / 2u)); // strengths add up to the most
    default:
        return (int32_t)(cell->first + (int64_t)(random_u32(state) % length));
    }
}

static void evaluate_everywhere(const fuzzy_table_t *table) {
    static const int32_t extreme[] = {INT32_MIN, -1, 0, INT32_MAX};
    int32_t point[FUZZY_MAX_INPUTS];
    for (uint32_t corner = 0; corner < 1u << 2u * table->inputs; corner++) {
        for (uint32_t i = 0; i < table->inputs; i++) {
            point[i] = extreme[corner >> 2u * i & 3u];
        }
        evaluate(table, point);
    }
    uint32_t state = table->crc;
    for (uint32_t k = 0; k < POINTS; k++) {
        for (uint32_t i = 0; i < table->inputs; i++) {
            point[i] = edge_of(table, i, &state);
        }
        evaluate(table, point);
    }
}

static copy_t damaged_case(bytes_t *input, const rule_case_t *one) {
    return damaged_words(input, one->words, one->count);
}

static copy_t damaged_surface(bytes_t *input) {
    load_surface();
    return damaged_words(input, surface_words, SURFACE_WORDS);
}

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t count) {
    bytes_t input = {bytes, count};
    const uint32_t which = take(&input, 1);
    copy_t copy = which == RAW       ? raw_words(&input)
                  : which == SURFACE ? damaged_surface(&input)
                                     : damaged_case(&input, &rule_cases[which % RULE_CASES]);
    make_crc_right(copy, copy.count);
    const fuzzy_table_t *table = (const fuzzy_table_t *)(const void *)copy.words;
    if (fuzzy_table_check(table, copy.count) == FUZZY_TABLE_OK) {
        evaluate_everywhere(table);
    }
    free(copy.words);
    return 0;
}
