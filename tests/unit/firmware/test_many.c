// The controller with more than one sensor, body and damper, as a build for 8, 4 and 4 has it. A
// law of the test's own takes the place of the others: it needs the strokes of all dampers.
#include <stddef.h>
#include <string.h>

#include "law.h"
#include "quiesce.h"
#include "test_signal.h"
#include "unity.h"

enum { RATE_Hz = 1000, UNLOCK_mA = 1100, ASKED_mA = 3000 };

static quiesce_t controller;
static quiesce_board_t board;
static quiesce_params_t params;
static quiesce_in_t in;
static quiesce_out_t out;
static quiesce_picture_t picture;

// Damper i asks for ASKED_mA + 100 i.
static bool step_law(void *state, const law_setup_t *setup, const view_t *view, law_demand_t *to) {
    (void)setup;
    (void)view;
    (*(uint32_t *)state)++;
    for (int32_t i = 0; i < QUIESCE_DAMPERS; i++) {
        to->value[i] = ASKED_mA + 100 * i;
    }
    return true;
}

static void report_law(const void *state, const law_setup_t *setup, int32_t *word) {
    (void)setup;
    word[0] = (int32_t) * (const uint32_t *)state;
}

static law_t test_law = {
    .name = "test",
    .needs = VIEW_EACH(VIEW_STROKE),
    .step = step_law,
    .report = report_law,
};

const law_t *law_find(int32_t index) {
    return index >= 0 && index <= QUIESCE_LAW_PHASE ? &test_law : NULL;
}

static void add_sensor(quiesce_sense_t sense, int32_t at, int32_t scale) {
    quiesce_board_sensor_t *sensor = &board.sensor[board.sensors++];
    *sensor = board.sensor[0];
    sensor->sense = (int32_t)sense;
    sensor->at = at;
    sensor->scale = scale;
    sensor->full_scale_counts = 100000;
    sensor->stuck_us = 0;
}

// Two bodies one above the other, an accelerometer on each; a damper between them whose stroke is
// measured, one between the lower body and the ground.
static void make_board(void) {
    quiesce_board_default(&board);
    board.bodies = 2;
    board.dampers = 2;
    add_sensor(QUIESCE_SENSE_ACCEL, 1, 100000);
    add_sensor(QUIESCE_SENSE_STROKE, 0, 1000000);
    board.damper[0].end_a = 1;
    board.damper[0].end_b = 0;
    board.damper[0].safe_mA = 250;
    board.damper[1] = board.damper[0];
    board.damper[1].end_a = 0;
    board.damper[1].end_b = QUIESCE_GROUND;
    board.damper[1].safe_mA = 0;
    board.damper[1].ceiling_mA = 2500;
    board.damper[1].continuous_mA = 2500;
}

static void start(void) {
    TEST_ASSERT_TRUE(quiesce_init_board(&controller, &board, &params));
    memset(&in, 0, sizeof in);
}

void setUp(void) {
    test_law.needs = VIEW_EACH(VIEW_STROKE);
    quiesce_params_default(&params);
    params.tick_rate_Hz = RATE_Hz;
    params.unlock_current_mA = UNLOCK_mA;
    params.slew_mA_s = 100000000;
    make_board();
    start();
}
void tearDown(void) {}

// Accelerations of 1 m/s2 at 5 Hz below and 2 m/s2 above; the stroke is 3 mm at 5 Hz.
static void tick(void) {
    static uint32_t seed;
    in.tick++;
    in.enable = in.tick > 1; // its edge arms
    in.sensor[0] = (quiesce_sample_t){.counts = signal_sine(17316, 5000, in.tick, RATE_Hz) +
                                                signal_noise(&seed, 20),
                                      .is_fresh = true};
    in.sensor[1] = (quiesce_sample_t){.counts = signal_sine(20000, 5000, in.tick, RATE_Hz) +
                                                signal_noise(&seed, 20),
                                      .is_fresh = true};
    in.sensor[2] =
        (quiesce_sample_t){.counts = signal_sine(3000, 5000, in.tick, RATE_Hz), .is_fresh = true};
    quiesce_step(&controller, &in, &out);
    quiesce_picture(&controller, &picture);
}

