// Networks: exp and tanh, the words of each kind of layer by hand and what a tick makes of them,
// the law and the tracker that work with them, and what their checks refuse.
#include <stddef.h>
#include <string.h>

#include "activation.h"
#include "crc32.h"
#include "law.h"
#include "network.h"
#include "sections.h"
#include "track.h"
#include "unity.h"
#include "view_signal.h"

enum {
    ONE = 1 << 24,
    HALF = ONE / 2,
    SHARP = 1 << 16,
    TANH = 0,
    LINE = 1,
    RADIAL = 2,
    NORMALISED = 3,
    STROKE = 3,
    VELOCITY = 4,
    FORCE = 5,
    TEMPERATURE = 7,
    DEMAND = 64,
    RATE_Hz = 1000, ///< that delays count in
    LAW_MAGIC = 0x314E4E51,
    TRACK_MAGIC = 0x314E5451,
};

extern const law_t law_network;
extern const track_t track_network;

static law_setup_t setup;
static uint64_t state[LAW_STATE_BYTES / sizeof(uint64_t)];
static uint64_t track_state[TRACK_STATE_BYTES / sizeof(uint64_t)];
static view_t view;
static law_demand_t demand;
static uint32_t words[QUIESCE_TABLE_WORDS + 1u];
static uint32_t count;
static uint32_t seed;

void setUp(void) {
    quiesce_params_default(&setup.params);
    setup.table = words;
    memset(state, 0, sizeof state);
    memset(track_state, 0, sizeof track_state);
    view = (view_t){.valid = ~UINT64_C(0), .is_output_on = true};
    count = 0;
    seed = 7;
}
void tearDown(void) {}

static uint32_t random_word(void) {
    seed = seed * 1664525u + 1013904223u;
    return seed ^ seed >> 15;
}

static int32_t random_within(int32_t limit) {
    return (int32_t)(random_word() % (2u * (uint32_t)limit + 1u)) - limit;
}

// ---- exp and tanh -------------------------------------------------------------------------------

static void test_exp_and_tanh_at_known_places(void) {
    static const uint32_t of_exp[][2] = {
        {0, 16777216},      {8388608, 10175896}, {16777216, 6171993}, {33554432, 2270549},
        {83886080, 113044}, {167772160, 762},    {285212672, 1},      {UINT32_MAX, 0},
    };
    for (uint32_t i = 0; i < sizeof of_exp / sizeof of_exp[0]; i++) {
        TEST_ASSERT_UINT32_WITHIN(2, of_exp[i][1], exp_minus_q24(of_exp[i][0]));
    }
    static const int32_t of_tanh[][2] = {
        {0, 0},
        {167772, 167766},
        {4194304, 4109053},
        {8388608, 7753039},
        {16777216, 12777430},
        {33554432, 16173699},
        {67108864, 16765964},
        {134217728, 16777212},
        {536870912, 16777215},
    };
    for (uint32_t i = 0; i < sizeof of_tanh / sizeof of_tanh[0]; i++) {
        TEST_ASSERT_INT32_WITHIN(2, of_tanh[i][1], tanh_q24(of_tanh[i][0]));
        TEST_ASSERT_EQUAL_INT32(-tanh_q24(of_tanh[i][0]), tanh_q24(-of_tanh[i][0]));
    }
}

