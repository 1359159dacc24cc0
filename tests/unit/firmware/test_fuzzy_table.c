#include "fuzzy_table.h"

#include <stddef.h>

#include "crc32.h"
#include "fuzzy.h"
#include "plant_rules.h"
#include "rule_cases.h"
#include "unity.h"

void setUp(void) {}
void tearDown(void) {}

enum { ROOM = 1024 };

// A copy of a table to break. It ends where the buffer ends, so that a sanitizer sees every read
// beyond it.
static uint32_t buffer[ROOM];
static uint32_t count;

static uint32_t *words(void) {
    return &buffer[ROOM - count];
}

static fuzzy_table_t *table(void) {
    return (fuzzy_table_t *)(void *)words();
}

static void load(uint32_t which) {
    const rule_case_t *one = &rule_cases[which];
    TEST_ASSERT_LESS_OR_EQUAL_UINT32(ROOM, one->count);
    count = one->count;
    for (uint32_t i = 0; i < count; i++) {
        words()[i] = one->words[i];
    }
}

static void *at(uint32_t offset) {
    return words() + offset;
}

static fuzzy_pair_cell_t *cell(uint32_t input, uint32_t index) {
    return at(table()->axis[input].offset + index * table()->axis[input].stride);
}

// The first cell in which two sets have a slope.
static fuzzy_pair_cell_t *sloped_cell(void) {
    uint32_t k = 0;
    while (cell(0, k)->cell.ramps < 2u || cell(0, k)->ramp[0].b == 0) {
        k++;
    }
    return cell(0, k);
}

static fuzzy_rule_t *rule(uint32_t index) {
    return (fuzzy_rule_t *)at(table()->rules_offset) + index;
}

static fuzzy_output_t *output(uint32_t index) {
    return at(table()->output_offset[index]);
}

static fuzzy_layer_t *layer(uint32_t index) {
    return (fuzzy_layer_t *)at(output(0)->terms_offset + output(0)->terms) + index;
}

static fuzzy_verdict_t verdict(void) {
    return fuzzy_table_check(table(), count);
}

static void repair_crc(void) {
    table()->crc = crc32_words(words() + 2, table()->size_words - 2u);
}

static void expect(fuzzy_verdict_t expected) {
    repair_crc();
    TEST_ASSERT_EQUAL_INT(expected, verdict());
}

// What follows is one assignment to a good table, and what the check says then.
#define CHANGED(which, expected, assignment)                                                       \
    do {                                                                                           \
        load(which);                                                                               \
        assignment;                                                                                \
        expect(expected);                                                                          \
    } while (0)

// ---- what is accepted ---------------------------------------------------------------------------

static void test_good_tables_are_accepted(void) {
    const fuzzy_table_t *shipped = (const fuzzy_table_t *)(const void *)plant_rules_table;
    TEST_ASSERT_EQUAL_INT(FUZZY_TABLE_OK, fuzzy_table_check(shipped, shipped->size_words));
    for (uint32_t i = 0; i < RULE_CASES; i++) {
        load(i);
        TEST_ASSERT_EQUAL_INT_MESSAGE(FUZZY_TABLE_OK, verdict(), rule_cases[i].name);
        expect(FUZZY_TABLE_OK);
    }
}

static void test_words_behind_the_table_do_not_matter(void) {
    load(CASE_ONE);
    const uint32_t size = count;
    count += 3u;
    for (uint32_t i = 0; i < size; i++) {
        words()[i] = rule_cases[CASE_ONE].words[i];
    }
    for (uint32_t i = size; i < count; i++) {
        words()[i] = 0xDEADBEEFu;
    }
    TEST_ASSERT_EQUAL_INT(FUZZY_TABLE_OK, verdict());
}

// ---- as a whole ---------------------------------------------------------------------------------

static void test_every_shorter_length_is_refused(void) {
    for (uint32_t i = 0; i < RULE_CASES; i++) {
        for (uint32_t length = 0; length < rule_cases[i].count; length += length < 20u ? 1u : 37u) {
            count = length;
            for (uint32_t k = 0; k < length; k++) {
                words()[k] = rule_cases[i].words[k];
            }
            TEST_ASSERT_EQUAL_INT(FUZZY_TABLE_SIZE, verdict());
        }
    }
}

