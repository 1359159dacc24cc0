// FUZZY_SURFACE: values on a grid, straight lines between them.
#include "surface_case.h"
#include "unity.h"

void setUp(void) {}
void tearDown(void) {}

static int32_t at(int32_t row, int32_t column) {
    const int32_t input[2] = {row, column};
    int32_t output = 0;
    TEST_ASSERT_EQUAL_UINT32(0, fuzzy_evaluate(surface(), input, &output));
    return output;
}

static void test_nodes_have_their_values(void) {
    load_surface();
    TEST_ASSERT_EQUAL_INT(FUZZY_TABLE_OK, fuzzy_table_check(surface(), SURFACE_WORDS));
    for (uint32_t i = 0; i < SURFACE_ROWS; i++) {
        for (uint32_t k = 0; k < SURFACE_COLUMNS; k++) {
            TEST_ASSERT_EQUAL_INT32((int32_t)surface_values[i][k] - 500,
                                    at(rows_at[i], columns_at[k]));
        }
    }
}

static void test_lines_between_nodes(void) {
    load_surface();
    TEST_ASSERT_EQUAL_INT32(-500 + 500, at(-512, INT32_MIN)); // half of 0 .. 1000
    TEST_ASSERT_EQUAL_INT32(-500 + 752, at(1024, INT32_MIN)); // a quarter of 1000 .. 8
    TEST_ASSERT_EQUAL_INT32(-500 + 1600, at(0, 0));           // half of 3000 .. 200, a wide one
    // A third of a narrow one is 10,922 of 32,768; then of both directions.
    TEST_ASSERT_EQUAL_INT32(-500 + 21844, at(-1024, INT32_MIN + 1));
    TEST_ASSERT_EQUAL_INT32(-500 + 11755, at(-512, INT32_MIN + 1));
}

static void test_ends_hold_beyond_them(void) {
    load_surface();
    TEST_ASSERT_EQUAL_INT32(at(-1024, 12345), at(INT32_MIN, 12345));
    TEST_ASSERT_EQUAL_INT32(at(4096, -7), at(INT32_MAX, -7));
    TEST_ASSERT_EQUAL_INT32(65035, at(INT32_MAX, INT32_MAX));
}

// Along a line from a smaller to a larger value nothing turns back, in steps of one count.
static void test_nothing_turns_back(void) {
    load_surface();
    int32_t before = at(0, INT32_MAX);
    for (int32_t row = 0; row <= 4096; row++) {
        const int32_t here = at(row, INT32_MAX);
        TEST_ASSERT_GREATER_OR_EQUAL_INT32(before, here);
        before = here;
    }
}

static void test_fractions_of_a_count(void) {
    load_surface();
    surface()->fraction = 34; // values count a sixteenth
    repair_surface_crc();
    TEST_ASSERT_EQUAL_INT(FUZZY_TABLE_OK, fuzzy_table_check(surface(), SURFACE_WORDS));
    TEST_ASSERT_EQUAL_INT32(-500 + 63, at(0, INT32_MIN)); // 62.5, half up
    surface()->fraction = 29;
    TEST_ASSERT_EQUAL_INT32(-500 + 2000, at(0, INT32_MIN));
}

static void test_no_rules_fire(void) {
    load_surface();
    const int32_t input[2] = {0, 0};
    uint64_t fired = 1;
    TEST_ASSERT_EQUAL_UINT32(0, fuzzy_fired(surface(), input, &fired));
    TEST_ASSERT_TRUE(fired == 0); // no 64 bits in Unity everywhere
}

// What follows is one assignment to a good table, and what the check says then.
#define REFUSED(assignment, verdict)                                                               \
    do {                                                                                           \
        load_surface();                                                                            \
        assignment;                                                                                \
        repair_surface_crc();                                                                      \
        TEST_ASSERT_EQUAL_INT(verdict, fuzzy_table_check(surface(), SURFACE_WORDS));               \
    } while (false)

static void test_shapes_that_are_refused(void) {
    REFUSED(surface()->inputs = 3, FUZZY_TABLE_SHAPE);
    REFUSED(surface()->outputs = 2, FUZZY_TABLE_SHAPE);
    REFUSED(surface()->form = FUZZY_SURFACE + 1, FUZZY_TABLE_SHAPE);
}

static void test_axes_that_are_refused(void) {
    REFUSED(surface()->axis[0].cells = 0, FUZZY_TABLE_CELL);
    REFUSED(surface()->axis[1].cells = 200, FUZZY_TABLE_CELL);
    REFUSED(surface()->axis[0].stride = 4, FUZZY_TABLE_CELL);
    REFUSED(surface()->axis[0].offset = SURFACE_WORDS, FUZZY_TABLE_CELL);
    REFUSED(surface()->axis[0].offset = 2, FUZZY_TABLE_CELL);
    REFUSED(surface_node(0, 1)->at = -1024, FUZZY_TABLE_CELL); // not ascending
    REFUSED(surface_node(0, 2)->at = -2, FUZZY_TABLE_CELL);
    REFUSED(surface_node(0, 0)->shift = 32, FUZZY_TABLE_CELL);
    REFUSED(surface_node(0, 0)->shift++, FUZZY_TABLE_CELL); // its width leaves 32 bits
    REFUSED(surface_node(0, 0)->scale++, FUZZY_TABLE_CELL); // its share would go beyond 1
    REFUSED(surface_node(1, 1)->scale += 2, FUZZY_TABLE_CELL);
}

static void test_outputs_that_are_refused(void) {
    REFUSED(surface()->output_offset[0] = SURFACE_VALUES + 1, FUZZY_TABLE_OUTPUT);
    REFUSED(surface()->output_offset[0] = 15, FUZZY_TABLE_OUTPUT);
    REFUSED(surface()->fraction = 15, FUZZY_TABLE_OUTPUT);
    REFUSED(surface()->fraction = 47, FUZZY_TABLE_OUTPUT);
    REFUSED(surface()->origin = INT32_MAX - 65534, FUZZY_TABLE_OUTPUT);
    REFUSED(surface()->origin = INT32_MAX - 65535, FUZZY_TABLE_OK);
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(test_nodes_have_their_values);
    RUN_TEST(test_lines_between_nodes);
    RUN_TEST(test_ends_hold_beyond_them);
    RUN_TEST(test_nothing_turns_back);
    RUN_TEST(test_fractions_of_a_count);
    RUN_TEST(test_no_rules_fire);
    RUN_TEST(test_shapes_that_are_refused);
    RUN_TEST(test_axes_that_are_refused);
    RUN_TEST(test_outputs_that_are_refused);
    return UNITY_END();
}
