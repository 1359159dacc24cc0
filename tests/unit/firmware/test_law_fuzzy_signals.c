// Law fuzzy_signals: a table by hand, what its check refuses, and what a tick makes of it.
#include <stddef.h>
#include <string.h>

#include "crc32.h"
#include "fuzzy.h"
#include "law.h"
#include "sections.h"
#include "unity.h"
#include "view_signal.h"

#define MAGIC UINT32_C(0x31534651)

enum { VELOCITY = 1, FORCE = 5, ROOM = 2 * QUIESCE_TABLE_WORDS };

extern const law_t law_fuzzy_signals;

static const law_t *const law = &law_fuzzy_signals;
static law_setup_t setup;
static uint64_t state[LAW_STATE_BYTES / sizeof(uint64_t)];
static view_t view;
static law_demand_t demand;
static uint32_t words[ROOM];
static uint32_t count;
static uint32_t rules_at; ///< where the rules of the section begin that was put last
static uint32_t seed;

void setUp(void) {
    quiesce_params_default(&setup.params);
    setup.table = words;
    memset(state, 0, sizeof state);
    view = (view_t){.valid = ~UINT64_C(0), .is_output_on = true};
    count = 0;
    seed = 7;
}
void tearDown(void) {}

static int32_t random_within(int32_t limit) {
    seed = seed * 1664525u + 1013904223u;
    return (int32_t)((seed ^ seed >> 15) % (2u * (uint32_t)limit + 1u)) - limit;
}

// ---- making tables ------------------------------------------------------------------------------

static void put(int32_t word) {
    words[count++] = (uint32_t)word;
}

static void put_all(const int32_t *values, uint32_t number) {
    for (uint32_t i = 0; i < number; i++) {
        put(values[i]);
    }
}

#define PUT(...)                                                                                   \
    do {                                                                                           \
        const int32_t values[] = {__VA_ARGS__};                                                    \
        put_all(values, sizeof values / sizeof values[0]);                                         \
    } while (0)

enum { ONE = 65536, WEIGHT = 1 << 19, EDGE = 1024 };

static void seal_rules(void) {
    words[rules_at + 1u] = crc32_words(&words[rules_at + 2u], words[rules_at + 2u] - 2u);
}

// Over x: set 0 up to -1024, set 1 from 1024 on, straight lines between. Set 0: 500 mA and -1 mA
// for 1 of x; set 1: 1500 mA and 1 mA. Both in Q8.
static void put_rules(void) {
    enum { CELLS = 16, RULES = 52, FIRST = 60, SECOND = 70, ALL = 80 };
    rules_at = count;
    PUT(FUZZY_MAGIC, 0, ALL, 1 | 2 << 8 | 16 << 16, CELLS | 3 << 16 | 12 << 24, 0, 0, 0,
        RULES | 2 << 16, FIRST, SECOND, 0, 0, ONE, 0, 0);
    PUT(-EDGE - 1, INT32_MIN, 0, 1, 0, ONE, 0, 0, 0, 0, 0, 0);
    PUT(EDGE - 1, -EDGE, 10, 2, 0, ONE, -(1 << 27), 0, 0, 0, 1 << 27, 1);
    PUT(INT32_MAX, EDGE, 0, 1, 0, ONE, 0, 1, 0, 0, 0, 0);
    PUT(WEIGHT | 1 << 24, 0, 0, (int32_t)0xFFFF0000, WEIGHT | 1 << 24, 1, 0, (int32_t)0xFFFF0101);
    PUT(2 << 8, 0, 500 * 256, 0, FIRST + 8, 0, 0, 0, 0, 1000 * 256);
    PUT(2 << 8, 0, -256, 0, SECOND + 8, 0, 0, 0, 0, 512);
    seal_rules();
}

static void begin(int32_t sections) {
    count = 0;
    PUT(MAGIC, 0, 0, sections);
}

// One input, um/s as it is, and a slope over it; then rules, or those of the section before.
static void put_section(uint32_t at, int32_t is_magnitude, bool has_rules) {
    PUT(1, 1, has_rules ? 80 : 0, VELOCITY | (int32_t)at << 8, 4096, 0, is_magnitude, 0, 0);
    if (has_rules) {
        put_rules();
    }
}

