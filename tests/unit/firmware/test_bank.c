// The bank of models with memory: its elements, its way back, its check, then in the controller.
#include <string.h>

#include "crc32.h"
#include "fixq.h"
#include "force_bank.h"
#include "law.h"
#include "quiesce.h"
#include "table.h"
#include "test_signal.h"
#include "track.h"
#include "unity.h"

enum {
    HEAD = 4,
    ELEMENTS = HEAD,
    CURRENTS,
    RATE,
    SHIFT,
    LEAD,
    LEAD_LIMIT,
    FIRST, ///< element: leads, leak, limit
    MODELS = FIRST + 9,
    MODEL_WORDS = 6, ///< current, offset, spring, weights
    WORDS = MODELS + 3 * MODEL_WORDS,
    RATE_Hz = 1000,
    ONE_Q30 = 1 << 30,
};

static uint32_t words[QUIESCE_TABLE_WORDS];
static force_bank_t bank;
static uint32_t seed;

static bool step_law(void *state, const law_setup_t *setup, const view_t *view, law_demand_t *to) {
    (void)state;
    (void)setup;
    (void)view;
    law_demand_all(to, 50000);
    return true;
}

static const law_t test_law = {.name = "test", .demands = LAW_DEMANDS_FORCE, .step = step_law};

const law_t *law_find(int32_t index) {
    return index >= 0 && index <= QUIESCE_LAW_PHASE ? &test_law : NULL;
}

static void seal(uint32_t count) {
    words[TABLE_MAGIC] = FORCE_BANK_MAGIC;
    words[TABLE_WORDS] = count;
    words[TABLE_CRC] = crc32_words(&words[TABLE_WORDS], count - TABLE_WORDS);
}

// A stop of 10 um, a saturation at 50 mm/s, a dashpot that forgets a quarter a tick; 0, 1 and 2 A.
static uint32_t make_bank(void) {
    // clang-format off
    static const uint32_t good[WORDS] = {
        0, 0, 0, 1, 3, 3, RATE_Hz, 4, 0, 0,
        0, 0, 10000, 0, ONE_Q30, 50000, 0, ONE_Q30 / 4, VIEW_LIMIT,
        0, 0, 0, 16, 8, 0,
        1000, 0, 0, 80, 8, 4,
        2000, 0, 0, 160, 8, 8,
    };
    // clang-format on
    memcpy(words, good, sizeof good);
    seal(WORDS);
    return WORDS;
}

static const uint32_t *section(void) {
    return &words[HEAD];
}

static void move(int32_t velocity_um_s) {
    const view_damper_t damper = {.velocity_um_s = velocity_um_s};
    force_bank_move(&bank, section(), &damper);
}

static int32_t force(uint32_t k) {
    const view_damper_t damper = {0};
    return force_bank_force_mN(&bank, section(), k, &damper);
}

static int32_t current(int32_t demand_mN) {
    const view_damper_t damper = {0};
    return force_bank_current_mA(&bank, section(), &damper, demand_mN);
}

static quiesce_table_verdict_t verdict_of(uint32_t count) {
    return quiesce_table_check(words, count);
}

void setUp(void) {
    seed = 3;
    bank = (force_bank_t){{0}};
    TEST_ASSERT_EQUAL_INT(QUIESCE_TABLE_OK, verdict_of(make_bank()));
}
void tearDown(void) {}

static void test_elements_stop_saturate_and_leak(void) {
    move(4000);
    TEST_ASSERT_EQUAL_INT32(4000, bank.z[0]);
    TEST_ASSERT_EQUAL_INT32(4000, bank.z[1]);
    TEST_ASSERT_EQUAL_INT32(4000, bank.z[2]);
    move(60000);
    TEST_ASSERT_EQUAL_INT32(10000, bank.z[0]); // slides
    TEST_ASSERT_EQUAL_INT32(50000, bank.z[1]);
    TEST_ASSERT_EQUAL_INT32(63000, bank.z[2]);
    move(-1000);
    TEST_ASSERT_EQUAL_INT32(9000, bank.z[0]); // turns, and still pulls
    TEST_ASSERT_EQUAL_INT32(-1000, bank.z[1]);
    TEST_ASSERT_EQUAL_INT32(46250, bank.z[2]);
    for (uint32_t i = 0; i < 100u; i++) {
        move(VIEW_LIMIT);
    }
    TEST_ASSERT_EQUAL_INT32(VIEW_LIMIT, bank.z[2]);
    move(-VIEW_LIMIT);
    TEST_ASSERT_EQUAL_INT32(-10000, bank.z[0]);
}