// With its checksum made right, a table that says it is shorter lacks its end.
static void test_a_table_that_ends_early_is_refused(void) {
    for (uint32_t i = 0; i < RULE_CASES; i++) {
        for (uint32_t size = 16; size < rule_cases[i].count; size++) {
            count = size;
            for (uint32_t k = 0; k < size; k++) {
                words()[k] = rule_cases[i].words[k];
            }
            table()->size_words = size;
            repair_crc();
            TEST_ASSERT_NOT_EQUAL(FUZZY_TABLE_OK, verdict());
        }
    }
}

static void test_sizes_that_no_table_has_are_refused(void) {
    load(CASE_ONE);
    const uint32_t sizes[] = {0, 1, 15, count + 1u, FUZZY_MAX_WORDS + 1u, UINT32_MAX};
    for (uint32_t i = 0; i < sizeof sizes / sizeof sizes[0]; i++) {
        table()->size_words = sizes[i];
        TEST_ASSERT_EQUAL_INT(FUZZY_TABLE_SIZE, verdict());
    }
}

// The size is looked at before the words are: so many are not there.
static void test_a_size_beyond_the_largest_table_is_refused(void) {
    load(CASE_ONE);
    table()->size_words = FUZZY_MAX_WORDS + 1u;
    TEST_ASSERT_EQUAL_INT(FUZZY_TABLE_SIZE, fuzzy_table_check(table(), FUZZY_MAX_WORDS + 1u));
}

static void test_another_magic_is_refused(void) {
    CHANGED(CASE_ONE, FUZZY_TABLE_MAGIC, table()->magic++);
    CHANGED(CASE_ONE, FUZZY_TABLE_MAGIC, table()->magic = 0);
}

static void test_a_header_alone_has_the_size_of_a_table(void) {
    count = 16;
    for (uint32_t i = 0; i < count; i++) {
        words()[i] = rule_cases[CASE_ONE].words[i];
    }
    table()->size_words = count;
    expect(FUZZY_TABLE_CELL);
}

static void test_every_flipped_bit_is_refused(void) {
    const uint32_t which[] = {CASE_ONE, CASE_MAX_Q15};
    for (uint32_t i = 0; i < 2u; i++) {
        load(which[i]);
        for (uint32_t bit = 0; bit < 32u * count; bit++) {
            words()[bit / 32u] ^= 1u << bit % 32u;
            const fuzzy_verdict_t found = verdict();
            const fuzzy_verdict_t expected = bit / 32u == 0              ? FUZZY_TABLE_MAGIC
                                             : bit / 32u != 2            ? FUZZY_TABLE_CRC
                                             : found == FUZZY_TABLE_SIZE ? FUZZY_TABLE_SIZE
                                                                         : FUZZY_TABLE_CRC;
            TEST_ASSERT_EQUAL_INT(expected, found);
            words()[bit / 32u] ^= 1u << bit % 32u;
        }
        TEST_ASSERT_EQUAL_INT(FUZZY_TABLE_OK, verdict());
    }
}

// ---- numbers of things --------------------------------------------------------------------------

static void test_numbers_of_inputs_and_outputs(void) {
    CHANGED(CASE_GENERAL, FUZZY_TABLE_SHAPE, table()->inputs = 0);
    CHANGED(CASE_GENERAL, FUZZY_TABLE_SHAPE, table()->inputs = 5);
    CHANGED(CASE_GENERAL, FUZZY_TABLE_SHAPE, table()->outputs = 0);
    CHANGED(CASE_GENERAL, FUZZY_TABLE_SHAPE, table()->outputs = 5);
    CHANGED(CASE_SUM_Q15, FUZZY_TABLE_SHAPE, table()->inputs = 1);
    CHANGED(CASE_GENERAL, FUZZY_TABLE_SHAPE, table()->form = FUZZY_PARTITION_MAX);
    CHANGED(CASE_GRID_Q15, FUZZY_TABLE_SHAPE, table()->form = FUZZY_PARTITION_SUM);
    CHANGED(CASE_MAX_Q15, FUZZY_TABLE_SHAPE, table()->outputs = 2);
    CHANGED(CASE_MAX_Q15, FUZZY_TABLE_SHAPE, table()->form = FUZZY_SURFACE + 1);
}