static void run(uint32_t ticks) {
    for (; ticks > 0; ticks--) {
        tick();
    }
}

static bool is_valid(uint64_t bit) {
    return (((uint64_t)picture.valid[1] << 32 | picture.valid[0]) & bit) != 0;
}

static void test_many_each_damper_has_its_command_ceiling_and_safe_current(void) {
    tick();
    TEST_ASSERT_EQUAL_INT32(250, out.damper[0].current_cmd_mA);
    TEST_ASSERT_EQUAL_INT32(0, out.damper[1].current_cmd_mA);
    run(1000);
    TEST_ASSERT_EQUAL_UINT32(QUIESCE_STATE_RUN, out.telemetry.state);
    TEST_ASSERT_EQUAL_INT32(ASKED_mA, out.damper[0].current_cmd_mA);
    TEST_ASSERT_EQUAL_INT32(2500, out.damper[1].current_cmd_mA); // 3100 is above its ceiling
    TEST_ASSERT_EQUAL_INT32(ASKED_mA + 100, picture.damper[1].current_law_mA);
    TEST_ASSERT_EQUAL_INT32(2500, picture.damper[1].current_cmd_mA);
    for (int32_t i = 2; i < QUIESCE_DAMPERS; i++) { // not on this board
        TEST_ASSERT_EQUAL_INT32(0, out.damper[i].current_cmd_mA);
        TEST_ASSERT_FALSE(out.damper[i].driver_enable);
    }
    params.max_current_mA = 1000;
    params.constant_current_mA = 0;
    params.unlock_current_mA = 0;
    start();
    run(1000);
    TEST_ASSERT_EQUAL_INT32(1000, out.damper[0].current_cmd_mA);
    TEST_ASSERT_EQUAL_INT32(1000, out.damper[1].current_cmd_mA);
}

static void test_many_one_driver_that_fails_stops_all(void) {
    run(1000);
    in.driver[1].has_failed = true;
    tick();
    TEST_ASSERT_EQUAL_UINT32(QUIESCE_FAULT_DRIVER_FAILED, out.telemetry.fault);
    TEST_ASSERT_EQUAL_INT32(250, out.damper[0].current_cmd_mA);
    TEST_ASSERT_FALSE(out.damper[0].driver_enable);
    TEST_ASSERT_FALSE(out.damper[1].driver_enable);
}

static void test_many_current_of_either_damper_is_watched(void) {
    for (int32_t i = 0; i < 2; i++) {
        make_board();
        board.damper[i].measures_current = 1;
        start();
        in.driver[i].is_measured = true;
        for (uint32_t t = 0; t < 1000u; t++) {
            in.driver[i].current_mA =
                out.damper[i].driver_enable ? out.damper[i].current_cmd_mA : 0;
            tick();
        }
        TEST_ASSERT_EQUAL_UINT32(QUIESCE_STATE_RUN, out.telemetry.state);
        in.driver[i].current_mA = 0;
        run(100);
        TEST_ASSERT_EQUAL_UINT32(QUIESCE_FAULT_COIL_OPEN, out.telemetry.fault);
        TEST_ASSERT_EQUAL_INT32(0, picture.damper[i].current_mA);
    }
}

// Measured of damper 0: the command and as much more, for some ticks.
static void run_with_more(int32_t more_mA, uint32_t ticks) {
    in.driver[0].is_measured = true;
    for (uint32_t t = 0; t < ticks; t++) {
        const quiesce_command_t *command = &out.damper[0];
        in.driver[0].current_mA = command->driver_enable ? command->current_cmd_mA + more_mA : 0;
        tick();
    }
}

static void assert_all_off(uint32_t fault) {
    TEST_ASSERT_EQUAL_UINT32(QUIESCE_STATE_FAULT, out.telemetry.state);
    TEST_ASSERT_EQUAL_UINT32(fault, out.telemetry.fault);
    TEST_ASSERT_FALSE(out.damper[0].driver_enable);
    TEST_ASSERT_FALSE(out.damper[1].driver_enable);
}