static void test_a_lead_is_of_the_stroke(void) {
    words[LEAD] = 1u << 19; // 0.5 um/s for a nm
    words[LEAD_LIMIT] = 3000;
    words[FIRST + 3] = 1;
    seal(WORDS);
    TEST_ASSERT_EQUAL_INT(QUIESCE_TABLE_OK, verdict_of(WORDS));
    view_damper_t damper = {.velocity_um_s = 100, .stroke_nm = -4000};
    force_bank_move(&bank, section(), &damper);
    TEST_ASSERT_EQUAL_INT32(100, bank.z[0]);
    TEST_ASSERT_EQUAL_INT32(-1900, bank.z[1]);
    damper.stroke_nm = VIEW_LIMIT;
    force_bank_move(&bank, section(), &damper);
    TEST_ASSERT_EQUAL_INT32(3100, bank.z[1]);
}

// 10, 50 and 100 N of the stop, 5 N of the saturation.
static void test_the_current_lies_between_two_models(void) {
    move(10000);
    move(0);
    bank.z[1] = 10000;
    bank.z[2] = 0;
    TEST_ASSERT_EQUAL_INT32(15000, force(0));
    TEST_ASSERT_EQUAL_INT32(55000, force(1));
    TEST_ASSERT_EQUAL_INT32(105000, force(2));
    static const struct {
        int32_t demand, current;
    } cases[] = {
        {15000, 0},    {15001, 0},     {15100, 3},     {35000, 500},      {55000, 1000},
        {80000, 1500}, {105000, 2000}, {105001, 2000}, {INT32_MAX, 2000}, {0, 0},
        {-15000, 0},   {INT32_MIN, 0}, {14999, 0},     {55025, 1001},
    };
    for (uint32_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        TEST_ASSERT_EQUAL_INT32(cases[i].current, current(cases[i].demand));
    }
    for (uint32_t j = 0; j < 3u; j++) {
        bank.z[j] = -bank.z[j];
    }
    for (uint32_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        const int32_t demand = cases[i].demand;
        TEST_ASSERT_EQUAL_INT32(cases[i].current,
                                current(demand == INT32_MIN ? INT32_MAX : -demand));
    }
}

// Forces that fall again: the first current that does, and where none does the largest force.
static void test_forces_need_not_rise_with_the_current(void) {
    words[MODELS + 2 * MODEL_WORDS + 3] = 40;
    seal(WORDS);
    bank.z[0] = 10000;
    TEST_ASSERT_EQUAL_INT32(50000, force(1));
    TEST_ASSERT_EQUAL_INT32(25000, force(2));
    TEST_ASSERT_EQUAL_INT32(1000, current(60000));
    TEST_ASSERT_EQUAL_INT32(500, current(30000));
}

// An offset pulls the other way: only models whose force has the demand's sign count.
static void test_no_current_where_no_force_has_the_sign(void) {
    for (uint32_t k = 0; k < 3u; k++) {
        words[MODELS + k * MODEL_WORDS + 1] = (uint32_t)-60000;
    }
    seal(WORDS);
    TEST_ASSERT_EQUAL_INT(QUIESCE_TABLE_OK, verdict_of(WORDS));
    bank.z[0] = 10000;
    TEST_ASSERT_EQUAL_INT32(-50000, force(0));
    TEST_ASSERT_EQUAL_INT32(40000, force(2));
    TEST_ASSERT_EQUAL_INT32(2000, current(50000));
    TEST_ASSERT_EQUAL_INT32(1320, current(6000));
    bank.z[0] = 5000;
    TEST_ASSERT_EQUAL_INT32(-10000, force(2));
    TEST_ASSERT_EQUAL_INT32(0, current(50000));
}