static void test_bits_of_memberships(void) {
    CHANGED(CASE_ONE, FUZZY_TABLE_SHAPE, table()->bits = FUZZY_MIN_BITS - 1u);
    CHANGED(CASE_ONE, FUZZY_TABLE_SHAPE, table()->bits = FUZZY_MAX_BITS + 1u);
    CHANGED(CASE_ONE, FUZZY_TABLE_SHAPE, table()->bits--);
    CHANGED(CASE_ONE, FUZZY_TABLE_SHAPE, (table()->bits = 15, table()->one = 1u << 15));
    CHANGED(CASE_ONE, FUZZY_TABLE_SHAPE, (table()->bits = 29, table()->one = 1u << 29));
    CHANGED(CASE_ONE, FUZZY_TABLE_SHAPE, table()->one *= 2u);
    // A partition computes in 32 bits.
    CHANGED(CASE_SUM_WIDE, FUZZY_TABLE_SHAPE, (table()->bits = 21, table()->one = 1u << 21));
}

static void test_numbers_of_rules(void) {
    CHANGED(CASE_ONE, FUZZY_TABLE_SHAPE, table()->rules = 0);
    CHANGED(CASE_ONE, FUZZY_TABLE_SHAPE, table()->rules = FUZZY_MAX_RULES + 1u);
    CHANGED(CASE_ONE, FUZZY_TABLE_RULE, table()->rules = FUZZY_MAX_RULES);
}

// ---- cells --------------------------------------------------------------------------------------

static void test_places_and_sizes_of_cells(void) {
    CHANGED(CASE_GENERAL, FUZZY_TABLE_CELL, table()->axis[1].cells = 0);
    CHANGED(CASE_GENERAL, FUZZY_TABLE_CELL, table()->axis[1].stride = 0);
    CHANGED(CASE_GENERAL, FUZZY_TABLE_CELL, table()->axis[1].stride = 8);
    CHANGED(CASE_GENERAL, FUZZY_TABLE_CELL, table()->axis[1].stride++);
    CHANGED(CASE_GENERAL, FUZZY_TABLE_CELL, table()->axis[1].offset = 15);
    CHANGED(CASE_GENERAL, FUZZY_TABLE_CELL, table()->axis[1].offset = 65535);
    CHANGED(CASE_GENERAL, FUZZY_TABLE_CELL, table()->axis[1].offset = (uint16_t)(count - 1u));
    CHANGED(CASE_GRID_Q15, FUZZY_TABLE_CELL, table()->axis[0].stride = 16);
    CHANGED(CASE_MAX_Q15, FUZZY_TABLE_CELL, table()->axis[1].cells--);
    CHANGED(CASE_MAX_Q15, FUZZY_TABLE_CELL, table()->axis[1].cells++);
}

static void test_cells_cover_all_integers_once(void) {
    CHANGED(CASE_MAX_Q15, FUZZY_TABLE_CELL, cell(0, 0)->cell.first++);
    CHANGED(CASE_MAX_Q15, FUZZY_TABLE_CELL, cell(1, 1)->cell.first++);
    CHANGED(CASE_MAX_Q15, FUZZY_TABLE_CELL, cell(1, 1)->cell.first--);
    CHANGED(CASE_MAX_Q15, FUZZY_TABLE_CELL, cell(1, 1)->cell.last++);
    CHANGED(CASE_MAX_Q15, FUZZY_TABLE_CELL, cell(1, 1)->cell.last = INT32_MIN);
    CHANGED(CASE_MAX_Q15, FUZZY_TABLE_CELL,
            cell(1, table()->axis[1].cells - 1u)->cell.last = INT32_MAX - 1);
}

// The first input with these cells alone, without any set.
static void make_cells(const int32_t first[], const int32_t last[], uint32_t cells) {
    load(CASE_GRID_PHYSICAL);
    TEST_ASSERT_GREATER_OR_EQUAL_UINT32(cells, table()->axis[0].cells);
    table()->axis[0].cells = (uint8_t)cells;
    for (uint32_t k = 0; k < cells; k++) {
        *cell(0, k) = (fuzzy_pair_cell_t){.cell = {.last = last[k], .first = first[k]}};
    }
}

static void test_cells_do_not_run_backwards(void) {
    make_cells((const int32_t[]){INT32_MIN, 11, 20}, (const int32_t[]){10, 19, INT32_MAX}, 3);
    expect(FUZZY_TABLE_OK);
    make_cells((const int32_t[]){INT32_MIN, 11, 12}, (const int32_t[]){10, 11, INT32_MAX}, 3);
    expect(FUZZY_TABLE_OK);
    make_cells((const int32_t[]){INT32_MIN, 11, 6}, (const int32_t[]){10, 5, INT32_MAX}, 3);
    expect(FUZZY_TABLE_CELL);
}