static quiesce_table_verdict_t verdict(void) {
    words[TABLE_WORDS] = count;
    words[TABLE_CRC] = crc32_words(&words[TABLE_WORDS], count - TABLE_WORDS);
    return table_check(law->kind, words, count);
}

static void make_one(void) {
    begin(1);
    put_section(0, 0, true);
    TEST_ASSERT_EQUAL_INT(QUIESCE_TABLE_OK, verdict());
}

static void tick(void) {
    TEST_ASSERT_TRUE(law->step(state, &setup, &view, &demand));
}

// ---- what it does -------------------------------------------------------------------------------

static void test_straight_lines_are_weighed_by_the_rules(void) {
    make_one();
    static const int32_t at[][2] = {
        {-2000, 2500}, {-1024, 1524}, {-512, 1006}, {0, 1000},
        {512, 1506},   {2000, 3500},  {4096, 5596}, {VIEW_LIMIT, 5596},
    };
    for (uint32_t i = 0; i < sizeof at / sizeof at[0]; i++) {
        view.body[0].velocity_um_s = at[i][0];
        tick();
        TEST_ASSERT_EQUAL_INT32(at[i][1], demand.value[0]);
        TEST_ASSERT_EQUAL_INT32(0, demand.value[1]);
    }
}

static void test_needs_are_its_signals_and_dampers(void) {
    begin(2);
    put_section(2, 0, true);
    put_section(1, 0, false);
    TEST_ASSERT_EQUAL_INT(QUIESCE_TABLE_OK, verdict());
    const uint64_t expected =
        (VIEW_VELOCITY << 2 | VIEW_VELOCITY << 1) | VIEW_CURRENT | VIEW_CURRENT << 1;
    TEST_ASSERT_TRUE(law->kind->needs(words) == expected);
}

static void test_rules_are_shared_and_magnitudes_are_the_section_s_own(void) {
    begin(3);
    put_section(0, 0, true);
    put_section(0, 1, false);
    put_section(1, 0, false);
    TEST_ASSERT_EQUAL_INT(QUIESCE_TABLE_OK, verdict());
    view.body[0].velocity_um_s = -2000;
    view.body[1].velocity_um_s = 512;
    tick();
    TEST_ASSERT_EQUAL_INT32(2500, demand.value[0]);
    TEST_ASSERT_EQUAL_INT32(3500, demand.value[1]);
    TEST_ASSERT_EQUAL_INT32(1506, demand.value[2]);
    int32_t word[QUIESCE_REPORT_WORDS] = {0};
    law->report(state, &setup, word);
    TEST_ASSERT_EQUAL_INT32(1, word[0]);
    TEST_ASSERT_EQUAL_INT32(2, word[1]);
    TEST_ASSERT_EQUAL_INT32(3, word[2]);
}

static void test_without_a_table_it_reports_nothing(void) {
    int32_t word[QUIESCE_REPORT_WORDS] = {5, 5, 5, 5};
    setup.table = NULL;
    law->report(state, &setup, word);
    TEST_ASSERT_EQUAL_INT32(5, word[0]);
}

static void test_currents_are_limited(void) {
    make_one();
    words[rules_at + 62u] = (uint32_t)INT32_MIN; // origin of the current
    words[rules_at + 69u] = 0;
    seal_rules();
    TEST_ASSERT_EQUAL_INT(QUIESCE_TABLE_OK, verdict());
    tick();
    TEST_ASSERT_EQUAL_INT32(0, demand.value[0]);
    words[rules_at + 62u] = (uint32_t)INT32_MAX - (1u << 24);
    seal_rules();
    TEST_ASSERT_EQUAL_INT(QUIESCE_TABLE_OK, verdict());
    tick();
    TEST_ASSERT_EQUAL_INT32(QUIESCE_HIGHEST_CURRENT_mA, demand.value[0]);
}