static void test_many_a_current_above_its_trip_level_stops_all(void) {
    make_board();
    board.damper[0].measures_current = 1;
    board.damper[0].trip_mA = 7000;
    board.damper[0].trip_us = 5000;
    start();
    run_with_more(0, 1000);
    in.driver[0].current_mA = 7001;
    run(4);
    TEST_ASSERT_EQUAL_UINT32(QUIESCE_STATE_RUN, out.telemetry.state);
    run(1);
    assert_all_off(QUIESCE_FAULT_OVERCURRENT);
}

static void test_many_a_coil_that_its_driver_overheats_stops_all(void) {
    make_board();
    board.damper[0].measures_current = 1;
    board.damper[0].continuous_mA = 500;
    board.damper[0].heat_s = 5;
    params.current_error_mA = 2500;
    start();
    run_with_more(2000, 1000);
    assert_all_off(QUIESCE_FAULT_COIL_HOT);
}

// Current and voltage of a damper's coil as shares of what is commanded, in percent.
static void run_coil(int32_t i, int32_t current_pct, int32_t voltage_pct, uint32_t ticks) {
    for (; ticks > 0; ticks--) {
        const quiesce_command_t *command = &out.damper[i];
        const int32_t driven_mA = command->driver_enable ? command->current_cmd_mA : 0;
        in.driver[i] =
            (quiesce_driver_t){.current_mA = driven_mA * current_pct / 100, .is_measured = true};
        in.sensor[3] =
            (quiesce_sample_t){.counts = 2 * driven_mA * voltage_pct / 100, .is_fresh = true};
        tick();
    }
}

static void test_many_a_coil_that_is_short_or_open_is_told_by_its_voltage(void) {
    static const struct {
        int32_t current_pct, voltage_pct;
        quiesce_fault_t fault;
    } cases[] = {
        {100, 0, QUIESCE_FAULT_COIL_SHORT},
        {0, 100, QUIESCE_FAULT_COIL_OPEN},
        {0, 0, QUIESCE_FAULT_DRIVER_NOT_FOLLOWING},
        {100, 130, QUIESCE_FAULT_NONE}, // a warm coil
    };
    for (uint32_t k = 0; k < sizeof cases / sizeof cases[0]; k++) {
        const int32_t i = (int32_t)(k % 2u);
        make_board();
        add_sensor(QUIESCE_SENSE_VOLTAGE, i, 1000);
        board.damper[i].measures_current = 1;
        board.damper[i].coil_mohm = 2000;
        board.damper[i].coil_lag_us = 0;
        start();
        run_coil(i, 100, 100, 2000);
        TEST_ASSERT_EQUAL_UINT32(QUIESCE_STATE_RUN, out.telemetry.state);
        run_coil(i, cases[k].current_pct, cases[k].voltage_pct, 100);
        TEST_ASSERT_EQUAL_UINT32(cases[k].fault, out.telemetry.fault);
    }
}

// The noise of a measured current does not keep a driver off.
static void test_many_a_little_current_passes_the_self_test(void) {
    for (int32_t trip_mA = 0; trip_mA <= 6000; trip_mA += 6000) {
        make_board();
        board.damper[0].measures_current = 1;
        board.damper[0].trip_mA = trip_mA;
        start();
        for (uint32_t t = 0; t < 1000u; t++) {
            const int32_t driven_mA =
                out.damper[0].driver_enable ? out.damper[0].current_cmd_mA : 0;
            in.driver[0] = (quiesce_driver_t){.current_mA = driven_mA + (int32_t)(t % 2u) * 20 - 10,
                                              .is_measured = true};
            tick();
        }
        TEST_ASSERT_EQUAL_UINT32(QUIESCE_STATE_RUN, out.telemetry.state);
    }
}

// Before a driver is switched on there must be no current.
static void test_many_a_driver_that_is_on_by_itself_fails_the_self_test(void) {
    board.damper[0].measures_current = 1;
    start();
    for (uint32_t t = 0; t < 1000u; t++) {
        in.driver[0] = (quiesce_driver_t){.current_mA = 1500, .is_measured = true};
        tick();
        TEST_ASSERT_FALSE(out.damper[0].driver_enable);
    }
    TEST_ASSERT_EQUAL_UINT32(QUIESCE_FAULT_DRIVER_NOT_FOLLOWING, out.telemetry.fault);
}