static void test_a_slope_reaches_over_31_bits_at_most(void) {
    make_cells((const int32_t[]){INT32_MIN, 0}, (const int32_t[]){-1, INT32_MAX}, 2);
    cell(0, 0)->cell.ramps = 1;
    cell(0, 0)->ramp[0].b = 1;
    expect(FUZZY_TABLE_OK);
    make_cells((const int32_t[]){INT32_MIN, 1}, (const int32_t[]){0, INT32_MAX}, 2);
    cell(0, 0)->cell.ramps = 1;
    cell(0, 0)->ramp[0].b = 1;
    expect(FUZZY_TABLE_CELL);
}

static void test_ramps_of_a_cell(void) {
    CHANGED(CASE_GRID_Q15, FUZZY_TABLE_CELL, cell(0, 0)->cell.shift = 32);
    CHANGED(CASE_GRID_Q15, FUZZY_TABLE_OK, cell(0, 0)->cell.shift = 31);
    CHANGED(CASE_LIMITS, FUZZY_TABLE_CELL, sloped_cell()->cell.ramps = 8);
    // What no ramp names is not read where the base has no grid.
    CHANGED(CASE_ONE, FUZZY_TABLE_OK, cell(0, 0)->ramp[1].set = UINT32_MAX);
    CHANGED(CASE_GRID_Q15, FUZZY_TABLE_CELL, sloped_cell()->cell.ramps = 3);
    CHANGED(CASE_GENERAL, FUZZY_TABLE_CELL, cell(0, 0)->cell.ramps = UINT32_MAX);
    CHANGED(CASE_GRID_Q15, FUZZY_TABLE_CELL, sloped_cell()->cell.shift = 32);
    // A slope over 2^31 steps would leave 32 bits.
    CHANGED(CASE_GRID_Q15, FUZZY_TABLE_CELL, sloped_cell()->cell.shift = 31);
    CHANGED(CASE_GRID_Q15, FUZZY_TABLE_CELL, sloped_cell()->ramp[1].set = FUZZY_MAX_SETS);
    CHANGED(CASE_GRID_Q15, FUZZY_TABLE_CELL, sloped_cell()->ramp[0].set = UINT32_MAX);
}

static void test_memberships_stay_between_0_and_1(void) {
    const uint32_t high = 1u << 28;
    CHANGED(CASE_GRID_Q15, FUZZY_TABLE_CELL, sloped_cell()->ramp[0].a_high = -1);
    CHANGED(CASE_GRID_Q15, FUZZY_TABLE_CELL, sloped_cell()->ramp[0].a_high = (int32_t)high + 1);
    CHANGED(CASE_GRID_Q15, FUZZY_TABLE_CELL, sloped_cell()->ramp[0].a_high = INT32_MIN);
    CHANGED(CASE_GRID_Q15, FUZZY_TABLE_CELL, sloped_cell()->ramp[0].b = INT32_MIN);
    CHANGED(CASE_GRID_Q15, FUZZY_TABLE_CELL, sloped_cell()->ramp[1].b = INT32_MAX);
    CHANGED(CASE_GRID_Q15, FUZZY_TABLE_CELL, sloped_cell()->ramp[0].b *= 2);
}

static void test_memberships_of_a_partition_add_up_to_1(void) {
    CHANGED(CASE_MAX_Q15, FUZZY_TABLE_CELL, sloped_cell()->ramp[0].a_low ^= 1u);
    CHANGED(CASE_MAX_Q15, FUZZY_TABLE_CELL, sloped_cell()->ramp[1].b++);
    CHANGED(CASE_MAX_Q15, FUZZY_TABLE_CELL, sloped_cell()->ramp[1].set++);
    CHANGED(CASE_MAX_Q15, FUZZY_TABLE_CELL, sloped_cell()->cell.ramps = 0);
    CHANGED(CASE_MAX_Q15, FUZZY_TABLE_CELL, sloped_cell()->cell.ramps = 1);
    CHANGED(CASE_MAX_Q15, FUZZY_TABLE_CELL, cell(0, 0)->ramp[0].a_high--);
}

// ---- outputs ------------------------------------------------------------------------------------

static void test_places_of_outputs(void) {
    CHANGED(CASE_GENERAL, FUZZY_TABLE_OUTPUT, table()->output_offset[1] = 0);
    CHANGED(CASE_GENERAL, FUZZY_TABLE_OUTPUT, table()->output_offset[1] = count - 7u);
    CHANGED(CASE_GENERAL, FUZZY_TABLE_OUTPUT, table()->output_offset[1] = UINT32_MAX);
}