// Three slopes of the largest numbers that fit: no sum overflows (the sanitizers watch).
static void test_the_largest_slopes_add_up(void) {
    begin(1);
    PUT(1, 3, 100, FORCE, VIEW_LIMIT, 0, 0, 0, 0, 0, 0, 0, 62);
    put_rules();
    words[rules_at + 2u] = 100;
    words[rules_at + 3u] = 1 | 4 << 8 | 16 << 16;
    words[rules_at + 11u] = 80;
    words[rules_at + 12u] = 90;
    words[rules_at + 55u] = 0;
    words[rules_at + 59u] = 0x01010101;
    for (uint32_t i = 0; i < 2u; i++) {
        PUT(2 << 8, 0, INT32_MIN, 0, 88 + 10 * (int32_t)i, 0, 0, 0, 0, 0);
    }
    words[rules_at + 72u] = (uint32_t)INT32_MIN;
    words[rules_at + 79u] = 0;
    seal_rules();
    TEST_ASSERT_EQUAL_INT(QUIESCE_TABLE_OK, verdict());
    static const int32_t force_mN[] = {VIEW_LIMIT, -VIEW_LIMIT, 0};
    static const int32_t expected_mA[] = {0, QUIESCE_HIGHEST_CURRENT_mA, 1000};
    for (uint32_t i = 0; i < 3u; i++) {
        view.damper[0].force_mN = force_mN[i];
        tick();
        TEST_ASSERT_EQUAL_INT32(expected_mA[i], demand.value[0]);
    }
}

// ---- what is refused ----------------------------------------------------------------------------

static void test_head_is_checked(void) {
    make_one();
    TEST_ASSERT_EQUAL_HEX32(law->kind->magic, words[TABLE_MAGIC]);
    TEST_ASSERT_EQUAL_INT(QUIESCE_TABLE_SIZE, table_check(law->kind, words, 2));
    TEST_ASSERT_EQUAL_INT(QUIESCE_TABLE_SIZE, table_check(law->kind, words, count - 1u));
    TEST_ASSERT_EQUAL_INT(QUIESCE_TABLE_SIZE,
                          table_check(law->kind, words, QUIESCE_TABLE_WORDS + 1u));
    words[count - 1u] ^= 1u;
    TEST_ASSERT_EQUAL_INT(QUIESCE_TABLE_CRC, table_check(law->kind, words, count));
    words[TABLE_MAGIC] ^= 1u;
    TEST_ASSERT_EQUAL_INT(QUIESCE_TABLE_MAGIC, table_check(law->kind, words, count));
    make_one();
    put(0);
    TEST_ASSERT_EQUAL_INT(QUIESCE_TABLE_SHAPE, verdict());
    make_one();
    count--;
    TEST_ASSERT_EQUAL_INT(QUIESCE_TABLE_SHAPE, verdict());
}

typedef struct {
    uint32_t at; ///< from the section's first word
    uint32_t word;
    quiesce_table_verdict_t verdict;
} mistake_t;

static void test_a_section_s_own_words_are_checked(void) {
    static const mistake_t mistakes[] = {
        {0, 0, QUIESCE_TABLE_SHAPE},
        {0, 5, QUIESCE_TABLE_SHAPE},
        {1, 4, QUIESCE_TABLE_SHAPE},
        {2, 81, QUIESCE_TABLE_SHAPE},
        {2, UINT32_MAX, QUIESCE_TABLE_SHAPE},
        {3, 0xFF, QUIESCE_TABLE_POINT},
        {4, 0, QUIESCE_TABLE_POINT},
        {5, 30, QUIESCE_TABLE_POINT},
        {6, 2, QUIESCE_TABLE_POINT},
        {7, 1, QUIESCE_TABLE_POINT},
        {8, 63, QUIESCE_TABLE_POINT},
        {9, 1, QUIESCE_TABLE_POINT},
        {11, 79, QUIESCE_TABLE_POINT},
        {10, 0, QUIESCE_TABLE_OK}, // of the rules' own CRC the whole table's is enough
    };
    for (uint32_t i = 0; i < sizeof mistakes / sizeof mistakes[0]; i++) {
        make_one();
        words[SECTIONS_FIRST + mistakes[i].at] = mistakes[i].word;
        TEST_ASSERT_EQUAL_INT(mistakes[i].verdict, verdict());
    }
}

