// A controller of eight sensors and four dampers with its messages: each has its own, and none
// takes another's.
#include "can_make.h"
#include "node.h"
#include "unity.h"

#include <stddef.h>
#include <string.h>

#define OP(name) QUIESCE_CAN_SERVICE_REQUEST_OPERATION_##name##_CHOICE
#define OK QUIESCE_CAN_CURRENT_MEASURED_DRIVER_STATUS_OK_CHOICE
#define SHORT QUIESCE_CAN_CURRENT_MEASURED_DRIVER_STATUS_SHORT_CHOICE
#define INDEX_OF(field) (offsetof(quiesce_params_t, field) / sizeof(int32_t))
#define SENSORS 8u
#define DAMPERS 4u
#define ALL_SENSORS 0xFFu

static node_t node;
static quiesce_params_t params;
static quiesce_board_t wiring;
static node_inputs_t board;
static can_frame_t frames[NODE_MAX_FRAMES];
static uint32_t frame_count;
static uint32_t seed;

// Accelerometers of four bodies, strokes of four dampers; ceilings of 1, 2, 3, 4 A, safe currents
// of 100 .. 400 mA.
static void wire_all(void) {
    quiesce_board_error_t error = {0};
    quiesce_board_default(&wiring);
    wiring.sensors = (int32_t)SENSORS;
    wiring.bodies = 4;
    wiring.dampers = (int32_t)DAMPERS;
    for (int32_t i = 0; i < 8; i++) {
        wiring.sensor[i] = wiring.sensor[0];
        wiring.sensor[i].sense = i < 4 ? QUIESCE_SENSE_ACCEL : QUIESCE_SENSE_STROKE;
        wiring.sensor[i].at = i % 4;
        wiring.sensor[i].scale = i < 4 ? wiring.sensor[0].scale : 1000;
    }
    for (int32_t i = 0; i < 4; i++) {
        wiring.damper[i] = wiring.damper[0];
        wiring.damper[i].end_a = i;
        wiring.damper[i].ceiling_mA = 1000 * (i + 1);
        wiring.damper[i].continuous_mA = 1000 * (i + 1);
        wiring.damper[i].safe_mA = 100 * (i + 1);
    }
    TEST_ASSERT_TRUE_MESSAGE(quiesce_board_check(&wiring, &error), error.name);
}

static void start(uint32_t sensors_on_bus) {
    const node_sources_t from = {.enable = NODE_ENABLE_BOARD, .sensors_on_bus = sensors_on_bus};
    memset(&node, 0xA5, sizeof node);
    TEST_ASSERT_TRUE(node_init(&node, &wiring, &params, from));
}

void setUp(void) {
    quiesce_params_default(&params);
    params.law = QUIESCE_LAW_CONSTANT;
    params.max_current_mA = 5000;
    params.constant_current_mA = 5000;
    params.safe_current_mA = 4999; // the board's go before it
    board = (node_inputs_t){.enable = true, .ticks_elapsed = 1};
    seed = 1;
    wire_all();
    start(0);
}

void tearDown(void) {}

static void tick(void) {
    node_inputs_t given = board;
    given.enable = given.enable && node.in.tick > 0; // its edge arms
    frame_count = node_tick(&node, &given, frames);
}

// Ticks with live sensors on the board.
static void run(uint32_t ticks) {
    for (uint32_t i = 0; i < ticks; i++) {
        for (uint32_t k = 0; k < SENSORS; k++) {
            seed = seed * 1664525u + 1013904223u;
            board.sensor[k] =
                (quiesce_sample_t){.counts = (int32_t)(seed >> 16) - 32768, .is_fresh = true};
        }
        tick();
    }
}

static void receive(can_frame_t frame) {
    node_receive(&node, &frame);
}

static struct quiesce_can_current_demand_t unpack(const can_frame_t *frame) {
    struct quiesce_can_current_demand_t wire;
    TEST_ASSERT_TRUE(is_well_made(frame));
    (void)quiesce_can_current_demand_unpack(&wire, frame->data, frame->length);
    return wire;
}