static void test_terms_of_an_output(void) {
    CHANGED(CASE_GENERAL, FUZZY_TABLE_OUTPUT, output(0)->method = FUZZY_CENTROID + 1u);
    CHANGED(CASE_GENERAL, FUZZY_TABLE_OUTPUT, output(0)->terms = 0);
    CHANGED(CASE_GENERAL, FUZZY_TABLE_OUTPUT, output(0)->terms = FUZZY_MAX_TERMS + 1u);
    CHANGED(CASE_GENERAL, FUZZY_TABLE_OUTPUT, output(0)->terms_offset = 15);
    CHANGED(CASE_GENERAL, FUZZY_TABLE_OUTPUT, output(0)->terms_offset = UINT32_MAX);
    CHANGED(CASE_GENERAL, FUZZY_TABLE_OUTPUT, output(0)->terms_offset = count - 2u);
    CHANGED(CASE_GENERAL, FUZZY_TABLE_OUTPUT, *(uint32_t *)at(output(0)->terms_offset) = 1u << 24);
    CHANGED(CASE_GENERAL, FUZZY_TABLE_OUTPUT, output(0)->origin = INT32_MAX - (1 << 24) + 1);
    CHANGED(CASE_GENERAL, FUZZY_TABLE_OK, output(0)->origin = INT32_MAX - (1 << 24));
}

static void test_values_of_a_partition(void) {
    const uint32_t beyond = 10; // the second row and column are read from the last place, too
    CHANGED(CASE_SUM_Q15, FUZZY_TABLE_OUTPUT, words()[16] = 1u << 24);
    CHANGED(CASE_SUM_Q15, FUZZY_TABLE_OUTPUT, words()[16u + 3u * 8u + 4u + beyond - 2u] = 1u << 24);
    // A quotient of 43 bits by 21.
    CHANGED(CASE_SUM_WIDE, FUZZY_TABLE_OUTPUT, words()[16] = 1u << 24);
    CHANGED(CASE_SUM_FINE, FUZZY_TABLE_OK, words()[16] = (1u << 24) - 1u);
    CHANGED(CASE_CENTROID_Q15, FUZZY_TABLE_OUTPUT, words()[16] = output(0)->terms);
}

// Everywhere the given value, and, in every cell with two sets, both at 1/2: strengths add up to
// the most that they can.
static void make_full_partition(uint32_t value, uint8_t bits, uint8_t fraction) {
    load(CASE_SUM_WIDE);
    table()->bits = bits;
    table()->one = 1u << bits;
    table()->fraction = fraction;
    output(0)->fraction = fraction;
    for (uint32_t i = 0; i < 5u * FUZZY_GRID_STRIDE; i++) {
        words()[16u + i] = value;
    }
    const int32_t half = (int32_t)(table()->one / 2u);
    for (uint32_t i = 0; i < 2u; i++) {
        for (uint32_t k = 0; k < table()->axis[i].cells; k++) {
            fuzzy_ramp_t *ramp = cell(i, k)->ramp;
            if (cell(i, k)->cell.ramps == 1u) {
                ramp[0].a_high = 2 * half;
            } else {
                ramp[0] = (fuzzy_ramp_t){.a_low = 0, .a_high = half, .set = ramp[0].set};
                ramp[1] = (fuzzy_ramp_t){.a_low = UINT32_MAX, .a_high = half, .set = ramp[1].set};
            }
        }
    }
    repair_crc();
}

static void test_largest_values_of_a_partition_are_averaged(void) {
    const int32_t input[] = {5000, 5000};
    for (uint8_t fraction = 0; fraction <= 2u; fraction++) {
        uint32_t value = 1u << 24;
        make_full_partition(value, 18, fraction);
        TEST_ASSERT_EQUAL_INT(FUZZY_TABLE_OUTPUT, verdict());
        while (verdict() != FUZZY_TABLE_OK) {
            make_full_partition(--value, 18, fraction);
        }
        TEST_ASSERT_GREATER_THAN_UINT32((1u << 24) - 4u, value);
        int32_t found = -1;
        TEST_ASSERT_EQUAL_UINT32(0, fuzzy_evaluate(table(), input, &found));
        const uint32_t to_nearest = (value + (1u << fraction) / 2u) >> fraction;
        TEST_ASSERT_EQUAL_INT32(table()->origin + (int32_t)to_nearest, found);
    }
}