static void test_rules_have_to_fit_their_section(void) {
    begin(1); // none at all
    put_section(0, 0, false);
    TEST_ASSERT_EQUAL_INT(QUIESCE_TABLE_SHAPE, verdict());
    begin(1); // no slope for the second output
    PUT(1, 0, 80, VELOCITY, 4096, 0, 0);
    put_rules();
    TEST_ASSERT_EQUAL_INT(QUIESCE_TABLE_SHAPE, verdict());
    begin(1); // two inputs
    PUT(2, 1, 80, VELOCITY, 4096, 0, 0, VELOCITY, 4096, 0, 0, 0, 0);
    put_rules();
    TEST_ASSERT_EQUAL_INT(QUIESCE_TABLE_SHAPE, verdict());
    begin(2); // shared ones of another shape
    put_section(0, 0, true);
    PUT(1, 0, 0, VELOCITY, 4096, 0, 0);
    TEST_ASSERT_EQUAL_INT(QUIESCE_TABLE_SHAPE, verdict());
    begin(1); // a word behind them, that counts as theirs
    put_section(0, 0, true);
    words[SECTIONS_FIRST + 2u]++;
    put(0);
    TEST_ASSERT_EQUAL_INT(QUIESCE_TABLE_POINT, verdict());
    begin(5); // more dampers than there may be
    put_section(0, 0, true);
    for (uint32_t i = 1; i < 5u; i++) {
        put_section(0, 0, false);
    }
    TEST_ASSERT_EQUAL_INT(QUIESCE_TABLE_SHAPE, verdict());
}

static void run(void) {
    memset(state, 0, sizeof state);
    for (uint32_t t = 0; t < 20u; t++) {
        view.body[0].velocity_um_s = random_within(t < 10u ? 2000 : VIEW_LIMIT);
        tick();
        TEST_ASSERT_TRUE(demand.value[0] >= 0);
        TEST_ASSERT_TRUE(demand.value[0] <= QUIESCE_HIGHEST_CURRENT_mA);
    }
}

// Every word of the table as anything, with checksums that are right again: refused, or harmless.
static void test_any_word_may_be_anything(void) {
    static const uint32_t ends[] = {0,          1,          4,          13,         63,
                                    0x00000101, 0x00010000, 0x01000000, 0x3FFFFFFF, 0x40000000,
                                    0x7FFFFFFF, 0x80000000, 0xFEFFFFFF, 0xFFFFFFFF};
    uint32_t refused = 0;
    uint32_t ran = 0;
    make_one();
    for (uint32_t k = SECTIONS_COUNT; k < SECTIONS_FIRST + 9u + 80u; k++) {
        for (uint32_t e = 0; e < sizeof ends / sizeof ends[0]; e++) {
            make_one();
            words[k] = ends[e];
            if (k > rules_at + 2u) {
                seal_rules();
            }
            if (verdict() != QUIESCE_TABLE_OK) {
                refused++;
            } else {
                ran++;
                run();
            }
        }
    }
    TEST_ASSERT_GREATER_THAN_UINT32(300, refused);
    TEST_ASSERT_GREATER_THAN_UINT32(100, ran);
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(test_straight_lines_are_weighed_by_the_rules);
    RUN_TEST(test_needs_are_its_signals_and_dampers);
    RUN_TEST(test_rules_are_shared_and_magnitudes_are_the_section_s_own);
    RUN_TEST(test_without_a_table_it_reports_nothing);
    RUN_TEST(test_currents_are_limited);
    RUN_TEST(test_the_largest_slopes_add_up);
    RUN_TEST(test_head_is_checked);
    RUN_TEST(test_a_section_s_own_words_are_checked);
    RUN_TEST(test_rules_have_to_fit_their_section);
    RUN_TEST(test_any_word_may_be_anything);
    return UNITY_END();
}
