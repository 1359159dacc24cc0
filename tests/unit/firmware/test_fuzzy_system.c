// Fuzzy systems: the same answers everywhere, and tables that are refused.
#include "fuzzy_system_forms.h"

#include <string.h>

#include "crc32.h"
#include "system_cases.h"
#include "unity.h"

void setUp(void) {}
void tearDown(void) {}

enum { ROOM = 2048 };

// A copy of a table to break. It ends where the buffer ends, so that a sanitizer sees every read
// beyond it.
static uint32_t buffer[ROOM];
static uint32_t count;

static uint32_t *words(void) {
    return &buffer[ROOM - count];
}

static fuzzy_system_t *table(void) {
    return (fuzzy_system_t *)(void *)words();
}

static void load(uint32_t which) {
    count = system_cases[which].count;
    TEST_ASSERT_LESS_OR_EQUAL_UINT32(ROOM, count);
    memcpy(words(), system_cases[which].words, count * sizeof(uint32_t));
}

static fuzzy_verdict_t verdict(void) {
    return fuzzy_system_check(table(), count);
}

static void expect(fuzzy_verdict_t expected) {
    table()->crc = crc32_words(words() + 2, count - 2u);
    TEST_ASSERT_EQUAL_INT(expected, verdict());
}

static fuzzy_system_input_t *input(uint32_t index) {
    return (fuzzy_system_input_t *)(void *)(words() + table()->inputs_offset) + index;
}

static fuzzy_system_output_t *output(uint32_t index) {
    return (fuzzy_system_output_t *)(void *)(words() + table()->outputs_offset) + index;
}

static fuzzy_block_t *block(uint32_t index) {
    return (fuzzy_block_t *)(void *)(words() + table()->blocks_offset) + index;
}

static fuzzy_curve_t *curve(uint32_t index, uint32_t term) {
    return (fuzzy_curve_t *)(void *)(words() + input(index)->terms_offset) + term;
}

static int32_t *piece(uint32_t index, uint32_t term) {
    return (int32_t *)(void *)(words() + curve(index, term)->offset);
}

static fuzzy_value_t *value(uint32_t index, uint32_t term) {
    return (fuzzy_value_t *)(void *)(words() + output(index)->terms_offset) + term;
}

static fuzzy_system_rule_t *first_rule(void) {
    return (fuzzy_system_rule_t *)(void *)(words() + table()->rules_offset);
}

static uint16_t *op(uint32_t index) {
    return (uint16_t *)(void *)(first_rule() + 1) + index;
}

static uint16_t *conclusion(uint32_t index) {
    return op((first_rule()->ops + 1u) / 2u * 2u) + index;
}

static void test_the_same_answers_everywhere(void) {
    for (uint32_t i = 0; i < SYSTEM_CASES; i++) {
        const system_case_t *one = &system_cases[i];
        const fuzzy_system_t *system = system_table(one);
        TEST_ASSERT_EQUAL_INT_MESSAGE(FUZZY_TABLE_OK, fuzzy_system_check(system, one->count),
                                      one->name);
        for (uint32_t k = 0; k < one->points_count; k++) {
            int32_t found[FUZZY_MAX_OUTPUTS] = {0};
            const uint32_t is_default = fuzzy_system_evaluate(system, one->points[k].input, found);
            TEST_ASSERT_EQUAL_HEX32_MESSAGE(one->points[k].is_default, is_default, one->name);
            TEST_ASSERT_EQUAL_INT32_ARRAY_MESSAGE(one->points[k].output, found, system->outputs,
                                                  one->name);
        }
    }
}

static void test_inputs_beyond_the_universe_are_its_ends(void) {
    const system_case_t *one = &system_cases[SYSTEM_GAUSSIANS];
    int32_t at_end[FUZZY_MAX_OUTPUTS];
    int32_t beyond[FUZZY_MAX_OUTPUTS];
    const int32_t ends[2][2] = {{0, 32768}, {32768, 0}};
    const int32_t more[2][2] = {{-1, 32769}, {INT32_MAX, INT32_MIN}};
    for (uint32_t i = 0; i < 2u; i++) {
        (void)fuzzy_system_evaluate(system_table(one), ends[i], at_end);
        (void)fuzzy_system_evaluate(system_table(one), more[i], beyond);
        TEST_ASSERT_EQUAL_INT32(at_end[0], beyond[0]);
    }
}