// Whatever the motion: more is taken from it than was given back.
static void test_models_are_passive(void) {
    for (uint32_t run = 0; run < 50u; run++) {
        bank = (force_bank_t){{0}};
        int64_t work[3] = {0};
        const int32_t size = 1 + signal_noise(&seed, 1 << 14) + (1 << 14);
        for (uint32_t t = 0; t < 2000u; t++) {
            const int32_t velocity =
                signal_sine(size, 3000 + run * 1000u, t, RATE_Hz) + signal_noise(&seed, size);
            move(velocity);
            for (uint32_t k = 0; k < 3u; k++) {
                work[k] += (int64_t)force(k) * velocity;
                // A mN is rounded away in each tick at most.
                TEST_ASSERT_TRUE(work[k] >= -2 * (int64_t)size * (t + 1u));
            }
        }
        TEST_ASSERT_TRUE(work[2] > 0);
    }
}

static void expect(quiesce_table_verdict_t verdict, uint32_t at, uint32_t value) {
    make_bank();
    words[at] = value;
    seal(WORDS);
    TEST_ASSERT_EQUAL_INT(verdict, verdict_of(WORDS));
}

static void test_malformed_banks_are_refused(void) {
    TEST_ASSERT_EQUAL_INT(QUIESCE_TABLE_SIZE, verdict_of(WORDS - 1u));
    TEST_ASSERT_EQUAL_INT(QUIESCE_TABLE_SIZE, verdict_of(WORDS + 1u));
    words[RATE]++;
    TEST_ASSERT_EQUAL_INT(QUIESCE_TABLE_CRC, verdict_of(WORDS));
    words[0]++;
    TEST_ASSERT_EQUAL_INT(QUIESCE_TABLE_MAGIC, verdict_of(WORDS));
    const struct {
        quiesce_table_verdict_t verdict;
        uint32_t at, value;
    } cases[] = {
        {QUIESCE_TABLE_SHAPE, 3, 0},
        {QUIESCE_TABLE_SHAPE, 3, 2},
        {QUIESCE_TABLE_SHAPE, 3, 5},
        {QUIESCE_TABLE_SHAPE, ELEMENTS, 0},
        {QUIESCE_TABLE_POINT, ELEMENTS, 2}, // what follows is none
        {QUIESCE_TABLE_SHAPE, ELEMENTS, 9},
        {QUIESCE_TABLE_SHAPE, ELEMENTS, UINT32_MAX},
        {QUIESCE_TABLE_SHAPE, CURRENTS, 1},
        {QUIESCE_TABLE_SHAPE, CURRENTS, 2},
        {QUIESCE_TABLE_SHAPE, CURRENTS, 9},
        {QUIESCE_TABLE_POINT, RATE, 0},
        {QUIESCE_TABLE_POINT, RATE, UINT32_MAX},
        {QUIESCE_TABLE_POINT, SHIFT, 41},
        {QUIESCE_TABLE_OK, SHIFT, 40},
        {QUIESCE_TABLE_OK, LEAD, (uint32_t)INT32_MIN},
        {QUIESCE_TABLE_POINT, LEAD_LIMIT, UINT32_MAX},
        {QUIESCE_TABLE_POINT, LEAD_LIMIT, VIEW_LIMIT + 1u},
        {QUIESCE_TABLE_POINT, FIRST, 2},
        {QUIESCE_TABLE_OK, FIRST, 1},
        {QUIESCE_TABLE_POINT, FIRST + 1, ONE_Q30 + 1u},
        {QUIESCE_TABLE_OK, FIRST + 1, ONE_Q30},
        {QUIESCE_TABLE_POINT, FIRST + 2, 0},
        {QUIESCE_TABLE_POINT, FIRST + 2, VIEW_LIMIT + 1u},
        {QUIESCE_TABLE_POINT, FIRST + 2, UINT32_MAX},
        {QUIESCE_TABLE_POINT, MODELS, 1},
        {QUIESCE_TABLE_POINT, MODELS + MODEL_WORDS, 0},
        {QUIESCE_TABLE_POINT, MODELS + MODEL_WORDS, 2000},
        {QUIESCE_TABLE_POINT, MODELS + 2 * MODEL_WORDS, 20001},
        {QUIESCE_TABLE_OK, MODELS + 2 * MODEL_WORDS, 20000},
        {QUIESCE_TABLE_POINT, MODELS + 1, VIEW_LIMIT + 1u},
        {QUIESCE_TABLE_POINT, MODELS + 1, (uint32_t)INT32_MIN},
        {QUIESCE_TABLE_OK, MODELS + 2, (uint32_t)INT32_MIN},
        {QUIESCE_TABLE_POINT, MODELS + 3, UINT32_MAX}, // a negative weight
    };
    for (uint32_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        expect(cases[i].verdict, cases[i].at, cases[i].value);
    }
    // Three products that together reach 2^62.
    make_bank();
    words[MODELS + 2] = INT32_MAX;
    words[MODELS + 5] = INT32_MAX;
    words[FIRST + 2] = VIEW_LIMIT;
    words[MODELS + 3] = 8;
    seal(WORDS);
    TEST_ASSERT_EQUAL_INT(QUIESCE_TABLE_POINT, verdict_of(WORDS));
}