static void check_demands(uint32_t alive) {
    for (uint32_t i = 0; i < DAMPERS; i++) {
        TEST_ASSERT_EQUAL_HEX32(0x10u + i, frames[i].id);
        const struct quiesce_can_current_demand_t demand = unpack(&frames[i]);
        TEST_ASSERT_EQUAL_INT32(node.out.damper[i].current_cmd_mA, demand.current_cmd_mA);
        TEST_ASSERT_EQUAL(node.out.damper[i].driver_enable, demand.driver_is_enabled);
        TEST_ASSERT_EQUAL_UINT8(node.out.telemetry.state, demand.state);
        TEST_ASSERT_EQUAL_UINT8(alive % 16u, demand.alive);
    }
}

static void check_currents(const int32_t expected_mA[DAMPERS], bool is_enabled) {
    for (uint32_t i = 0; i < DAMPERS; i++) {
        TEST_ASSERT_EQUAL_INT32(expected_mA[i], node.out.damper[i].current_cmd_mA);
        TEST_ASSERT_EQUAL(is_enabled, node.out.damper[i].driver_enable);
    }
}

static const int32_t ceilings_mA[DAMPERS] = {1000, 2000, 3000, 4000};
static const int32_t safe_mA[DAMPERS] = {100, 200, 300, 400};

static void test_every_damper_has_its_demand_in_every_tick(void) {
    check_currents(safe_mA, false); // until the first tick
    for (uint32_t i = 0; i < 3000; i++) {
        run(1);
        TEST_ASSERT_LESS_OR_EQUAL_UINT32(NODE_MAX_FRAMES, frame_count);
        check_demands(i);
        for (uint32_t k = 1; k < frame_count; k++) {
            TEST_ASSERT_TRUE(is_well_made(&frames[k]) && frames[k].id > frames[k - 1u].id);
        }
    }
    TEST_ASSERT_EQUAL_UINT32(QUIESCE_STATE_RUN, node.out.telemetry.state);
    check_currents(ceilings_mA, true);
}

static void test_only_dampers_of_the_board_have_demands(void) {
    wiring.dampers = 2;
    wiring.sensors = 6;
    start(0);
    for (uint32_t i = 0; i < 100; i++) {
        run(1);
        TEST_ASSERT_EQUAL_HEX32(0x11, frames[1].id);
        TEST_ASSERT_TRUE(frame_count == 2u || frames[2].id >= 0x100u);
    }
    TEST_ASSERT_EQUAL_UINT32(2, node_farewell(&node, frames));
}

static void test_busiest_tick_has_room_for_all(void) {
    uint32_t most = 0;
    receive(make_request(OP(RAW_STREAM), 0, 3600, 0));
    for (uint32_t i = 0; i < 5000; i++) {
        board.estop = i % 100u < 50u;
        board.fault_reset = i % 100u == 60u;
        receive(make_request(OP(READ), 0, 0, (uint8_t)(i % 16u)));
        run(1);
        most = frame_count > most ? frame_count : most;
        TEST_ASSERT_EQUAL_HEX32(0x13, frames[3].id);
        TEST_ASSERT_TRUE(frame_count == 4u || frames[4].id > 0x13u);
    }
    TEST_ASSERT_EQUAL_UINT32(7,
                             most); // demands, raw sample, two of freeze frame, reply, cyclic ones
}

// Frames of all sensors, of which the next one is of counter 0.
static void introduce_sensors(void) {
    for (uint8_t alive = 14; alive < 16; alive++) {
        for (uint32_t i = 0; i < SENSORS; i++) {
            receive(make_sample(i, 1, alive));
        }
        tick();
    }
}