static void test_sizes_and_sums(void) {
    load(SYSTEM_NORMS);
    TEST_ASSERT_EQUAL_INT(FUZZY_TABLE_SIZE, fuzzy_system_check(table(), count - 1u));
    TEST_ASSERT_EQUAL_INT(FUZZY_TABLE_SIZE, fuzzy_system_check(table(), 15));
    table()->magic++;
    TEST_ASSERT_EQUAL_INT(FUZZY_TABLE_MAGIC, verdict());
    table()->magic--;
    words()[count - 1u] ^= 1u;
    TEST_ASSERT_EQUAL_INT(FUZZY_TABLE_CRC, verdict());
}

// What follows is one assignment to a good table, and what the check says then.
#define REFUSED(WHICH, CHANGE, VERDICT)                                                            \
    do {                                                                                           \
        load(WHICH);                                                                               \
        expect(FUZZY_TABLE_OK);                                                                    \
        CHANGE;                                                                                    \
        expect(VERDICT);                                                                           \
    } while (0)

static void test_shapes(void) {
    REFUSED(SYSTEM_NORMS, table()->inputs = 0, FUZZY_TABLE_SHAPE);
    REFUSED(SYSTEM_NORMS, table()->inputs = 9, FUZZY_TABLE_SHAPE);
    REFUSED(SYSTEM_NORMS, table()->outputs = 0, FUZZY_TABLE_SHAPE);
    REFUSED(SYSTEM_NORMS, table()->outputs = 5, FUZZY_TABLE_SHAPE);
    REFUSED(SYSTEM_NORMS, table()->blocks = 0, FUZZY_TABLE_SHAPE);
    REFUSED(SYSTEM_NORMS, table()->rules = 0, FUZZY_TABLE_SHAPE);
    REFUSED(SYSTEM_NORMS, table()->rules = FUZZY_SYSTEM_LISTED + 1u, FUZZY_TABLE_SHAPE);
    REFUSED(SYSTEM_NORMS, table()->inputs_offset = 15, FUZZY_TABLE_SHAPE);
    REFUSED(SYSTEM_NORMS, table()->outputs_offset = (uint16_t)(count - 1u), FUZZY_TABLE_SHAPE);
    REFUSED(SYSTEM_NORMS, table()->blocks_offset = (uint16_t)count, FUZZY_TABLE_SHAPE);
}

static void test_curves(void) {
    REFUSED(SYSTEM_NORMS, input(0)->least = input(0)->most + 1, FUZZY_TABLE_CELL);
    REFUSED(SYSTEM_NORMS, input(0)->terms = 33, FUZZY_TABLE_CELL);
    REFUSED(SYSTEM_NORMS, input(1)->first++, FUZZY_TABLE_CELL);
    REFUSED(SYSTEM_NORMS, input(0)->terms_offset = (uint16_t)(count - 1u), FUZZY_TABLE_CELL);
    REFUSED(SYSTEM_NORMS, curve(0, 0)->degree = 2, FUZZY_TABLE_CELL);
    REFUSED(SYSTEM_NORMS, curve(0, 0)->pieces = 0, FUZZY_TABLE_CELL);
    REFUSED(SYSTEM_NORMS, curve(0, 0)->offset = (uint16_t)(count - 1u), FUZZY_TABLE_CELL);
    REFUSED(SYSTEM_NORMS, piece(0, 0)[0] = input(0)->least - 1, FUZZY_TABLE_CELL);
    REFUSED(SYSTEM_NORMS, piece(0, 0)[0] = input(0)->most + 1, FUZZY_TABLE_CELL);
    REFUSED(SYSTEM_NORMS, piece(0, 0)[1] = 32, FUZZY_TABLE_CELL);
    REFUSED(SYSTEM_NORMS, piece(0, 0)[1] += 2, FUZZY_TABLE_CELL);
    REFUSED(SYSTEM_NORMS, piece(0, 0)[3] = FUZZY_SYSTEM_MAX_SLOPE + 1, FUZZY_TABLE_CELL);
    REFUSED(SYSTEM_NORMS, piece(0, 0)[4] = -FUZZY_SYSTEM_MAX_SLOPE - 1, FUZZY_TABLE_CELL);
    REFUSED(SYSTEM_NORMS, piece(0, 0)[5] = INT32_MIN, FUZZY_TABLE_CELL);
}