// Any table that is accepted, on any motion: a current that a driver takes, and only for a demand
// that has the sign of a model's force.
static void test_no_table_that_is_accepted_energises(void) {
    uint32_t accepted = 0;
    for (uint32_t i = 0; i < 20000u; i++) {
        make_bank();
        for (uint32_t n = 0; n <= i % 3u; n++) {
            const uint32_t at = HEAD + (uint32_t)signal_noise(&seed, INT32_MAX) % (WORDS - HEAD);
            words[at] = (uint32_t)signal_noise(&seed, INT32_MAX) >> (i % 31u);
        }
        seal(WORDS);
        if (verdict_of(WORDS) != QUIESCE_TABLE_OK) {
            continue;
        }
        accepted++;
        bank = (force_bank_t){{0}};
        for (uint32_t t = 0; t < 20u; t++) {
            const view_damper_t damper = {.velocity_um_s =
                                              signal_noise(&seed, VIEW_LIMIT >> (i % 30u)),
                                          .stroke_nm = signal_noise(&seed, VIEW_LIMIT)};
            const int32_t demand_mN = signal_noise(&seed, INT32_MAX) >> (i % 20u);
            force_bank_move(&bank, section(), &damper);
            const int32_t mA = force_bank_current_mA(&bank, section(), &damper, demand_mN);
            TEST_ASSERT_TRUE(mA >= 0 && mA <= 20000);
            bool agrees = false;
            for (uint32_t k = 0; k < words[CURRENTS]; k++) {
                const int64_t mN = force_bank_force_mN(&bank, section(), k, &damper);
                agrees = agrees || mN * demand_mN > 0;
            }
            TEST_ASSERT_TRUE(mA == 0 || agrees);
        }
    }
    TEST_ASSERT_GREATER_THAN(1000, accepted);
}