// A parameter must not make the check of a small damper blind: half of its ceiling is the most.
static void test_many_a_small_damper_is_watched_whatever_the_parameter(void) {
    for (int32_t i = 0; i < 2; i++) {
        params.current_error_mA = i == 0 ? 500 : 20000;
        make_board();
        board.damper[0].ceiling_mA = board.damper[0].continuous_mA = 400;
        board.damper[0].measures_current = 1;
        start();
        in.driver[0].is_measured = true;
        for (uint32_t t = 0; t < 1000u; t++) {
            in.driver[0].current_mA =
                out.damper[0].driver_enable ? out.damper[0].current_cmd_mA : 0;
            tick();
        }
        TEST_ASSERT_EQUAL_UINT32(QUIESCE_STATE_RUN, out.telemetry.state);
        in.driver[0].current_mA = i == 0 ? 0 : 700;
        run(100);
        TEST_ASSERT_EQUAL_UINT32(QUIESCE_STATE_FAULT, out.telemetry.state);
    }
}

// Largest of a signal over two cycles.
static int32_t largest(const int32_t *value) {
    int32_t most = 0;
    for (uint32_t t = 0; t < 400u; t++) {
        tick();
        most = *value > most ? *value : most;
    }
    return most;
}

static void test_many_bodies_and_strokes_are_seen(void) {
    run(5000);
    // 1 m/s2 at 5 Hz: 31.8 mm/s, 1.013 mm; the cut-offs take up to 1 %.
    TEST_ASSERT_INT32_WITHIN(15000, 1000000, largest(&picture.body[0].accel_um_s2));
    TEST_ASSERT_INT32_WITHIN(600, 31600, largest(&picture.body[0].velocity_um_s));
    TEST_ASSERT_INT32_WITHIN(25000, 1003000, largest(&picture.body[0].displacement_nm));
    TEST_ASSERT_INT32_WITHIN(1200, 63300, largest(&picture.body[1].velocity_um_s));
    // Measured, not the difference of the bodies.
    TEST_ASSERT_INT32_WITHIN(3000, 3000000, largest(&picture.damper[0].stroke_nm));
    TEST_ASSERT_INT32_WITHIN(900, 31600, largest(&picture.damper[0].velocity_um_s));
    TEST_ASSERT_INT32_WITHIN(25000, 1003000, largest(&picture.damper[1].stroke_nm));
    TEST_ASSERT_TRUE(is_valid(VIEW_ACCEL) && is_valid(VIEW_ACCEL << 1));
    TEST_ASSERT_TRUE(is_valid(VIEW_STROKE) && is_valid(VIEW_STROKE << 1));
    TEST_ASSERT_TRUE(is_valid(VIEW_CURRENT) && is_valid(VIEW_CURRENT << 1));
    TEST_ASSERT_FALSE(is_valid(VIEW_CURRENT << 2));
    TEST_ASSERT_FALSE(is_valid(VIEW_FORCE) || is_valid(VIEW_ACCEL << 2));
}

// The stroke sensor says nothing more: held for 10 ms, then the law is blind.
static void lose_the_stroke(uint32_t ticks) {
    for (; ticks > 0; ticks--) {
        in.tick++;
        in.sensor[0].counts = -in.sensor[0].counts + 1;
        in.sensor[1].counts = -in.sensor[1].counts - 1;
        in.sensor[2].is_fresh = false;
        quiesce_step(&controller, &in, &out);
        quiesce_picture(&controller, &picture);
    }
}