// Neither rises nor falls where it must not, over more than all that they tell apart.
static void test_exp_falls_and_tanh_rises(void) {
    uint32_t last_exp = ONE;
    int32_t last_tanh = 0;
    for (uint32_t at = 0; at < 20u * ONE; at += 997u) {
        const uint32_t now_exp = exp_minus_q24(at);
        const int32_t now_tanh = tanh_q24((int32_t)at);
        TEST_ASSERT_LESS_OR_EQUAL_UINT32(last_exp, now_exp);
        TEST_ASSERT_GREATER_OR_EQUAL_INT32(last_tanh - 1, now_tanh);
        TEST_ASSERT_LESS_THAN_INT32(ONE, now_tanh);
        last_exp = now_exp;
        last_tanh = now_tanh;
    }
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

static void begin(uint32_t magic, int32_t sections) {
    count = TABLE_HEAD_WORDS;
    words[TABLE_MAGIC] = magic;
    put(sections);
}

static void put_network(int32_t own, int32_t largest_mA, int32_t inputs, int32_t delay,
                        int32_t layers) {
    put_all((const int32_t[]){own, largest_mA, inputs, delay, delay > 0 ? RATE_Hz : 0, layers}, 6);
}

// -2^20 .. 2^20 of its unit is -1 .. 1.
static void put_input(int32_t signal) {
    put_all((const int32_t[]){signal, -(1 << 20), 1 << 20, 1 << 4, 0}, 5);
}

static quiesce_table_verdict_t verdict_of(bool of_law) {
    words[TABLE_WORDS] = count;
    words[TABLE_CRC] = crc32_words(&words[TABLE_WORDS], count - TABLE_WORDS);
    return table_check(of_law ? law_network.kind : track_network.kind, words, count);
}

static void expect_good(bool of_law) {
    TEST_ASSERT_EQUAL_INT(QUIESCE_TABLE_OK, verdict_of(of_law));
}

static int32_t tick_of(int32_t stroke_nm, int32_t velocity_um_s) {
    view.damper[0].stroke_nm = stroke_nm;
    view.damper[0].velocity_um_s = velocity_um_s;
    TEST_ASSERT_TRUE(law_network.step(state, &setup, &view, &demand));
    return demand.value[0];
}

// 1000 mA (1 + unit), the unit a straight line or tanh of 2 stroke - velocity + 1/4.
static void make_dense(int32_t kind) {
    begin(LAW_MAGIC, 1);
    put_network(0, 1900, 2, 0, 1);
    put_input(STROKE);
    put_input(VELOCITY);
    put_all((const int32_t[]){kind, 1, 10, 256, 2048, -1024}, 6);
    put_all((const int32_t[]){0, 4, 16000, 16000}, 4);
    expect_good(true);
}

// 500 mA + 1000 mA x a Gaussian around (1/2, -1/2) that is 1/e at a distance of 1/2.
static void make_radial(void) {
    begin(LAW_MAGIC, 1);
    put_network(0, 1900, 2, 0, 1);
    put_input(STROKE);
    put_input(VELOCITY);
    put_all((const int32_t[]){RADIAL, 1, HALF, -HALF, 2 * SHARP, 2 * SHARP}, 6);
    put_all((const int32_t[]){0, 0, 500, 1000}, 4);
    expect_good(true);
}

// Two rules over the stroke: near -1/2: 200 mA + 100 mA x stroke, near 1/2: 1200 mA.
static void make_rules(void) {
    begin(LAW_MAGIC, 1);
    put_network(0, 20000, 1, 0, 1);
    put_input(STROKE);
    put_all((const int32_t[]){NORMALISED, 2, -HALF, 4 * SHARP, HALF, 4 * SHARP}, 6);
    put_all((const int32_t[]){1, 4, 0, 16 * 200, 16 * 100, 16 * 1200, 0}, 7);
    expect_good(true);
}

// 1000 mA + 500 mA x (stroke - what it was three ticks ago), through two layers.
static void make_delayed(void) {
    begin(LAW_MAGIC, 1);
    put_network(0, 20000, 1, 3, 2);
    put_input(STROKE);
    put_all((const int32_t[]){LINE, 2, 0, 0, 1, 0, 0, 0, 0, 1}, 10);
    put_all((const int32_t[]){LINE, 1, 1, 0, 1, -1}, 6);
    put_all((const int32_t[]){0, 0, 1000, 1000}, 4);
    expect_good(true);
}

// 1000 mA x (demand in parts of 2^20 mN) / 2 + 500 mA x velocity likewise; slower than 1000 um/s it
// counts as that.
static void put_section_of_tracker(void) {
    put_network(1000, 1500, 2, 0, 1);
    put_input(DEMAND);
    put_input(VELOCITY);
    put_all((const int32_t[]){LINE, 1, 1, 0, 1, 1}, 6);
    put_all((const int32_t[]){0, 0, 0, 1000}, 4);
}

static void make_tracker(void) {
    begin(TRACK_MAGIC, 1);
    put_section_of_tracker();
    expect_good(false);
}

// ---- the law ------------------------------------------------------------------------------------

static void test_dense_line_and_tanh(void) {
    enum { AT = 1 << 20 };
    make_dense(LINE);
    TEST_ASSERT_TRUE(law_network.kind->needs(words) ==
                     (VIEW_STROKE | VIEW_STROKE_VELOCITY | VIEW_CURRENT));
    TEST_ASSERT_EQUAL_INT32(1250, tick_of(0, 0));
    TEST_ASSERT_EQUAL_INT32(1750, tick_of(AT / 4, 0));
    TEST_ASSERT_EQUAL_INT32(1900, tick_of(AT / 2, 0)); // its largest
    TEST_ASSERT_EQUAL_INT32(250, tick_of(0, AT));
    TEST_ASSERT_EQUAL_INT32(250, tick_of(0, VIEW_LIMIT)); // beyond its range as at its end
    TEST_ASSERT_EQUAL_INT32(0, tick_of(-AT, AT));
    make_dense(TANH);
    TEST_ASSERT_EQUAL_INT32(1245, tick_of(0, 0));      // tanh .25 = .2449
    TEST_ASSERT_EQUAL_INT32(1635, tick_of(AT / 4, 0)); // tanh .75 = .6351
    TEST_ASSERT_EQUAL_INT32(365, tick_of(-AT / 2, 0)); // tanh -.75
}

static void test_radial_falls_around_its_centre(void) {
    enum { AT = 1 << 19 };
    make_radial();
    TEST_ASSERT_EQUAL_INT32(1500, tick_of(AT, -AT));
    TEST_ASSERT_EQUAL_INT32(868, tick_of(0, -AT));
    TEST_ASSERT_EQUAL_INT32(868, tick_of(AT, -2 * AT));
    TEST_ASSERT_EQUAL_INT32(635, tick_of(0, 0)); // 1/e^2
    TEST_ASSERT_EQUAL_INT32(500, tick_of(-2 * AT, 2 * AT));
}

static void test_rules_share_what_they_conclude(void) {
    make_rules();
    TEST_ASSERT_EQUAL_INT32(700, tick_of(0, 0));
    TEST_ASSERT_EQUAL_INT32(1200, tick_of(1 << 20, 0));
    TEST_ASSERT_EQUAL_INT32(100, tick_of(-(1 << 20), 0));
    TEST_ASSERT_EQUAL_INT32(150, tick_of(-(1 << 19), 0));
}

static void test_delayed_input_is_that_of_some_ticks_ago(void) {
    make_delayed();
    static const int32_t at[] = {1, 2, 3, -4, 0, 0, 0, 0, 0};
    for (int32_t i = 0; i < 9; i++) {
        const int32_t change = at[i] - (i < 3 ? 0 : at[i - 3]);
        TEST_ASSERT_EQUAL_INT32(1000 + change * 125, tick_of(at[i] * (1 << 18), 0));
    }
}

static void test_a_delay_counts_in_ticks_of_one_rate(void) {
    enum { AT_RATE = SECTIONS_FIRST + 4 };
    make_dense(LINE);
    TEST_ASSERT_EQUAL_UINT32(TABLE_ANY_RATE, law_network.kind->rate_Hz(words));
    make_delayed();
    TEST_ASSERT_EQUAL_UINT32(RATE_Hz, law_network.kind->rate_Hz(words));
    // Another section, without a delay, of the same rate, of another.
    const uint32_t first = count - SECTIONS_FIRST;
    const uint32_t second = count;
    memcpy(&words[second], &words[SECTIONS_FIRST], first * sizeof words[0]);
    count += first;
    words[SECTIONS_COUNT] = 2;
    expect_good(true);
    TEST_ASSERT_EQUAL_UINT32(RATE_Hz, law_network.kind->rate_Hz(words));
    words[second + 4u] = 500;
    expect_good(true);
    TEST_ASSERT_EQUAL_UINT32(0, law_network.kind->rate_Hz(words));
    static const int32_t wrong[] = {0, -1, INT32_MIN};
    for (uint32_t i = 0; i < 3u; i++) {
        words[second + 4u] = (uint32_t)wrong[i];
        TEST_ASSERT_EQUAL_INT(QUIESCE_TABLE_POINT, verdict_of(true));
    }
    make_dense(LINE);
    words[AT_RATE] = RATE_Hz;
    TEST_ASSERT_EQUAL_INT(QUIESCE_TABLE_POINT, verdict_of(true));
}

// A controller of 500 ticks a second takes a law's network without a delay, or with one of its own.
static void test_the_controller_refuses_delays_of_another_rate(void) {
    static quiesce_t controller;
    quiesce_params_t params;
    quiesce_params_default(&params);
    params.tick_rate_Hz = 500;
    params.law = QUIESCE_LAW_NETWORK;
    quiesce_board_t board;
    quiesce_board_default(&board);
    for (int32_t sense = STROKE; sense <= VELOCITY; sense++) {
        quiesce_board_sensor_t *sensor = &board.sensor[board.sensors++];
        *sensor = board.sensor[0];
        sensor->sense = (uint8_t)sense;
    }
    TEST_ASSERT_TRUE(quiesce_init_board(&controller, &board, &params));
    make_dense(LINE);
    TEST_ASSERT_EQUAL_INT(QUIESCE_TABLE_OK, quiesce_table_use(&controller, words, count));
    make_delayed();
    TEST_ASSERT_EQUAL_INT(QUIESCE_TABLE_FIT, quiesce_table_use(&controller, words, count));
    words[SECTIONS_FIRST + 4] = 500;
    expect_good(true);
    TEST_ASSERT_EQUAL_INT(QUIESCE_TABLE_OK, quiesce_table_use(&controller, words, count));
}

// ---- the tracker --------------------------------------------------------------------------------

static int32_t track(uint32_t number, int32_t velocity_um_s, int32_t demand_mN) {
    const track_setup_t with = {&setup.params, words, number};
    const view_damper_t damper = {.velocity_um_s = velocity_um_s};
    return track_network.step(track_state, &with, &damper, demand_mN);
}

static void test_tracker_gives_no_current_against_the_way(void) {
    enum { AT = 1 << 19 };
    make_tracker();
    TEST_ASSERT_TRUE(track_network.kind->needs(words) == (VIEW_STROKE_VELOCITY | VIEW_CURRENT));
    TEST_ASSERT_EQUAL_INT32(500, track(0, AT, AT));
    TEST_ASSERT_EQUAL_INT32(1000, track(0, 2 * AT, 2 * AT));
    TEST_ASSERT_EQUAL_INT32(0, track(0, AT, -AT));
    TEST_ASSERT_EQUAL_INT32(0, track(0, -AT, AT));
    TEST_ASSERT_EQUAL_INT32(0, track(0, AT, 0));
    TEST_ASSERT_EQUAL_INT32(0, track(0, -AT, INT32_MAX));
    TEST_ASSERT_EQUAL_INT32(0, track(1, AT, AT)); // no network for it
}

// At the least speed, whichever slower one it has.
static void test_tracker_counts_a_slow_damper_as_moving(void) {
    make_tracker();
    const int32_t at_least_mA = track(0, 1000, 1 << 20);
    TEST_ASSERT_EQUAL_INT32(at_least_mA, track(0, 1, 1 << 20));
    TEST_ASSERT_EQUAL_INT32(at_least_mA, track(0, 0, 1 << 20));
    TEST_ASSERT_GREATER_THAN_INT32(at_least_mA, track(0, 20000, 1 << 20));
}

static void test_tracker_takes_the_way_of_the_force_where_it_sees_one(void) {
    begin(TRACK_MAGIC, 1);
    put_network(0, 1500, 2, 0, 1);
    put_input(DEMAND);
    put_input(FORCE);
    put_all((const int32_t[]){LINE, 1, 0, 0, 1, 0}, 6);
    put_all((const int32_t[]){0, 0, 0, 1000}, 4);
    expect_good(false);
    TEST_ASSERT_TRUE(track_network.kind->needs(words) == (VIEW_FORCE | VIEW_CURRENT));
    const track_setup_t with = {&setup.params, words, 0};
    const view_damper_t damper = {.velocity_um_s = -5000, .force_mN = 3};
    TEST_ASSERT_EQUAL_INT32(500, track_network.step(track_state, &with, &damper, 1 << 19));
    TEST_ASSERT_EQUAL_INT32(0, track_network.step(track_state, &with, &damper, -(1 << 19)));
}

static void test_each_damper_has_its_network(void) {
    begin(TRACK_MAGIC, 2);
    put_section_of_tracker();
    put_section_of_tracker();
    words[count - 1u] = 700;
    expect_good(false);
    TEST_ASSERT_EQUAL_INT32(500, track(0, 1 << 19, 1 << 19));
    TEST_ASSERT_EQUAL_INT32(350, track(1, 1 << 19, 1 << 19));
    TEST_ASSERT_TRUE(track_network.kind->needs(words) ==
                     (VIEW_STROKE_VELOCITY * 3u | VIEW_CURRENT * 3u));
}

// ---- what is refused ----------------------------------------------------------------------------

typedef struct {
    void (*make)(void);
    bool of_law;
} kind_t;

static void make_tanh(void) {
    make_dense(TANH);
}

static const kind_t kinds[] = {
    {make_tanh, true},    {make_radial, true},   {make_rules, true},
    {make_delayed, true}, {make_tracker, false},
};

#define KINDS (sizeof kinds / sizeof kinds[0])

static void step_any(bool of_law) {
    for (uint32_t i = 0; i < QUIESCE_DAMPERS; i++) {
        view.damper[i] = (view_damper_t){random_within(VIEW_LIMIT), random_within(VIEW_LIMIT),
                                         random_within(VIEW_LIMIT), random_within(VIEW_LIMIT),
                                         random_within(VIEW_LIMIT), random_within(VIEW_LIMIT)};
    }
    int32_t current_mA = 0;
    if (of_law) {
        TEST_ASSERT_TRUE(law_network.step(state, &setup, &view, &demand));
        current_mA = demand.value[0];
    } else {
        const track_setup_t with = {&setup.params, words, 0};
        const int32_t wanted_mN = (int32_t)random_word();
        current_mA = track_network.step(track_state, &with, &view.damper[0], wanted_mN);
    }
    TEST_ASSERT_GREATER_OR_EQUAL_INT32(0, current_mA);
    TEST_ASSERT_LESS_OR_EQUAL_INT32((int32_t)words[SECTIONS_FIRST + 1], current_mA);
}

static bool is_of_first_places(uint64_t needs) {
    const uint64_t first = VIEW_ACCEL | VIEW_VELOCITY | VIEW_DISPLACEMENT | VIEW_SUPPLY |
                           VIEW_STROKE | VIEW_STROKE_VELOCITY | VIEW_FORCE | VIEW_CURRENT |
                           VIEW_VOLTAGE | VIEW_TEMPERATURE;
    return (needs & ~first) == 0;
}

static void run_if_good(bool of_law, uint32_t *refused, uint32_t *ran) {
    if (verdict_of(of_law) != QUIESCE_TABLE_OK) {
        (*refused)++;
        return;
    }
    const uint64_t needs =
        of_law ? law_network.kind->needs(words) : track_network.kind->needs(words);
    if (is_of_first_places(needs)) {
        (*ran)++;
        memset(state, 0, sizeof state);
        memset(track_state, 0, sizeof track_state);
        for (uint32_t t = 0; t < 10; t++) {
            step_any(of_law);
        }
    }
}

// One word after the other, at the ends of what 32 bits hold: refused, or harmless (the sanitizers
// watch).
static void test_any_word_may_be_anything(void) {
    static const uint32_t ends[] = {
        0,          1,          2,          3,          4,          5,          8,
        33,         36,         37,         60,         61,         63,         64,
        0x104,      0x00FFFFFF, 0x01000000, 0x04000000, 0x04000001, 0x3FFFFFFF, 0x40000000,
        0x7FFFFFFF, 0x80000000, 0xFF000001, 0xFF000000, 0xFFFFFFFF};
    uint32_t refused = 0;
    uint32_t ran = 0;
    for (uint32_t i = 0; i < KINDS; i++) {
        kinds[i].make();
        const uint32_t last = count;
        for (uint32_t k = TABLE_HEAD_WORDS; k < last; k++) {
            for (uint32_t e = 0; e < sizeof ends / sizeof ends[0]; e++) {
                kinds[i].make();
                words[k] = ends[e];
                run_if_good(kinds[i].of_law, &refused, &ran);
            }
        }
    }
    TEST_ASSERT_GREATER_THAN_UINT32(1000, refused);
    TEST_ASSERT_GREATER_THAN_UINT32(1000, ran);
}

static int32_t of_either_end(int32_t limit) {
    return random_word() % 4u == 0 ? random_within(limit)
                                   : (random_word() % 2u == 0 ? limit : -limit);
}

static void put_random_layer(uint32_t kind, uint32_t units, uint32_t values) {
    put((int32_t)kind);
    put((int32_t)units);
    for (uint32_t i = 0; i < units; i++) {
        if (kind < RADIAL) {
            put((int32_t)(random_word() % 61u));
            for (uint32_t k = 0; k < values + 1u; k++) {
                put(of_either_end(ONE - 1));
            }
            continue;
        }
        for (uint32_t k = 0; k < 2u * values; k++) {
            const int32_t sharpness = (int32_t)(random_word() % ONE);
            put(k < values ? of_either_end(4 * ONE) : sharpness);
        }
    }
}

// Whole networks of the largest numbers that the check lets in.
static void make_random(bool of_law) {
    const uint32_t inputs = 2u + random_word() % 3u;
    const uint32_t delay = random_word() % 3u;
    const uint32_t layers = 1u + random_word() % 2u;
    begin(of_law ? LAW_MAGIC : TRACK_MAGIC, 1);
    put_network(of_law ? 0 : random_within(1000000), 20000, (int32_t)inputs, (int32_t)delay,
                (int32_t)layers);
    for (uint32_t i = 0; i < inputs; i++) {
        put(of_law ? (int32_t[]){STROKE, VELOCITY, FORCE, TEMPERATURE}[i]
                   : (int32_t[]){DEMAND, VELOCITY, FORCE, TEMPERATURE}[i]);
        put_all((const int32_t[]){-VIEW_LIMIT, VIEW_LIMIT, 1 << 29, 35}, 4);
    }
    uint32_t values = delay == 0 ? inputs : 2u * inputs;
    uint32_t seen = values;
    for (uint32_t i = 0; i < layers; i++) {
        const uint32_t units = 1u + random_word() % (i == 0 ? 10u : 8u);
        put_random_layer(random_word() % 4u, units, values);
        seen = values;
        values = units;
    }
    const uint32_t order = random_word() % 2u;
    put((int32_t)order);
    put((int32_t)(random_word() % 37u));
    for (uint32_t i = 0; i < 1u + values * (1u + order * seen); i++) {
        put(of_either_end(ONE - 1));
    }
}

static void test_largest_numbers_pass_no_range(void) {
    uint32_t refused = 0;
    uint32_t ran = 0;
    for (uint32_t i = 0; i < 1000; i++) {
        make_random(i % 2u == 0);
        run_if_good(i % 2u == 0, &refused, &ran);
    }
    TEST_ASSERT_GREATER_THAN_UINT32(500, ran);
    TEST_ASSERT_GREATER_THAN_UINT32(10, refused);
}

// More units than a tick has time for.
static void test_too_much_work_is_refused(void) {
    for (int32_t units = 1; units <= 32; units++) {
        begin(LAW_MAGIC, 1);
        put_network(0, 100, 4, 0, 1);
        for (uint32_t i = 0; i < 4; i++) {
            put_input(STROKE);
        }
        put_random_layer(RADIAL, (uint32_t)units, 4);
        put_all((const int32_t[]){0, 0, 0}, 3);
        for (int32_t i = 0; i < units; i++) {
            put(1);
        }
        // 280, and 218 a unit.
        TEST_ASSERT_EQUAL_INT(units <= 21 ? QUIESCE_TABLE_OK : QUIESCE_TABLE_SHAPE,
                              verdict_of(true));
    }
}

static void test_head_is_checked(void) {
    for (uint32_t i = 0; i < KINDS; i++) {
        const bool of_law = kinds[i].of_law;
        kinds[i].make();
        TEST_ASSERT_EQUAL_HEX32(of_law ? law_network.kind->magic : track_network.kind->magic,
                                words[TABLE_MAGIC]);
        put(0);
        TEST_ASSERT_EQUAL_INT(QUIESCE_TABLE_SHAPE, verdict_of(of_law));
        kinds[i].make();
        count--;
        TEST_ASSERT_EQUAL_INT(QUIESCE_TABLE_SHAPE, verdict_of(of_law));
        kinds[i].make();
        words[TABLE_MAGIC] ^= 1u;
        TEST_ASSERT_EQUAL_INT(QUIESCE_TABLE_MAGIC, verdict_of(of_law));
    }
}

static void test_tracker_without_a_demand_or_a_way_is_refused(void) {
    static const int32_t pairs[][2] = {
        {DEMAND, STROKE}, {VELOCITY, FORCE}, {DEMAND, 0}, {DEMAND, 8}, {DEMAND, VELOCITY | 0x100},
    };
    for (uint32_t i = 0; i < sizeof pairs / sizeof pairs[0]; i++) {
        make_tracker();
        words[SECTIONS_FIRST + 6] = (uint32_t)pairs[i][0];
        words[SECTIONS_FIRST + 11] = (uint32_t)pairs[i][1];
        TEST_ASSERT_EQUAL_INT(QUIESCE_TABLE_POINT, verdict_of(false));
    }
    make_tanh();
    words[SECTIONS_FIRST + 6] = DEMAND;
    TEST_ASSERT_EQUAL_INT(QUIESCE_TABLE_POINT, verdict_of(true));
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(test_exp_and_tanh_at_known_places);
    RUN_TEST(test_exp_falls_and_tanh_rises);
    RUN_TEST(test_dense_line_and_tanh);
    RUN_TEST(test_radial_falls_around_its_centre);
    RUN_TEST(test_rules_share_what_they_conclude);
    RUN_TEST(test_delayed_input_is_that_of_some_ticks_ago);
    RUN_TEST(test_a_delay_counts_in_ticks_of_one_rate);
    RUN_TEST(test_the_controller_refuses_delays_of_another_rate);
    RUN_TEST(test_tracker_gives_no_current_against_the_way);
    RUN_TEST(test_tracker_counts_a_slow_damper_as_moving);
    RUN_TEST(test_tracker_takes_the_way_of_the_force_where_it_sees_one);
    RUN_TEST(test_each_damper_has_its_network);
    RUN_TEST(test_any_word_may_be_anything);
    RUN_TEST(test_largest_numbers_pass_no_range);
    RUN_TEST(test_too_much_work_is_refused);
    RUN_TEST(test_head_is_checked);
    RUN_TEST(test_tracker_without_a_demand_or_a_way_is_refused);
    return UNITY_END();
}