static void test_outputs(void) {
    REFUSED(SYSTEM_NORMS, output(0)->method = FUZZY_SYSTEM_METHODS, FUZZY_TABLE_OUTPUT);
    REFUSED(SYSTEM_NORMS, output(0)->aggregation = FUZZY_MINIMUM, FUZZY_TABLE_OUTPUT);
    REFUSED(SYSTEM_NORMS, output(0)->aggregation = FUZZY_S_NORMS_END, FUZZY_TABLE_OUTPUT);
    REFUSED(SYSTEM_NORMS, output(0)->implication = FUZZY_T_NORMS, FUZZY_TABLE_OUTPUT);
    REFUSED(SYSTEM_NORMS, output(0)->terms = 0, FUZZY_TABLE_OUTPUT);
    REFUSED(SYSTEM_NORMS, output(1)->first = 0, FUZZY_TABLE_OUTPUT);
    REFUSED(SYSTEM_NORMS, output(0)->span = UINT32_MAX, FUZZY_TABLE_OUTPUT);
    REFUSED(SYSTEM_NORMS, output(0)->places = 1, FUZZY_TABLE_OUTPUT);
    REFUSED(SYSTEM_NORMS, output(0)->places = FUZZY_SYSTEM_MAX_PLACES + 1u, FUZZY_TABLE_OUTPUT);
    REFUSED(SYSTEM_NORMS, table()->is_listed = 0, FUZZY_TABLE_OUTPUT);
    REFUSED(SYSTEM_NORMS, output(0)->terms_offset = (uint16_t)(count - 1u), FUZZY_TABLE_OUTPUT);
    REFUSED(SYSTEM_EIGHT, output(0)->fraction = 25, FUZZY_TABLE_OUTPUT);
    REFUSED(SYSTEM_EIGHT, output(0)->terms_offset = (uint16_t)(count - 1u), FUZZY_TABLE_OUTPUT);
}

// Of SYSTEM_EIGHT's first output: a constant, a function of an input, a plane; of its second one
// functions of the strength.
static void test_values(void) {
    REFUSED(SYSTEM_EIGHT, value(0, 0)->kind = FUZZY_VALUES, FUZZY_TABLE_OUTPUT);
    REFUSED(SYSTEM_EIGHT, value(0, 0)->value = FUZZY_SYSTEM_MAX_VALUE + 1, FUZZY_TABLE_OUTPUT);
    REFUSED(SYSTEM_EIGHT, value(0, 0)->value = INT32_MIN, FUZZY_TABLE_OUTPUT);
    REFUSED(SYSTEM_EIGHT, value(0, 1)->span = INT32_MAX, FUZZY_TABLE_OUTPUT);
    REFUSED(SYSTEM_EIGHT, value(0, 1)->input = 8, FUZZY_TABLE_OUTPUT);
    REFUSED(SYSTEM_EIGHT, value(0, 1)->curve.degree = 0, FUZZY_TABLE_OUTPUT);
    REFUSED(SYSTEM_EIGHT, value(0, 2)->slopes_offset = count - 1u, FUZZY_TABLE_OUTPUT);
    REFUSED(SYSTEM_EIGHT, value(0, 2)->shift = 32, FUZZY_TABLE_OUTPUT);
    REFUSED(SYSTEM_EIGHT, value(0, 2)->shift = 0, FUZZY_TABLE_OUTPUT);
    REFUSED(SYSTEM_EIGHT, words()[value(0, 2)->slopes_offset] = INT32_MAX, FUZZY_TABLE_OUTPUT);
    REFUSED(SYSTEM_EIGHT, value(1, 0)->value = INT32_MAX, FUZZY_TABLE_OUTPUT);
    REFUSED(SYSTEM_EIGHT, value(1, 0)->curve.offset = 0, FUZZY_TABLE_OUTPUT);
}