static void test_it_says_what_it_needs_and_for_what_rate(void) {
    TEST_ASSERT_TRUE(force_bank_needs(words) == VIEW_EACH(VIEW_STROKE_VELOCITY));
    TEST_ASSERT_EQUAL_UINT32(RATE_Hz, force_bank_rate_Hz(words));
    TEST_ASSERT_EQUAL_PTR(section(), force_bank_section(words, 3));
    words[MODELS + MODEL_WORDS + 2] = UINT32_MAX;
    TEST_ASSERT_TRUE(force_bank_needs(words) == VIEW_EACH(VIEW_STROKE_VELOCITY | VIEW_STROKE));
    // A second section, without the spring, for another rate.
    make_bank();
    const uint32_t second = WORDS;
    memcpy(&words[second], &words[HEAD], (WORDS - HEAD) * sizeof words[0]);
    words[3] = 2;
    words[FIRST] = 1;
    seal(2 * WORDS - HEAD);
    TEST_ASSERT_EQUAL_INT(QUIESCE_TABLE_OK, verdict_of(2 * WORDS - HEAD));
    TEST_ASSERT_TRUE(force_bank_needs(words) ==
                     ((VIEW_STROKE_VELOCITY | VIEW_CURRENT) * 3u | VIEW_STROKE));
    TEST_ASSERT_EQUAL_PTR(&words[second], force_bank_section(words, 1));
    TEST_ASSERT_NULL(force_bank_section(words, 2));
    TEST_ASSERT_EQUAL_UINT32(RATE_Hz, force_bank_rate_Hz(words));
    words[second + RATE - HEAD] = 500;
    TEST_ASSERT_EQUAL_UINT32(0, force_bank_rate_Hz(words));
}

static void test_the_controller_refuses_another_rate_and_steps_it_each_tick(void) {
    static quiesce_t controller;
    static quiesce_out_t out;
    quiesce_params_t params;
    quiesce_board_t board;
    quiesce_params_default(&params);
    quiesce_board_default(&board);
    params.tick_rate_Hz = RATE_Hz;
    params.tracker = QUIESCE_TRACKER_BANK;
    params.slew_mA_s = 100000000;
    quiesce_board_sensor_t *sensor = &board.sensor[board.sensors++];
    *sensor = board.sensor[0];
    sensor->sense = QUIESCE_SENSE_STROKE_VELOCITY;
    sensor->scale = 1000;
    sensor->full_scale_counts = 5000000;
    sensor->stuck_us = 0;
    TEST_ASSERT_TRUE(quiesce_init_board(&controller, &board, &params));
    TEST_ASSERT_EQUAL_STRING("bank", quiesce_lacks_table(&controller));
    expect(QUIESCE_TABLE_OK, RATE, 500);
    TEST_ASSERT_EQUAL_INT(QUIESCE_TABLE_FIT, quiesce_table_use(&controller, words, WORDS));
    make_bank();
    TEST_ASSERT_EQUAL_INT(QUIESCE_TABLE_OK, quiesce_table_check(words, WORDS));
    TEST_ASSERT_EQUAL_INT(QUIESCE_TABLE_OK, quiesce_table_use(&controller, words, WORDS));
    quiesce_in_t in = {0};
    for (uint32_t t = 0; t < 1100u; t++) {
        in.tick = t;
        in.enable = t > 0;
        in.sensor[0] = (quiesce_sample_t){.counts = signal_noise(&seed, 5000), .is_fresh = true};
        in.sensor[1] = (quiesce_sample_t){.counts = t < 1000u ? 0 : 1000, .is_fresh = true};
        quiesce_step(&controller, &in, &out);
    }
    // The stop has gone its way, 10 um at 1 mm/s, and stands there; the dashpot has 4 mm/s.
    TEST_ASSERT_EQUAL_UINT32(QUIESCE_STATE_RUN, out.telemetry.state);
    TEST_ASSERT_EQUAL_INT32(963, out.telemetry.current_law_mA);
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(test_elements_stop_saturate_and_leak);
    RUN_TEST(test_a_lead_is_of_the_stroke);
    RUN_TEST(test_the_current_lies_between_two_models);
    RUN_TEST(test_forces_need_not_rise_with_the_current);
    RUN_TEST(test_no_current_where_no_force_has_the_sign);
    RUN_TEST(test_models_are_passive);
    RUN_TEST(test_malformed_banks_are_refused);
    RUN_TEST(test_no_table_that_is_accepted_energises);
    RUN_TEST(test_it_says_what_it_needs_and_for_what_rate);
    RUN_TEST(test_the_controller_refuses_another_rate_and_steps_it_each_tick);
    return UNITY_END();
}