static void test_bits_of_a_partition_and_of_its_fraction_are_20_at_most(void) {
    const uint8_t good[][2] = {{16, 4}, {18, 2}, {20, 0}};
    for (uint32_t i = 0; i < 3u; i++) {
        make_full_partition(1000, good[i][0], good[i][1]);
        TEST_ASSERT_EQUAL_INT(FUZZY_TABLE_OK, verdict());
        make_full_partition(1000, good[i][0], (uint8_t)(good[i][1] + 1u));
        TEST_ASSERT_EQUAL_INT(FUZZY_TABLE_OUTPUT, verdict());
    }
    make_full_partition(1000, 21, 0);
    TEST_ASSERT_EQUAL_INT(FUZZY_TABLE_SHAPE, verdict());
    // Neither header alone says what the fraction is.
    CHANGED(CASE_SUM_Q15, FUZZY_TABLE_OUTPUT, table()->fraction = 1);
    CHANGED(CASE_SUM_Q15, FUZZY_TABLE_OUTPUT, output(0)->fraction = 1);
    CHANGED(CASE_GENERAL, FUZZY_TABLE_OK, output(0)->fraction = FUZZY_MAX_FRACTION);
    CHANGED(CASE_GENERAL, FUZZY_TABLE_OUTPUT, output(0)->fraction = FUZZY_MAX_FRACTION + 1u);
}

static void test_header_of_a_partition_agrees_with_its_output(void) {
    CHANGED(CASE_SUM_Q15, FUZZY_TABLE_OUTPUT, table()->origin++);
    CHANGED(CASE_SUM_Q15, FUZZY_TABLE_OUTPUT, output(0)->method = FUZZY_MAX);
    CHANGED(CASE_SEVEN, FUZZY_TABLE_OUTPUT, table()->fraction = 1);
    CHANGED(CASE_SEVEN, FUZZY_TABLE_OUTPUT, (table()->fraction = 5, output(0)->fraction = 5));
    CHANGED(CASE_GENERAL, FUZZY_TABLE_OUTPUT, output(0)->fraction = FUZZY_MAX_FRACTION + 1u);
    CHANGED(CASE_MAX_Q15, FUZZY_TABLE_OUTPUT, table()->form = FUZZY_PARTITION_SUM);
    CHANGED(CASE_MAX_Q15, FUZZY_TABLE_OUTPUT, table()->twins_offset = 0);
    CHANGED(CASE_MAX_Q15, FUZZY_TABLE_OUTPUT, table()->twins_offset = (uint16_t)(count - 20u));
}

static void test_sets_of_a_centroid(void) {
    CHANGED(CASE_OVERLAPS, FUZZY_TABLE_OUTPUT, output(0)->terms = FUZZY_MAX_SETS + 1u);
    CHANGED(CASE_OVERLAPS, FUZZY_TABLE_OUTPUT, output(0)->span = 0);
    CHANGED(CASE_OVERLAPS, FUZZY_TABLE_OUTPUT, output(0)->span = 1u << 24);
    CHANGED(CASE_OVERLAPS, FUZZY_TABLE_OUTPUT,
            table()->origin = output(0)->origin = INT32_MAX - (int32_t)output(0)->span + 1);
    CHANGED(CASE_OVERLAPS, FUZZY_TABLE_OUTPUT, output(0)->term_layers = output(0)->layers + 1u);
    CHANGED(CASE_OVERLAPS, FUZZY_TABLE_OUTPUT, output(0)->layers = UINT16_MAX);
    CHANGED(CASE_OVERLAPS, FUZZY_TABLE_OK, output(0)->layers = (uint16_t)output(0)->term_layers);
    CHANGED(CASE_OVERLAPS, FUZZY_TABLE_OUTPUT,
            *(uint32_t *)at(output(0)->terms_offset) = table()->one + 1u);
}

static void test_steep_flanks(void) {
    CHANGED(CASE_STACKED, FUZZY_TABLE_OUTPUT, layer(0)->steep = 32);
    CHANGED(CASE_STACKED, FUZZY_TABLE_OK, layer(0)->steep = 31);
    CHANGED(CASE_OVERLAPS, FUZZY_TABLE_OUTPUT, layer(0)->steep = 1); // a partition has none
}