static void test_each_sensor_is_where_it_was_set_up(void) {
    start(0x25); // 0, 2 and 5 are on the bus
    introduce_sensors();
    for (uint32_t i = 0; i < SENSORS; i++) {
        receive(make_sample(i, 1000 + (int32_t)i, 0));
        board.sensor[i] = (quiesce_sample_t){.counts = -1000 - (int32_t)i, .is_fresh = true};
    }
    tick();
    for (uint32_t i = 0; i < SENSORS; i++) {
        const int32_t counts = (int32_t)i + 1000;
        TEST_ASSERT_TRUE(node.in.sensor[i].is_fresh);
        TEST_ASSERT_EQUAL_INT32((0x25u >> i & 1u) != 0 ? counts : -counts,
                                node.in.sensor[i].counts);
    }
    tick();
    for (uint32_t i = 0; i < SENSORS; i++) { // a bus sample is there once
        TEST_ASSERT_EQUAL((0x25u >> i & 1u) == 0, node.in.sensor[i].is_fresh);
    }
}

static void test_each_sender_has_its_own_counter(void) {
    start(ALL_SENSORS);
    for (uint32_t t = 0; t < 4; t++) { // in the end one repeats its counter, the others go on
        for (uint32_t i = 0; i < SENSORS; i++) {
            receive(make_sample(i, 2, (uint8_t)(i + (i == 3u && t == 3u ? 2u : t))));
        }
        tick();
    }
    for (uint32_t i = 0; i < SENSORS; i++) {
        TEST_ASSERT_EQUAL(i != 3u, node.in.sensor[i].is_fresh);
    }
    TEST_ASSERT_EQUAL_UINT32(1, can_node_counters(&node.can)->rejected_alive);
    TEST_ASSERT_EQUAL_UINT32(15, can_node_counters(&node.can)->accepted);
}

// A node that hangs repeats its last frame; between the samples of a slow one its counter stays
// known.
static void test_a_slow_sensor_that_hangs_is_not_fresh(void) {
    wiring.sensor[5].period_us = 20000;
    wiring.sensor[5].max_age_us = 100000;
    wiring.sensor[5].stuck_us = 0;
    start(ALL_SENSORS);
    uint32_t fresh = 0;
    for (uint32_t t = 0; t < 1000; t++) {
        if (t % 20u == 0) {
            receive(make_sample(5, 1, (uint8_t)(t < 400u ? t / 20u % 16u : 3u)));
        }
        tick();
        fresh += node.in.sensor[5].is_fresh ? 1u : 0u;
    }
    // 20 live ones from the third on, the last with counter 3, and 30 of the same.
    TEST_ASSERT_EQUAL_UINT32(18, fresh);
}

// The CRC is over the id, too: a frame under another's id is no frame of it.
static void test_no_frame_counts_as_anothers(void) {
    start(ALL_SENSORS);
    uint32_t refused = 0;
    for (uint32_t from = 0; from < SENSORS; from++) {
        for (uint32_t to = 0; to < SENSORS; to++) {
            can_frame_t frame = make_sample(from, 7, 1);
            frame.id = 0x30u + to;
            if (from != to) {
                receive(frame);
                refused++;
            }
        }
    }
    for (uint32_t from = 0; from < DAMPERS; from++) {
        can_frame_t frame = make_driver_of(from, 7, SHORT, 1);
        frame.id = 0x40u + (from + 1u) % DAMPERS;
        receive(frame);
        refused++;
    }
    tick();
    TEST_ASSERT_EQUAL_UINT32(refused, can_node_counters(&node.can)->rejected_crc);
    for (uint32_t i = 0; i < SENSORS; i++) {
        TEST_ASSERT_FALSE(node.in.sensor[i].is_fresh);
    }
    TEST_ASSERT_NOT_EQUAL(QUIESCE_FAULT_DRIVER_FAILED, node.out.telemetry.fault);
}