static void test_many_a_blind_law_falls_back_then_faults_and_comes_back(void) {
    run(1000);
    lose_the_stroke(10);
    TEST_ASSERT_EQUAL_INT32(ASKED_mA, out.damper[0].current_cmd_mA);
    TEST_ASSERT_TRUE(is_valid(VIEW_STROKE));
    lose_the_stroke(1);
    int32_t steps[QUIESCE_REPORT_WORDS];
    quiesce_report(&controller, steps);
    for (uint32_t t = 0; t < 99u; t++) {
        TEST_ASSERT_FALSE(is_valid(VIEW_STROKE));
        TEST_ASSERT_EQUAL_INT32(UNLOCK_mA, out.damper[0].current_cmd_mA);
        TEST_ASSERT_EQUAL_INT32(UNLOCK_mA, out.damper[1].current_cmd_mA);
        TEST_ASSERT_EQUAL_UINT32(QUIESCE_STATE_RUN, out.telemetry.state);
        lose_the_stroke(1);
    }
    lose_the_stroke(1);
    TEST_ASSERT_EQUAL_UINT32(QUIESCE_STATE_SAFE, out.telemetry.state);
    TEST_ASSERT_EQUAL_UINT32(QUIESCE_FAULT_LAW_BLIND, out.telemetry.fault);
    TEST_ASSERT_EQUAL_INT32(250, out.damper[0].current_cmd_mA);
    int32_t later[QUIESCE_REPORT_WORDS];
    quiesce_report(&controller, later);
    TEST_ASSERT_EQUAL_INT32(steps[0], later[0]); // not stepped once
    lose_the_stroke(1000);                       // neither idle nor running by itself
    TEST_ASSERT_EQUAL_UINT32(1, out.telemetry.fault_count);
    TEST_ASSERT_EQUAL_INT32(250, out.damper[0].current_cmd_mA);
    run(1000);
    TEST_ASSERT_EQUAL_UINT32(QUIESCE_STATE_RUN, out.telemetry.state);
    TEST_ASSERT_EQUAL_INT32(ASKED_mA, out.damper[0].current_cmd_mA);
}

static void test_many_a_sensor_that_nobody_needs_may_fail(void) {
    test_law.needs = VIEW_EACH(VIEW_ACCEL);
    start();
    run(1000);
    lose_the_stroke(1000);
    TEST_ASSERT_EQUAL_UINT32(QUIESCE_STATE_RUN, out.telemetry.state);
    TEST_ASSERT_EQUAL_UINT32(0, out.telemetry.fault_count);
}

static void assert_missing(uint64_t needs, const char *name, int32_t at) {
    quiesce_signal_t missing = {NULL, 0};
    test_law.needs = needs;
    TEST_ASSERT_TRUE(quiesce_missing(&board, &params, &missing));
    TEST_ASSERT_EQUAL_STRING(name, missing.name);
    TEST_ASSERT_EQUAL_INT32(at, missing.at);
    TEST_ASSERT_FALSE(quiesce_init_board(&controller, &board, &params));
    tick();
    TEST_ASSERT_EQUAL_UINT32(QUIESCE_FAULT_PARAMETER, out.telemetry.fault);
    TEST_ASSERT_EQUAL_INT32(250, out.damper[0].current_cmd_mA);
    TEST_ASSERT_FALSE(out.damper[0].driver_enable);
}

static void test_many_a_law_that_needs_what_is_not_there_is_refused_by_name(void) {
    quiesce_signal_t missing;
    assert_missing(VIEW_FORCE, "force", 0);
    assert_missing(VIEW_EACH(VIEW_TEMPERATURE), "temperature", 0);
    assert_missing(VIEW_ACCEL << 2, "acceleration", 2);
    assert_missing(VIEW_SUPPLY, "supply voltage", -1);
    add_sensor(QUIESCE_SENSE_FORCE, 0, 1000);
    assert_missing(VIEW_EACH(VIEW_FORCE), "force", 1);
    test_law.needs = VIEW_FORCE | VIEW_EACH(VIEW_STROKE) | VIEW_EACH(VIEW_DISPLACEMENT);
    TEST_ASSERT_FALSE(quiesce_missing(&board, &params, &missing));
    // Without the accelerometer above, the measured stroke is all that is known up there.
    board.sensor[1] = board.sensor[3];
    board.sensors = 3;
    assert_missing(VIEW_EACH(VIEW_VELOCITY), "velocity", 1);
    assert_missing(VIEW_EACH(VIEW_STROKE_VELOCITY), "stroke velocity", 0);
    test_law.needs = VIEW_EACH(VIEW_STROKE);
    TEST_ASSERT_FALSE(quiesce_missing(&board, &params, &missing));
}