static fuzzy_formula_op_t *formula_op(uint32_t index, uint32_t term, uint32_t number) {
    return (fuzzy_formula_op_t *)(void *)(words() + value(index, term)->slopes_offset) + number;
}

// The first op with this code.
static fuzzy_formula_op_t *formula_op_of(uint32_t index, uint32_t term, fuzzy_formula_code_t code) {
    uint32_t number = 0;
    while (number + 1u < value(index, term)->input &&
           formula_op(index, term, number)->code != code) {
        number++;
    }
    TEST_ASSERT_EQUAL_UINT8(code, formula_op(index, term, number)->code);
    return formula_op(index, term, number);
}

// Of SYSTEM_VARIABLES: the first output's terms name inputs, the others' also outputs before them.
static void test_formulas(void) {
    REFUSED(SYSTEM_VARIABLES, value(0, 0)->input = 0, FUZZY_TABLE_OUTPUT);
    REFUSED(SYSTEM_VARIABLES, value(0, 0)->input--, FUZZY_TABLE_OUTPUT);
    REFUSED(SYSTEM_VARIABLES, value(0, 0)->input = FUZZY_FORMULA_OPS + 1u, FUZZY_TABLE_OUTPUT);
    REFUSED(SYSTEM_VARIABLES, value(0, 0)->shift = 63, FUZZY_TABLE_OUTPUT);
    REFUSED(SYSTEM_VARIABLES, value(0, 0)->slopes_offset = count - 1u, FUZZY_TABLE_OUTPUT);
    REFUSED(SYSTEM_VARIABLES, formula_op(0, 0, 0)->code = FUZZY_FORMULA_CODES, FUZZY_TABLE_OUTPUT);
    REFUSED(SYSTEM_VARIABLES, formula_op(0, 0, 0)->code = FUZZY_FORMULA_ADD, FUZZY_TABLE_OUTPUT);
    REFUSED(SYSTEM_VARIABLES, formula_op(0, 0, 0)->code = FUZZY_FORMULA_ABSOLUTE,
            FUZZY_TABLE_OUTPUT);
    REFUSED(SYSTEM_VARIABLES, formula_op(0, 0, 0)->left = 63, FUZZY_TABLE_OUTPUT);
    REFUSED(SYSTEM_VARIABLES, formula_op(0, 0, 0)->right = 63, FUZZY_TABLE_OUTPUT);
    REFUSED(SYSTEM_VARIABLES, formula_op_of(0, 0, FUZZY_FORMULA_INPUT)->number = 3,
            FUZZY_TABLE_OUTPUT);
    REFUSED(SYSTEM_VARIABLES, formula_op_of(0, 0, FUZZY_FORMULA_CURVE)->curve.pieces = 0,
            FUZZY_TABLE_OUTPUT);
}

static void test_formulas_name_outputs_before_their_own(void) {
    REFUSED(SYSTEM_VARIABLES, formula_op_of(1, 0, FUZZY_FORMULA_OUTPUT)->number = 1,
            FUZZY_TABLE_OUTPUT);
    REFUSED(SYSTEM_VARIABLES, formula_op_of(2, 0, FUZZY_FORMULA_OUTPUT)->number = 2,
            FUZZY_TABLE_OUTPUT);
    REFUSED(SYSTEM_VARIABLES, output(1)->method = FUZZY_BY_RULE, FUZZY_TABLE_OUTPUT);
    // An input of more than 2^31 counts would overflow.
    REFUSED(SYSTEM_VARIABLES, (input(2)->least = INT32_MIN, input(2)->most = 1),
            FUZZY_TABLE_OUTPUT);
}

