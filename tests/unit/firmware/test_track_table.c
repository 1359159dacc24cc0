// What a tracker's table needs, and its state beside the law's: laws and a tracker of the test's
// own take the place of the others. The tracker's table of one word of its own says which bits.
#include <string.h>

#include "crc32.h"
#include "law.h"
#include "quiesce.h"
#include "test_signal.h"
#include "track.h"
#include "unity.h"

enum { RATE_Hz = 1000, ASKED_mA = 900, UNLOCK_mA = 1100, MAGIC = 0x54534554, WORDS = 5 };
enum { LAW_FULL = 1, LAW_MAGIC = 0x4C4C5546, LAW_WORDS = 3 };
enum { STATE_WORDS = LAW_FORCE_STATE_BYTES / sizeof(uint32_t) };

static quiesce_t controller;
static quiesce_board_t board;
static quiesce_params_t params;
static quiesce_in_t in;
static quiesce_out_t out;
static uint32_t seed;

static bool step_law(void *state, const law_setup_t *setup, const view_t *view, law_demand_t *to) {
    (void)state;
    (void)setup;
    (void)view;
    law_demand_all(to, 1000);
    return true;
}

static const law_t test_law = {.name = "test", .demands = LAW_DEMANDS_FORCE, .step = step_law};

// Every word of what it may have is a tick more for each tick since it began.
static bool step_full(void *state, const law_setup_t *setup, const view_t *view, law_demand_t *to) {
    uint32_t *words = state;
    for (uint32_t i = 0; i < STATE_WORDS; i++) {
        words[i]++;
    }
    return step_law(state, setup, view, to);
}

static void report_full(const void *state, const law_setup_t *setup,
                        int32_t word[QUIESCE_REPORT_WORDS]) {
    (void)setup;
    const uint32_t *words = state;
    word[0] = (int32_t)words[0];
    for (uint32_t i = 1; i < STATE_WORDS; i++) {
        word[1] += words[i] != words[0] ? 1 : 0;
    }
}

static const uint32_t law_table[LAW_WORDS] = {LAW_MAGIC, 0x33F170F2, LAW_WORDS};

static quiesce_table_verdict_t check_any(const uint32_t *words) {
    (void)words;
    return QUIESCE_TABLE_OK;
}

static const table_kind_t full_kind = {
    .magic = LAW_MAGIC, .least_words = LAW_WORDS, .shipped = law_table, .check = check_any};
static const law_t full_law = {.name = "full",
                               .kind = &full_kind,
                               .demands = LAW_DEMANDS_FORCE,
                               .step = step_full,
                               .report = report_full};

const law_t *law_find(int32_t index) {
    if (index == LAW_FULL) {
        return &full_law;
    }
    return index >= 0 && index <= QUIESCE_LAW_PHASE ? &test_law : NULL;
}

static uint64_t needs(const uint32_t *words) {
    return words[3] | (uint64_t)words[4] << 32;
}

// One more for each tick since it began.
static int32_t step_track(void *state, const track_setup_t *setup, const view_damper_t *damper,
                          int32_t demand_mN) {
    (void)setup;
    (void)damper;
    (void)demand_mN;
    return ASKED_mA + (int32_t)(*(uint32_t *)state)++;
}

static const table_kind_t kind = {
    .magic = MAGIC, .least_words = WORDS, .check = check_any, .needs = needs};
static const track_t test_track = {.name = "test", .kind = &kind, .step = step_track};

const track_t *track_find(int32_t index) {
    return index >= 0 ? &test_track : NULL;
}

static const uint32_t *table_of(uint64_t bits) {
    static uint32_t tables[2][WORDS];
    static uint32_t turn;
    uint32_t *words = tables[turn++ % 2u];
    words[0] = MAGIC;
    words[2] = WORDS;
    words[3] = (uint32_t)bits;
    words[4] = (uint32_t)(bits >> 32);
    words[1] = crc32_words(&words[2], WORDS - 2);
    return words;
}