static void test_each_measured_current_is_gone_after_its_timeout(void) {
    for (uint8_t alive = 14; alive <= 16; alive++) {
        for (uint32_t i = 0; i < DAMPERS; i++) {
            receive(make_driver_of(i, (int16_t)(100 + (int16_t)i), OK, alive % 16u));
        }
        run(alive < 16u ? 10 : 0);
    }
    for (uint32_t i = 1; i <= 60; i++) {
        run(1);
        for (uint32_t k = 0; k < DAMPERS; k++) { // damper 2 goes on
            TEST_ASSERT_EQUAL(k == 2u || i <= 50u, node.in.driver[k].is_measured);
            TEST_ASSERT_EQUAL_INT32(100 + (int32_t)k, node.in.driver[k].current_mA);
        }
        if (i % 10u == 0) {
            receive(make_driver_of(2, 102, OK, (uint8_t)(i / 10u)));
        }
    }
}

static void check_failure(void) {
    TEST_ASSERT_EQUAL_UINT32(QUIESCE_STATE_FAULT, node.out.telemetry.state);
    TEST_ASSERT_EQUAL_UINT32(QUIESCE_FAULT_DRIVER_FAILED, node.out.telemetry.fault);
    check_currents(safe_mA, false);
}

static void test_one_driver_that_fails_switches_all_off(void) {
    for (uint32_t i = 0; i < DAMPERS; i++) {
        start(0);
        run(2000);
        TEST_ASSERT_EQUAL_UINT32(QUIESCE_STATE_RUN, node.out.telemetry.state);
        receive(make_driver_of(i, 0, SHORT, 0));
        run(1);
        check_failure();
        start(0);
        run(2000);
        board.driver[i].has_failed = true;
        run(1);
        board.driver[i].has_failed = false;
        check_failure();
    }
}

static void disarm(void) {
    board.enable = false;
    run(1);
}

static void ask(uint32_t operation, uint32_t index, int32_t value) {
    static uint8_t alive;
    struct quiesce_can_service_reply_t reply = {.result = 15};
    receive(make_request((uint8_t)operation, (uint8_t)index, value, ++alive % 16u));
    for (uint32_t i = 0; i < 11 && reply.result == 15u; i++) {
        run(1);
        const can_frame_t *last = &frames[frame_count - 1u];
        if (last->id == QUIESCE_CAN_SERVICE_REPLY_FRAME_ID) {
            (void)quiesce_can_service_reply_unpack(&reply, last->data, last->length);
        }
    }
    TEST_ASSERT_EQUAL_UINT8(CAN_NODE_DONE, reply.result);
}

static void test_no_parameter_raises_a_ceiling(void) {
    disarm();
    ask(OP(STAGE), INDEX_OF(max_current_mA), 20000);
    ask(OP(STAGE), INDEX_OF(constant_current_mA), 20000);
    ask(OP(STAGE), INDEX_OF(safe_current_mA), 20000);
    ask(OP(APPLY), 0, 0);
    board.enable = true;
    TEST_ASSERT_EQUAL_UINT32(1, node.restarts);
    TEST_ASSERT_EQUAL_INT32(20000, node.params.max_current_mA);
    TEST_ASSERT_EQUAL_PTR(&wiring, node.board);
    for (uint32_t i = 0; i < 3000; i++) {
        run(1);
        for (uint32_t k = 0; k < DAMPERS; k++) {
            TEST_ASSERT_LESS_OR_EQUAL_INT32(ceilings_mA[k], unpack(&frames[k]).current_cmd_mA);
        }
    }
    check_currents(ceilings_mA, true);
    board.estop = true;
    run(1);
    check_currents(safe_mA, false);
}

static void test_a_lower_limit_holds_for_all_and_for_what_is_safe(void) {
    static const int32_t limited_mA[DAMPERS] = {250, 250, 250, 250};
    static const int32_t safe_too_mA[DAMPERS] = {100, 200, 250, 250};
    disarm();
    ask(OP(STAGE), INDEX_OF(max_current_mA), 250);
    ask(OP(STAGE), INDEX_OF(constant_current_mA), 250);
    ask(OP(STAGE), INDEX_OF(safe_current_mA), 0);
    ask(OP(STAGE), INDEX_OF(unlock_current_mA), 0);
    ask(OP(APPLY), 0, 0);
    board.enable = true;
    TEST_ASSERT_EQUAL_INT32_ARRAY(safe_too_mA, node.safe_mA, DAMPERS);
    run(2000);
    check_currents(limited_mA, true);
    board.estop = true;
    run(1);
    check_currents(safe_too_mA, false); // what the guard commands is what node_t says
}