// Every kind of sensor, at its place, in its unit.
static void test_many_measured_quantities_arrive(void) {
    quiesce_board_default(&board);
    add_sensor(QUIESCE_SENSE_VELOCITY, 0, 2000);
    add_sensor(QUIESCE_SENSE_DISPLACEMENT, 0, 3000);
    add_sensor(QUIESCE_SENSE_FORCE, 0, 4000);
    add_sensor(QUIESCE_SENSE_VOLTAGE, 0, 5000);
    add_sensor(QUIESCE_SENSE_TEMPERATURE, 0, 6000);
    add_sensor(QUIESCE_SENSE_SUPPLY, 0, 7000);
    add_sensor(QUIESCE_SENSE_STROKE_VELOCITY, 0, 8000);
    board.sensor[3].polarity = -1;
    board.sensor[3].offset_counts = 100;
    start();
    for (uint32_t t = 0; t < 20u; t++) {
        in.tick++;
        for (int32_t i = 0; i < board.sensors; i++) {
            in.sensor[i] = (quiesce_sample_t){.counts = 1000 + i, .is_fresh = true};
        }
        quiesce_step(&controller, &in, &out);
    }
    quiesce_picture(&controller, &picture);
    TEST_ASSERT_EQUAL_INT32(2 * 1001, picture.body[0].velocity_um_s);
    TEST_ASSERT_EQUAL_INT32(3 * 1002, picture.body[0].displacement_nm);
    TEST_ASSERT_EQUAL_INT32(-4 * 903, picture.damper[0].force_mN);
    TEST_ASSERT_EQUAL_INT32(5 * 1004, picture.damper[0].voltage_mV);
    TEST_ASSERT_EQUAL_INT32(6 * 1005, picture.damper[0].temperature_mdegC);
    TEST_ASSERT_EQUAL_INT32(7 * 1006, picture.supply_mV);
    TEST_ASSERT_EQUAL_INT32(8 * 1007, picture.damper[0].velocity_um_s);
    TEST_ASSERT_EQUAL_INT32(3 * 1002, picture.damper[0].stroke_nm); // of body and ground
    TEST_ASSERT_TRUE(is_valid(VIEW_SUPPLY) && is_valid(VIEW_TEMPERATURE));
    TEST_ASSERT_TRUE(is_valid(VIEW_FORCE) && is_valid(VIEW_VOLTAGE));
}

// 50 Hz into a loop of 1 kHz: held between its samples, lost when one is missing for too long.
static void test_many_a_slow_sensor_is_held(void) {
    board.sensor[2].period_us = 20000;
    board.sensor[2].max_age_us = 60000;
    start();
    for (uint32_t t = 0; t < 400u; t++) {
        in.tick++;
        in.sensor[2] = (quiesce_sample_t){.counts = (int32_t)(t / 20u), .is_fresh = t % 20u == 0};
        quiesce_step(&controller, &in, &out);
        quiesce_picture(&controller, &picture);
        TEST_ASSERT_EQUAL_INT32(1000 * (int32_t)(t / 20u), picture.damper[0].stroke_nm);
        TEST_ASSERT_TRUE(is_valid(VIEW_STROKE));
    }
    for (uint32_t t = 19; t < 60u; t++) { // 60 ms after the last one, 19 of which are over
        in.tick++;
        in.sensor[2].is_fresh = false;
        quiesce_step(&controller, &in, &out);
        quiesce_picture(&controller, &picture);
        TEST_ASSERT_TRUE(is_valid(VIEW_STROKE));
    }
    in.tick++;
    quiesce_step(&controller, &in, &out);
    quiesce_picture(&controller, &picture);
    TEST_ASSERT_FALSE(is_valid(VIEW_STROKE));
}