static void test_layers_of_a_centroid(void) {
    const uint32_t first = 0;
    CHANGED(CASE_OVERLAPS, FUZZY_TABLE_OUTPUT, layer(first)->second = output(0)->terms);
    CHANGED(CASE_OVERLAPS, FUZZY_TABLE_OUTPUT, layer(first)->second = 1);
    CHANGED(CASE_OVERLAPS, FUZZY_TABLE_OUTPUT, layer(first)->start = table()->one + 1u);
    CHANGED(CASE_OVERLAPS, FUZZY_TABLE_OUTPUT, layer(first)->height = table()->one + 1u);
    CHANGED(CASE_OVERLAPS, FUZZY_TABLE_OUTPUT, layer(first)->height = UINT32_MAX);
    CHANGED(CASE_OVERLAPS, FUZZY_TABLE_OK,
            (layer(first)->start = table()->one, layer(first)->height = 0));
    CHANGED(CASE_OVERLAPS, FUZZY_TABLE_OUTPUT,
            layer(output(0)->term_layers)->second = output(0)->terms);
    CHANGED(CASE_OVERLAPS, FUZZY_TABLE_OUTPUT,
            layer(output(0)->term_layers)->first = layer(output(0)->term_layers)->second);
    CHANGED(CASE_OVERLAPS, FUZZY_TABLE_OUTPUT, layer(output(0)->term_layers)->first = UINT8_MAX);
}

// ---- rules --------------------------------------------------------------------------------------

static void test_places_of_rules(void) {
    CHANGED(CASE_GENERAL, FUZZY_TABLE_RULE, table()->rules_offset = 15);
    CHANGED(CASE_GENERAL, FUZZY_TABLE_RULE, table()->rules_offset = (uint16_t)(count - 3u));
    CHANGED(CASE_GENERAL, FUZZY_TABLE_RULE, table()->rules_offset = UINT16_MAX);
}

static void test_weights_and_conditions_of_a_rule(void) {
    const uint32_t one = FUZZY_WEIGHT_ONE_q19;
    CHANGED(CASE_GENERAL, FUZZY_TABLE_RULE, rule(1)->head = (one + 1u) | 2u << 24);
    CHANGED(CASE_GENERAL, FUZZY_TABLE_RULE, rule(1)->head = one);
    CHANGED(CASE_GENERAL, FUZZY_TABLE_RULE, rule(1)->head = one | 9u << 24);
    CHANGED(CASE_GENERAL, FUZZY_TABLE_OK, rule(1)->head = one | 8u << 24);
    CHANGED(CASE_GENERAL, FUZZY_TABLE_RULE, rule(1)->head = one | 255u << 24);
    CHANGED(CASE_GENERAL, FUZZY_TABLE_RULE, rule(1)->condition[1] = 3u << 3);
    CHANGED(CASE_GENERAL, FUZZY_TABLE_RULE, rule(1)->condition[1] = 15u << 3);
    CHANGED(CASE_GENERAL, FUZZY_TABLE_RULE, rule(1)->condition[0] = 7);
}

static void test_conclusions_of_a_rule(void) {
    CHANGED(CASE_GENERAL, FUZZY_TABLE_RULE, rule(4)->conclusion[0] = 3);
    CHANGED(CASE_GENERAL, FUZZY_TABLE_RULE, rule(4)->conclusion[0] = FUZZY_NO_TERM - 1u);
    CHANGED(CASE_GENERAL, FUZZY_TABLE_OK, rule(4)->conclusion[0] = FUZZY_NO_TERM);
}

// ---- what was damaged after its check -----------------------------------------------------------

enum { SPOIL_SET = 0x100, SPOIL_TERM = 0x08, SPOIL_TERM_OF_MANY = 0x40, SPOIL_GRID = 0x10 };

static void evaluate(int32_t step, int32_t out[FUZZY_MAX_OUTPUTS]) {
    const int32_t input[FUZZY_MAX_INPUTS] = {step * 1999999, step * 29999, step * 77, step * 13};
    (void)fuzzy_evaluate(table(), input, out);
}

static void spoil_sets(void) {
    for (uint32_t i = 0; i < table()->inputs; i++) {
        for (uint32_t k = 0; k < table()->axis[i].cells; k++) {
            fuzzy_cell_t *one = &cell(i, k)->cell;
            fuzzy_ramp_t *ramp = (fuzzy_ramp_t *)(void *)(one + 1); // as many as it says
            for (uint32_t j = 0; j < one->ramps; j++) {
                ramp[j].set |= SPOIL_SET;
            }
        }
    }
}