static void test_leaving_tells_every_driver(void) {
    run(2000);
    TEST_ASSERT_EQUAL_UINT32(DAMPERS, node_farewell(&node, frames));
    for (uint32_t i = 0; i < DAMPERS; i++) {
        const struct quiesce_can_current_demand_t demand = unpack(&frames[i]);
        TEST_ASSERT_EQUAL_HEX32(0x10u + i, frames[i].id);
        TEST_ASSERT_EQUAL_INT32(safe_mA[i], demand.current_cmd_mA);
        TEST_ASSERT_EQUAL_UINT8(0, demand.driver_is_enabled);
    }
}

static void test_the_tracked_accelerometer_is_streamed(void) {
    struct quiesce_can_raw_sample_t raw;
    wiring.tracked = 2;
    start(0);
    ask(OP(RAW_STREAM), 0, 10);
    run(1);
    const can_frame_t *last = &frames[frame_count - 1u];
    TEST_ASSERT_EQUAL_HEX32(QUIESCE_CAN_RAW_SAMPLE_FRAME_ID, last->id);
    (void)quiesce_can_raw_sample_unpack(&raw, last->data, last->length);
    TEST_ASSERT_EQUAL_INT32(board.sensor[2].counts, raw.accel_counts);
    TEST_ASSERT_NOT_EQUAL(board.sensor[0].counts, raw.accel_counts);
}

static void test_a_board_that_is_refused_commands_nothing(void) {
    wiring.damper[3].safe_mA = 4001;
    wiring.dampers = 200;
    TEST_ASSERT_FALSE(node_init(&node, &wiring, &params, (node_sources_t){0}));
    TEST_ASSERT_EQUAL_UINT32(1, node_dampers(&node));
    for (uint32_t i = 0; i < 100; i++) {
        run(1);
        TEST_ASSERT_EQUAL_UINT32(QUIESCE_FAULT_PARAMETER, node.out.telemetry.fault);
        TEST_ASSERT_EQUAL_INT32(0, node.out.damper[0].current_cmd_mA);
        TEST_ASSERT_FALSE(node.out.damper[0].driver_enable);
        TEST_ASSERT_EQUAL_HEX32(0x10, frames[0].id);
        TEST_ASSERT_TRUE(frame_count == 1u || frames[1].id >= 0x100u);
    }
    TEST_ASSERT_EQUAL_INT32(0, node.safe_mA[0]);
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(test_every_damper_has_its_demand_in_every_tick);
    RUN_TEST(test_only_dampers_of_the_board_have_demands);
    RUN_TEST(test_busiest_tick_has_room_for_all);
    RUN_TEST(test_each_sensor_is_where_it_was_set_up);
    RUN_TEST(test_each_sender_has_its_own_counter);
    RUN_TEST(test_a_slow_sensor_that_hangs_is_not_fresh);
    RUN_TEST(test_no_frame_counts_as_anothers);
    RUN_TEST(test_each_measured_current_is_gone_after_its_timeout);
    RUN_TEST(test_one_driver_that_fails_switches_all_off);
    RUN_TEST(test_no_parameter_raises_a_ceiling);
    RUN_TEST(test_a_lower_limit_holds_for_all_and_for_what_is_safe);
    RUN_TEST(test_leaving_tells_every_driver);
    RUN_TEST(test_the_tracked_accelerometer_is_streamed);
    RUN_TEST(test_a_board_that_is_refused_commands_nothing);
    return UNITY_END();
}