// Every third sample is lost: each gap is short, together they are too many.
static void test_many_a_budget_of_lost_samples(void) {
    board.sensor[2].max_lost_pct = 20;
    test_law.needs = 0;
    start();
    bool was_lost = false;
    for (uint32_t t = 0; t < 3000u; t++) {
        in.tick++;
        in.sensor[2] = (quiesce_sample_t){.counts = 5, .is_fresh = t % 3u != 0};
        quiesce_step(&controller, &in, &out);
        quiesce_picture(&controller, &picture);
        was_lost = was_lost || (t > 0 && !is_valid(VIEW_STROKE));
    }
    TEST_ASSERT_TRUE(was_lost);
    TEST_ASSERT_FALSE(is_valid(VIEW_STROKE));
    for (uint32_t t = 0; t < 1000u; t++) {
        in.tick++;
        in.sensor[2] = (quiesce_sample_t){.counts = 5, .is_fresh = t % 10u != 0};
        quiesce_step(&controller, &in, &out);
        quiesce_picture(&controller, &picture);
    }
    TEST_ASSERT_TRUE(is_valid(VIEW_STROKE));
}

// Samples, not ticks, are lost; a period of two and a half ticks is no loss.
static void test_many_a_budget_of_a_slow_sensor(void) {
    const struct {
        int32_t period_us;
        uint32_t lost_of_10;
        int32_t max_lost_pct;
        bool is_good;
    } cases[] = {
        {2500, 0, 5, true},
        {10000, 1, 20, true},
        {10000, 4, 20, false},
        {10000, 4, 60, true},
    };
    for (uint32_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        board.sensor[2].period_us = cases[i].period_us;
        board.sensor[2].max_age_us = 60000;
        board.sensor[2].max_lost_pct = cases[i].max_lost_pct;
        test_law.needs = 0;
        start();
        uint32_t period = 0;
        for (uint32_t t = 0; t < 8000u; t++) {
            const uint32_t now = t * 1000u / (uint32_t)cases[i].period_us;
            in.tick++;
            in.sensor[2] = (quiesce_sample_t){
                .counts = 5, .is_fresh = now != period && now % 10u >= cases[i].lost_of_10};
            period = now;
            quiesce_step(&controller, &in, &out);
        }
        quiesce_picture(&controller, &picture);
        TEST_ASSERT_EQUAL(cases[i].is_good, is_valid(VIEW_STROKE));
    }
}

static void test_many_a_copy_of_the_state_is_the_controller(void) {
    run(1000);
    static quiesce_t copy;
    copy = controller;
    const quiesce_in_t now = in;
    run(300);
    const quiesce_out_t expected = out;
    memset(&controller, 0xA5, sizeof controller);
    controller = copy;
    in = now;
    // The same noise again would need the same seed: without noise both differ by nothing.
    TEST_ASSERT_EQUAL_INT32(ASKED_mA, expected.damper[0].current_cmd_mA);
    run(300);
    TEST_ASSERT_EQUAL_INT32(expected.damper[0].current_cmd_mA, out.damper[0].current_cmd_mA);
    TEST_ASSERT_EQUAL_UINT32(QUIESCE_STATE_RUN, out.telemetry.state);
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(test_many_each_damper_has_its_command_ceiling_and_safe_current);
    RUN_TEST(test_many_one_driver_that_fails_stops_all);
    RUN_TEST(test_many_current_of_either_damper_is_watched);
    RUN_TEST(test_many_a_current_above_its_trip_level_stops_all);
    RUN_TEST(test_many_a_coil_that_its_driver_overheats_stops_all);
    RUN_TEST(test_many_a_coil_that_is_short_or_open_is_told_by_its_voltage);
    RUN_TEST(test_many_a_little_current_passes_the_self_test);
    RUN_TEST(test_many_a_driver_that_is_on_by_itself_fails_the_self_test);
    RUN_TEST(test_many_a_small_damper_is_watched_whatever_the_parameter);
    RUN_TEST(test_many_bodies_and_strokes_are_seen);
    RUN_TEST(test_many_a_blind_law_falls_back_then_faults_and_comes_back);
    RUN_TEST(test_many_a_sensor_that_nobody_needs_may_fail);
    RUN_TEST(test_many_a_law_that_needs_what_is_not_there_is_refused_by_name);
    RUN_TEST(test_many_measured_quantities_arrive);
    RUN_TEST(test_many_a_slow_sensor_is_held);
    RUN_TEST(test_many_a_budget_of_lost_samples);
    RUN_TEST(test_many_a_budget_of_a_slow_sensor);
    RUN_TEST(test_many_a_copy_of_the_state_is_the_controller);
    return UNITY_END();
}