static void spoil_conclusions(void) {
    for (uint32_t i = 0; i < table()->rules; i++) {
        for (uint32_t k = 0; k < table()->outputs; k++) {
            const uint8_t method = output(k)->method;
            uint8_t *term = &rule(i)->conclusion[k];
            const uint8_t bit = method == FUZZY_MAX ? SPOIL_TERM_OF_MANY : SPOIL_TERM;
            *term |= *term == FUZZY_NO_TERM || method == FUZZY_SUM ? 0 : bit;
        }
    }
}

// Terms of a grid of sets: words right behind the header, up to the first cell.
static void spoil_grid(void) {
    for (uint32_t i = FUZZY_HEADER_WORDS; i < table()->axis[0].offset; i++) {
        words()[i] |= SPOIL_GRID;
    }
}

static void spoil(void) {
    if (table()->form == FUZZY_PARTITION_CENTROID) {
        spoil_grid();
    } else if (table()->form == FUZZY_ANY) {
        spoil_sets();
        spoil_conclusions();
    }
}

// A term or set beyond those that there can be counts as one of them: nothing is written elsewhere,
// which a sanitizer would see.
static void test_a_damaged_table_leads_no_write_astray(void) {
    for (uint32_t which = 0; which < RULE_CASES; which++) {
        for (int32_t step = 0; step < 30; step++) {
            int32_t good[FUZZY_MAX_OUTPUTS] = {0};
            int32_t spoilt[FUZZY_MAX_OUTPUTS] = {0};
            load(which);
            evaluate(step, good);
            spoil();
            evaluate(step, spoilt);
            TEST_ASSERT_EQUAL_INT32_ARRAY_MESSAGE(good, spoilt, FUZZY_MAX_OUTPUTS,
                                                  rule_cases[which].name);
        }
    }
}

static void test_no_more_outputs_are_written_than_there_can_be(void) {
    int32_t out[2 * FUZZY_MAX_OUTPUTS] = {0};
    load(CASE_GENERAL);
    for (uint32_t i = 1; i < FUZZY_MAX_OUTPUTS; i++) {
        table()->output_offset[i] = table()->output_offset[0];
    }
    table()->outputs = UINT8_MAX;
    evaluate(1, out);
    for (uint32_t i = FUZZY_MAX_OUTPUTS; i < 2u * FUZZY_MAX_OUTPUTS; i++) {
        TEST_ASSERT_EQUAL_INT32(0, out[i]);
    }
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(test_good_tables_are_accepted);
    RUN_TEST(test_words_behind_the_table_do_not_matter);
    RUN_TEST(test_every_shorter_length_is_refused);
    RUN_TEST(test_a_table_that_ends_early_is_refused);
    RUN_TEST(test_sizes_that_no_table_has_are_refused);
    RUN_TEST(test_a_size_beyond_the_largest_table_is_refused);
    RUN_TEST(test_another_magic_is_refused);
    RUN_TEST(test_a_header_alone_has_the_size_of_a_table);
    RUN_TEST(test_every_flipped_bit_is_refused);
    RUN_TEST(test_numbers_of_inputs_and_outputs);
    RUN_TEST(test_bits_of_memberships);
    RUN_TEST(test_numbers_of_rules);
    RUN_TEST(test_places_and_sizes_of_cells);
    RUN_TEST(test_cells_cover_all_integers_once);
    RUN_TEST(test_cells_do_not_run_backwards);
    RUN_TEST(test_a_slope_reaches_over_31_bits_at_most);
    RUN_TEST(test_ramps_of_a_cell);
    RUN_TEST(test_memberships_stay_between_0_and_1);
    RUN_TEST(test_memberships_of_a_partition_add_up_to_1);
    RUN_TEST(test_places_of_outputs);
    RUN_TEST(test_terms_of_an_output);
    RUN_TEST(test_values_of_a_partition);
    RUN_TEST(test_largest_values_of_a_partition_are_averaged);
    RUN_TEST(test_bits_of_a_partition_and_of_its_fraction_are_20_at_most);
    RUN_TEST(test_header_of_a_partition_agrees_with_its_output);
    RUN_TEST(test_sets_of_a_centroid);
    RUN_TEST(test_steep_flanks);
    RUN_TEST(test_layers_of_a_centroid);
    RUN_TEST(test_places_of_rules);
    RUN_TEST(test_weights_and_conditions_of_a_rule);
    RUN_TEST(test_conclusions_of_a_rule);
    RUN_TEST(test_a_damaged_table_leads_no_write_astray);
    RUN_TEST(test_no_more_outputs_are_written_than_there_can_be);
    return UNITY_END();
}