static quiesce_table_verdict_t use(uint64_t bits) {
    return quiesce_table_use(&controller, table_of(bits), WORDS);
}

// An accelerometer and a force sensor.
void setUp(void) {
    seed = 1;
    quiesce_params_default(&params);
    params.tick_rate_Hz = RATE_Hz;
    params.unlock_current_mA = UNLOCK_mA;
    params.slew_mA_s = 100000000;
    quiesce_board_default(&board);
    quiesce_board_sensor_t *sensor = &board.sensor[board.sensors++];
    *sensor = board.sensor[0];
    sensor->sense = QUIESCE_SENSE_FORCE;
    sensor->scale = 1000;
    sensor->full_scale_counts = 5000000;
    sensor->stuck_us = 0;
    TEST_ASSERT_TRUE(quiesce_init_board(&controller, &board, &params));
    memset(&in, 0, sizeof in);
}
void tearDown(void) {}

static void run(uint32_t ticks, bool has_force) {
    for (; ticks > 0; ticks--) {
        in.tick++;
        in.enable = in.tick > 1; // its edge arms
        in.sensor[0] = (quiesce_sample_t){.counts = signal_sine(17316, 5000, in.tick, RATE_Hz) +
                                                    signal_noise(&seed, 20),
                                          .is_fresh = true};
        in.sensor[1] = (quiesce_sample_t){.counts = 30000, .is_fresh = has_force};
        quiesce_step(&controller, &in, &out);
    }
}

static void test_a_table_that_the_board_cannot_serve_is_refused(void) {
    TEST_ASSERT_EQUAL_INT(QUIESCE_TABLE_FIT, use(VIEW_TEMPERATURE));
    TEST_ASSERT_EQUAL_INT(QUIESCE_TABLE_FIT, use(VIEW_FORCE << 1));
    TEST_ASSERT_EQUAL_INT(QUIESCE_TABLE_FIT, use(VIEW_CURRENT << 1)); // no second damper
    TEST_ASSERT_EQUAL_STRING("test", quiesce_lacks_table(&controller));
    TEST_ASSERT_EQUAL_INT(QUIESCE_TABLE_OK,
                          use(VIEW_FORCE | VIEW_STROKE | VIEW_STROKE_VELOCITY | VIEW_CURRENT));
    TEST_ASSERT_NULL(quiesce_lacks_table(&controller));
    const uint32_t hash = quiesce_table_hash(&controller);
    TEST_ASSERT_EQUAL_INT(QUIESCE_TABLE_FIT, use(VIEW_TEMPERATURE));
    TEST_ASSERT_EQUAL_HEX32(hash, quiesce_table_hash(&controller));
}

// Without the force the tracker is not stepped; with a table that does not ask for it it is.
static void test_a_tracker_waits_for_what_its_table_needs(void) {
    TEST_ASSERT_EQUAL_INT(QUIESCE_TABLE_OK, use(VIEW_FORCE));
    run(1000, true);
    TEST_ASSERT_EQUAL_UINT32(QUIESCE_STATE_RUN, out.telemetry.state);
    TEST_ASSERT_GREATER_OR_EQUAL_INT32(ASKED_mA, out.telemetry.current_law_mA);
    run(300, false);
    TEST_ASSERT_EQUAL_INT32(UNLOCK_mA, out.telemetry.current_law_mA);
    TEST_ASSERT_EQUAL_UINT32(QUIESCE_FAULT_LAW_BLIND, out.telemetry.fault);
    TEST_ASSERT_EQUAL_INT(QUIESCE_TABLE_OK, use(0));
    run(1, false);
    TEST_ASSERT_EQUAL_INT32(ASKED_mA, out.telemetry.current_law_mA);
    // Nothing is left of what the last one needed.
    TEST_ASSERT_EQUAL_INT(QUIESCE_TABLE_OK, use(VIEW_FORCE));
    TEST_ASSERT_TRUE(quiesce_table_drop(&controller, QUIESCE_OF_TRACKER));
    TEST_ASSERT_EQUAL_INT(QUIESCE_TABLE_OK, use(0));
    run(1, false);
    TEST_ASSERT_EQUAL_INT32(ASKED_mA, out.telemetry.current_law_mA);
}