static void test_blocks_and_rules(void) {
    REFUSED(SYSTEM_NORMS, block(0)->and_norm = FUZZY_T_NORMS, FUZZY_TABLE_RULE);
    REFUSED(SYSTEM_NORMS, block(1)->or_norm = FUZZY_MINIMUM, FUZZY_TABLE_RULE);
    REFUSED(SYSTEM_NORMS, block(1)->or_norm = FUZZY_UNBOUNDED_SUM, FUZZY_TABLE_RULE);
    REFUSED(SYSTEM_NORMS, block(0)->implication = FUZZY_MAXIMUM, FUZZY_TABLE_RULE);
    REFUSED(SYSTEM_NORMS, table()->rules_offset = (uint16_t)(count - 1u), FUZZY_TABLE_RULE);
    REFUSED(SYSTEM_NORMS, first_rule()->block = 2, FUZZY_TABLE_RULE);
    REFUSED(SYSTEM_NORMS, first_rule()->weight_q30 = FUZZY_ONE_q30 + 1u, FUZZY_TABLE_RULE);
    REFUSED(SYSTEM_NORMS, first_rule()->ops = 255, FUZZY_TABLE_RULE);
    REFUSED(SYSTEM_NORMS, first_rule()->conclusions = 255, FUZZY_TABLE_RULE);
}

static void test_expressions(void) {
    REFUSED(SYSTEM_NORMS, *op(0) = FUZZY_OPS << 12, FUZZY_TABLE_RULE);
    REFUSED(SYSTEM_NORMS, *op(0) = FUZZY_OP_AND << 12, FUZZY_TABLE_RULE);
    REFUSED(SYSTEM_NORMS, *op(0) = FUZZY_OP_HEDGE << 12, FUZZY_TABLE_RULE);
    REFUSED(SYSTEM_NORMS, *op(0) = FUZZY_OP_INPUT << 12 | 8, FUZZY_TABLE_RULE);
    REFUSED(SYSTEM_NORMS, *op(0) = FUZZY_OP_OUTPUT << 12 | 5, FUZZY_TABLE_RULE);
    REFUSED(SYSTEM_NORMS, *op(2) = FUZZY_OP_ANY << 12, FUZZY_TABLE_RULE);
    REFUSED(SYSTEM_NORMS, *op(2) = FUZZY_OP_HEDGE << 12 | FUZZY_HEDGES, FUZZY_TABLE_RULE);
}

static void test_conclusions(void) {
    REFUSED(SYSTEM_NORMS, *conclusion(0) = 2u << 8, FUZZY_TABLE_RULE);
    REFUSED(SYSTEM_NORMS, *conclusion(0) = 3, FUZZY_TABLE_RULE);
    REFUSED(SYSTEM_NORMS, *conclusion(0) = FUZZY_HEDGES << 12, FUZZY_TABLE_RULE);
    REFUSED(SYSTEM_NORMS, *conclusion(1) = *conclusion(0), FUZZY_TABLE_RULE);
    REFUSED(SYSTEM_NORMS, (*conclusion(0) = FUZZY_ONLY_HEDGE, *conclusion(1) = FUZZY_ONLY_HEDGE),
            FUZZY_TABLE_RULE);
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(test_the_same_answers_everywhere);
    RUN_TEST(test_inputs_beyond_the_universe_are_its_ends);
    RUN_TEST(test_sizes_and_sums);
    RUN_TEST(test_shapes);
    RUN_TEST(test_curves);
    RUN_TEST(test_outputs);
    RUN_TEST(test_values);
    RUN_TEST(test_formulas);
    RUN_TEST(test_formulas_name_outputs_before_their_own);
    RUN_TEST(test_blocks_and_rules);
    RUN_TEST(test_expressions);
    RUN_TEST(test_conclusions);
    return UNITY_END();
}