// Strokes, that nobody else asks for, are made for the table.
static void test_what_a_table_needs_is_served(void) {
    TEST_ASSERT_EQUAL_INT(QUIESCE_TABLE_OK, use(VIEW_STROKE | VIEW_STROKE_VELOCITY));
    run(10000, true);
    TEST_ASSERT_EQUAL_UINT32(QUIESCE_STATE_RUN, out.telemetry.state);
    TEST_ASSERT_GREATER_THAN_INT32(ASKED_mA + 5000, out.telemetry.current_law_mA);
}

static void test_another_table_starts_from_rest(void) {
    TEST_ASSERT_EQUAL_INT(QUIESCE_TABLE_OK, use(0));
    run(1000, true);
    TEST_ASSERT_EQUAL_INT32(ASKED_mA + 999, out.telemetry.current_law_mA);
    TEST_ASSERT_EQUAL_INT(QUIESCE_TABLE_OK, use(VIEW_CURRENT));
    run(1, true);
    TEST_ASSERT_EQUAL_INT32(ASKED_mA, out.telemetry.current_law_mA);
    // One that is refused takes nothing away.
    TEST_ASSERT_EQUAL_INT(QUIESCE_TABLE_FIT, use(VIEW_TEMPERATURE));
    run(1, true);
    TEST_ASSERT_EQUAL_INT32(ASKED_mA + 1, out.telemetry.current_law_mA);
}

// With the law that fills its part of the memory, and a tracker's table.
static void run_full(uint32_t ticks) {
    params.law = LAW_FULL;
    TEST_ASSERT_TRUE(quiesce_init_board(&controller, &board, &params));
    TEST_ASSERT_EQUAL_INT(QUIESCE_TABLE_OK, use(0));
    run(ticks, true);
}

static void expect_ticks(const quiesce_t *of, int32_t law, int32_t tracker) {
    int32_t word[QUIESCE_REPORT_WORDS];
    quiesce_report(of, word);
    TEST_ASSERT_EQUAL_INT32(law, word[0]);
    TEST_ASSERT_EQUAL_INT32(0, word[1]);
    TEST_ASSERT_EQUAL_INT32(ASKED_mA + tracker - 1, out.telemetry.current_law_mA);
}

static void test_a_table_of_one_leaves_the_others_state(void) {
    run_full(1000);
    expect_ticks(&controller, 1000, 1000);
    TEST_ASSERT_EQUAL_INT(QUIESCE_TABLE_OK, quiesce_table_use(&controller, law_table, LAW_WORDS));
    run(1, true);
    expect_ticks(&controller, 1, 1001);
    TEST_ASSERT_EQUAL_INT(QUIESCE_TABLE_OK, use(0));
    run(1, true);
    expect_ticks(&controller, 2, 1);
}

static void test_a_copy_goes_on_where_the_controller_was(void) {
    static quiesce_t copy;
    run_full(1000);
    copy = controller;
    memset(&controller, 0xA5, sizeof controller);
    in.tick++;
    quiesce_step(&copy, &in, &out);
    expect_ticks(&copy, 1001, 1001);
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(test_a_table_that_the_board_cannot_serve_is_refused);
    RUN_TEST(test_a_tracker_waits_for_what_its_table_needs);
    RUN_TEST(test_what_a_table_needs_is_served);
    RUN_TEST(test_another_table_starts_from_rest);
    RUN_TEST(test_a_table_of_one_leaves_the_others_state);
    RUN_TEST(test_a_copy_goes_on_where_the_controller_was);
    return UNITY_END();
}
