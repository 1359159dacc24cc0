// A controller with its messages: what the bus and the board say reaches it, and what it does
// reaches driver and bus. Sensor and driver are simulated, the latter written as node.h asks for.
#include "can_make.h"
#include "node.h"
#include "unity.h"

#include <stddef.h>
#include <string.h>

#define OP(name) QUIESCE_CAN_SERVICE_REQUEST_OPERATION_##name##_CHOICE
#define STOP QUIESCE_CAN_EMERGENCY_STOP_CODE_STOP_CHOICE
#define INDEX_OF(field) (offsetof(quiesce_params_t, field) / sizeof(int32_t))

typedef struct {
    int32_t command_mA;
    bool is_enabled;
} driver_t;

static node_t node;
static driver_t driver;
static quiesce_params_t params;
static node_inputs_t board;
static can_frame_t frames[NODE_MAX_FRAMES];
static uint32_t frame_count;
static uint32_t seed;
static uint8_t operator_alive;

static void write_command(void) {
    driver = (driver_t){node.out.damper[0].current_cmd_mA, node.out.damper[0].driver_enable};
}

static void start(node_enable_t enable) {
    memset(&node, 0xA5, sizeof node);
    TEST_ASSERT_TRUE(node_init(&node, NULL, &params, (node_sources_t){.enable = enable}));
    write_command();
}

void setUp(void) {
    quiesce_params_default(&params);
    params.law = QUIESCE_LAW_CONSTANT;
    params.constant_current_mA = 1500;
    params.safe_current_mA = 250;
    board = (node_inputs_t){.enable = true, .ticks_elapsed = 1};
    seed = 1;
    operator_alive = 0;
    start(NODE_ENABLE_BOARD);
}

void tearDown(void) {}

static void receive(can_frame_t frame) {
    node_receive(&node, &frame);
}

static void press(bool enable, bool fault_reset) {
    receive(make_operator(enable, fault_reset, operator_alive));
    operator_alive = (uint8_t)((operator_alive + 1u) % 16u);
}

// The edge of enable arms: it is let go in the first tick and with an acknowledgement.
static void tick(void) {
    node_inputs_t given = board;
    given.enable = given.enable && node.in.tick > 0 && !given.fault_reset;
    node_step(&node, &given);
    write_command();
    const quiesce_params_t *const other = node_task(&node);
    if (other != NULL) {
        driver.command_mA = quiesce_params_safe_current_mA(other);
        node_restart(&node, other);
        write_command();
    }
    frame_count = node_frames(&node, frames);
}

// Ticks with a live sensor on the board.
static void run(uint32_t ticks) {
    for (uint32_t i = 0; i < ticks; i++) {
        seed = seed * 1664525u + 1013904223u;
        board.sensor[0].counts = (int32_t)(seed >> 16) - 32768;
        board.sensor[0].is_fresh = true;
        tick();
    }
}

static uint32_t state(void) {
    return node.out.telemetry.state;
}

static struct quiesce_can_current_demand_t demand(void) {
    struct quiesce_can_current_demand_t wire;
    TEST_ASSERT_EQUAL_HEX32(QUIESCE_CAN_CURRENT_DEMAND_FRAME_ID, frames[0].id);
    TEST_ASSERT_TRUE(is_well_made(&frames[0]));
    (void)quiesce_can_current_demand_unpack(&wire, frames[0].data, frames[0].length);
    return wire;
}

static struct quiesce_can_service_reply_t ask(uint32_t operation, uint32_t index, int32_t value) {
    struct quiesce_can_service_reply_t reply = {0};
    receive(make_request((uint8_t)operation, (uint8_t)index, value, 3));
    for (uint32_t i = 0; i < 11; i++) {
        run(1);
        if (frames[frame_count - 1u].id == QUIESCE_CAN_SERVICE_REPLY_FRAME_ID) {
            (void)quiesce_can_service_reply_unpack(&reply, frames[frame_count - 1u].data, 8);
            return reply;
        }
    }
    TEST_FAIL_MESSAGE("no reply");
    return reply;
}

static void test_bus_carries_what_the_driver_is_told(void) {
    for (uint32_t i = 0; i < 3000; i++) {
        run(1);
        TEST_ASSERT_EQUAL_UINT16(driver.command_mA, demand().current_cmd_mA);
        TEST_ASSERT_EQUAL_UINT8(driver.is_enabled, demand().driver_is_enabled);
        TEST_ASSERT_EQUAL_UINT8(state(), demand().state);
    }
    TEST_ASSERT_EQUAL_UINT32(QUIESCE_STATE_RUN, state());
    TEST_ASSERT_EQUAL_INT32(1500, driver.command_mA);
}

static void check_enable(node_enable_t from, bool by_board, bool by_bus, bool expected) {
    start(from);
    board.enable = by_board;
    press(false, false);
    run(100);
    for (uint32_t i = 0; i < 20; i++) {
        press(by_bus, false);
        run(100);
    }
    TEST_ASSERT_EQUAL_UINT32(expected ? QUIESCE_STATE_RUN : QUIESCE_STATE_IDLE, state());
}

static void test_enable_comes_from_where_it_is_set_up(void) {
    for (uint32_t i = 0; i < 4; i++) {
        const bool by_board = (i & 1u) != 0;
        const bool by_bus = (i & 2u) != 0;
        check_enable(NODE_ENABLE_BOARD, by_board, by_bus, by_board);
        check_enable(NODE_ENABLE_CAN, by_board, by_bus, by_bus);
        check_enable(NODE_ENABLE_BOTH, by_board, by_bus, by_board && by_bus);
        check_enable((node_enable_t)3, by_board, by_bus, false);
    }
}

static void test_operator_who_falls_silent_is_not_enabled(void) {
    check_enable(NODE_ENABLE_CAN, false, true, true); // 100 ticks after the last frame
    run(200);
    TEST_ASSERT_EQUAL_UINT32(QUIESCE_STATE_RUN, state());
    run(1);
    TEST_ASSERT_EQUAL_UINT32(QUIESCE_STATE_IDLE, state());
    TEST_ASSERT_EQUAL_UINT16(250, demand().current_cmd_mA);
}

static void send_cycles(bool enable, uint32_t cycles) {
    for (uint32_t i = 0; i < cycles; i++) {
        press(enable, false);
        run(100);
    }
}

// A minute of a congested bus, which loses the operator's frames for up to a second and a half at a
// time. The button is held: the first gap disarms, and the state stays there until it is let go.
static void test_held_enable_that_is_lost_again_and_again_does_not_flap(void) {
    uint32_t ends = 0;
    uint32_t begins = 0;
    uint32_t lost = 0;
    uint32_t last = QUIESCE_STATE_RUN;
    start(NODE_ENABLE_CAN);
    send_cycles(false, 3);
    send_cycles(true, 8);
    TEST_ASSERT_EQUAL_UINT32(QUIESCE_STATE_RUN, state());
    for (uint32_t i = 0; i < 600; i++) {
        if (lost == 0 && seed % 5u == 0) {
            lost = seed / 5u % 16u;
        }
        if (lost > 0) {
            lost--;
            operator_alive = (uint8_t)((operator_alive + 1u) % 16u);
        } else {
            press(true, false);
        }
        for (uint32_t k = 0; k < 100; k++) {
            run(1);
            ends += last == QUIESCE_STATE_RUN && state() != last ? 1u : 0u;
            begins += last != QUIESCE_STATE_RUN && state() == QUIESCE_STATE_RUN ? 1u : 0u;
            last = state();
        }
    }
    TEST_ASSERT_EQUAL_UINT32(1, ends);
    TEST_ASSERT_EQUAL_UINT32(0, begins);
    send_cycles(true, 10);
    TEST_ASSERT_EQUAL_UINT32(QUIESCE_STATE_IDLE, state());
    send_cycles(false, 4);
    send_cycles(true, 8);
    TEST_ASSERT_EQUAL_UINT32(QUIESCE_STATE_RUN, state());
}

static void test_stop_on_the_bus_acts_in_the_next_tick(void) {
    run(2000);
    TEST_ASSERT_EQUAL_UINT32(QUIESCE_STATE_RUN, state());
    receive(make_stop(STOP, 0));
    run(1);
    TEST_ASSERT_EQUAL_UINT32(QUIESCE_STATE_FAULT, state());
    TEST_ASSERT_EQUAL_INT32(250, driver.command_mA);
    TEST_ASSERT_FALSE(driver.is_enabled);
    TEST_ASSERT_EQUAL_UINT16(250, demand().current_cmd_mA);
    TEST_ASSERT_EQUAL_UINT8(0, demand().driver_is_enabled);
}

static void test_stop_of_the_board_acts_in_its_tick(void) {
    run(2000);
    board.estop = true;
    run(1);
    TEST_ASSERT_EQUAL_UINT32(QUIESCE_STATE_FAULT, state());
    TEST_ASSERT_FALSE(driver.is_enabled);
}

static void check_failed_driver(void) {
    TEST_ASSERT_EQUAL_UINT32(QUIESCE_STATE_FAULT, state());
    TEST_ASSERT_EQUAL_UINT32(QUIESCE_FAULT_DRIVER_FAILED, node.out.telemetry.fault);
    TEST_ASSERT_EQUAL_INT32(250, driver.command_mA);
    TEST_ASSERT_FALSE(driver.is_enabled);
    TEST_ASSERT_EQUAL_UINT16(250, demand().current_cmd_mA);
    TEST_ASSERT_EQUAL_UINT8(0, demand().driver_is_enabled);
}

static void test_driver_that_fails_is_switched_off_until_it_is_acknowledged(void) {
    run(400);
    TEST_ASSERT_EQUAL_UINT32(QUIESCE_STATE_RUN, state());
    board.driver[0].has_failed = true;
    run(1);
    check_failed_driver();
    board.driver[0].has_failed = false;
    run(1000);
    check_failed_driver();
    board.fault_reset = true;
    run(1);
    board.fault_reset = false;
    run(400);
    TEST_ASSERT_EQUAL_UINT32(QUIESCE_STATE_RUN, state());
    receive(make_driver(0, QUIESCE_CAN_CURRENT_MEASURED_DRIVER_STATUS_SHORT_CHOICE, 0));
    run(1);
    check_failed_driver();
}

// A command, and the operator's cycle.
static void command(bool enable, bool fault_reset) {
    press(enable, fault_reset);
    run(100);
}

static void test_stop_is_acknowledged_over_the_bus_once_it_is_released(void) {
    run(2000);
    for (uint32_t i = 0; i < 3; i++) {
        command(false, false);
    }
    receive(make_stop(STOP, 0));
    run(1);
    command(false, true); // still pressed
    command(false, true);
    run(100);
    TEST_ASSERT_EQUAL_UINT32(QUIESCE_STATE_FAULT, state());
    for (uint32_t i = 0; i < 5; i++) {
        command(false, true); // held, no edge
        TEST_ASSERT_EQUAL_UINT32(QUIESCE_STATE_FAULT, state());
    }
    command(false, false);
    command(false, false);
    command(false, true);
    command(false, true);
    TEST_ASSERT_EQUAL_UINT32(QUIESCE_STATE_FAULT, state());
    press(false, false);
    run(1);
    TEST_ASSERT_NOT_EQUAL(QUIESCE_STATE_FAULT, state());
}

static void run_without_a_board(void) {
    board.sensor[0].is_fresh = false;
    board.driver[0].is_measured = false;
    tick();
}

// The driver's and the sensor's next frames are of counter 0.
static void introduce_nodes(void) {
    for (uint8_t i = 14; i < 16; i++) {
        receive(make_current(1, i));
        for (uint32_t k = 0; k < 10; k++) {
            receive(make_accel(1, false, false, (uint8_t)((i * 10u + k + 4u) % 16u)));
            run_without_a_board();
        }
    }
}

static void test_bus_sample_is_there_for_its_tick(void) {
    TEST_ASSERT_TRUE(node_init(&node, NULL, &params, (node_sources_t){.sensors_on_bus = 1}));
    run_without_a_board();
    TEST_ASSERT_FALSE(node.in.sensor[0].is_fresh);
    TEST_ASSERT_FALSE(node.in.driver[0].is_measured);
    introduce_nodes();
    receive(make_accel(-4321, false, false, 4));
    receive(make_current(-99, 0));
    run_without_a_board();
    TEST_ASSERT_TRUE(node.in.sensor[0].is_fresh);
    TEST_ASSERT_TRUE(node.in.driver[0].is_measured);
    TEST_ASSERT_EQUAL_INT32(-4321, node.in.sensor[0].counts);
    TEST_ASSERT_EQUAL_INT32(-99, node.in.driver[0].current_mA);
    run_without_a_board();
    TEST_ASSERT_FALSE(node.in.sensor[0].is_fresh);
    TEST_ASSERT_EQUAL_INT32(-4321, node.in.sensor[0].counts);
    TEST_ASSERT_TRUE(node.in.driver[0].is_measured);
}

static void test_the_sensor_is_where_it_was_set_up(void) {
    introduce_nodes();
    receive(make_accel(-4321, false, false, 4));
    run_without_a_board(); // a sample on the bus is no sample of the board's sensor
    TEST_ASSERT_FALSE(node.in.sensor[0].is_fresh);
    TEST_ASSERT_TRUE(node_init(&node, NULL, &params, (node_sources_t){.sensors_on_bus = 1}));
    run(1);
    TEST_ASSERT_FALSE(node.in.sensor[0].is_fresh);
}

static void test_the_boards_measurement_goes_before_the_buss(void) {
    introduce_nodes();
    receive(make_current(-99, 0));
    board.driver[0].is_measured = true;
    board.driver[0].current_mA = 77;
    run(1);
    TEST_ASSERT_EQUAL_INT32(77, node.in.driver[0].current_mA);
    board.driver[0].is_measured = false;
    run(1);
    TEST_ASSERT_TRUE(node.in.driver[0].is_measured);
    TEST_ASSERT_EQUAL_INT32(-99, node.in.driver[0].current_mA);
}

static void test_raw_stream_has_the_samples_that_the_controller_got(void) {
    struct quiesce_can_raw_sample_t raw;
    (void)ask(OP(RAW_STREAM), 0, 10);
    for (uint32_t i = 0; i < 100; i++) {
        const int32_t last = node.in.sensor[0].counts;
        if (i % 3u == 0) {
            board.sensor[0].counts = 0;
            board.sensor[0].is_fresh = false;
            tick();
        } else {
            run(1);
        }
        const can_frame_t *frame = &frames[frame_count - 1u];
        TEST_ASSERT_EQUAL_HEX32(QUIESCE_CAN_RAW_SAMPLE_FRAME_ID, frame->id);
        (void)quiesce_can_raw_sample_unpack(&raw, frame->data, frame->length);
        TEST_ASSERT_EQUAL(i % 3u != 0, raw.accel_is_fresh);
        TEST_ASSERT_EQUAL_INT32(i % 3u == 0 ? last : board.sensor[0].counts, raw.accel_counts);
        TEST_ASSERT_EQUAL_UINT16(node.in.tick, raw.tick_low);
    }
}

static void test_apply_restarts_from_rest_with_the_safe_current(void) {
    run(2000);
    TEST_ASSERT_EQUAL(CAN_NODE_DONE, ask(OP(STAGE), INDEX_OF(constant_current_mA), 1000).result);
    TEST_ASSERT_EQUAL(CAN_NODE_DONE, ask(OP(STAGE), INDEX_OF(safe_current_mA), 300).result);
    TEST_ASSERT_EQUAL_INT32(1500, driver.command_mA);
    board.enable = false;
    run(1);
    receive(make_request(OP(APPLY), 0, 0, 0));
    run(1);
    board.enable = true;
    TEST_ASSERT_EQUAL_INT32(300, driver.command_mA);
    TEST_ASSERT_FALSE(driver.is_enabled); // to be tested anew
    TEST_ASSERT_EQUAL_UINT16(300, demand().current_cmd_mA);
    TEST_ASSERT_EQUAL_UINT8(0, demand().driver_is_enabled);
    TEST_ASSERT_EQUAL_UINT8(QUIESCE_STATE_INIT, demand().state);
    TEST_ASSERT_EQUAL_UINT32(1, node.restarts);
    run(2000);
    TEST_ASSERT_EQUAL_UINT32(QUIESCE_STATE_RUN, state());
    TEST_ASSERT_EQUAL_INT32(1000, driver.command_mA);
    TEST_ASSERT_TRUE(driver.is_enabled);
    TEST_ASSERT_EQUAL_HEX32(can_node_param_hash(&node.params), node.can.param_hash);
}

static void test_contradicting_parameters_change_nothing(void) {
    board.enable = false;
    run(2000);
    (void)ask(OP(STAGE), INDEX_OF(constant_current_mA), 2000);
    (void)ask(OP(STAGE), INDEX_OF(max_current_mA), 1000);
    const struct quiesce_can_service_reply_t reply = ask(OP(APPLY), 0, 0);
    TEST_ASSERT_EQUAL(CAN_NODE_CONTRADICTION, reply.result);
    TEST_ASSERT_EQUAL_UINT8(INDEX_OF(constant_current_mA), reply.param_index);
    TEST_ASSERT_EQUAL_MEMORY(&params, &node.params, sizeof params);
    TEST_ASSERT_EQUAL_UINT32(QUIESCE_STATE_IDLE, state());
    TEST_ASSERT_EQUAL_UINT32(0, node.restarts);
}

static void test_armed_takes_live_parameters_only(void) {
    run(2000);
    (void)ask(OP(STAGE), INDEX_OF(max_current_mA), 4000);
    const struct quiesce_can_service_reply_t refused = ask(OP(APPLY), 0, 0);
    TEST_ASSERT_EQUAL(CAN_NODE_IS_ARMED, refused.result);
    TEST_ASSERT_EQUAL_UINT8(INDEX_OF(max_current_mA), refused.param_index);
    (void)ask(OP(DISCARD), 0, 0);
    (void)ask(OP(STAGE), INDEX_OF(constant_current_mA), 1200);
    TEST_ASSERT_EQUAL(CAN_NODE_DONE, ask(OP(APPLY), 0, 0).result);
    run(1);
    TEST_ASSERT_EQUAL_UINT32(QUIESCE_STATE_RUN, state()); // nothing has started anew
    TEST_ASSERT_EQUAL_INT32(1200, driver.command_mA);
    TEST_ASSERT_EQUAL_UINT32(0, node.restarts);
    TEST_ASSERT_EQUAL_UINT32(1, node.retunes);
    TEST_ASSERT_EQUAL_INT32(1200, node.params.constant_current_mA);
    TEST_ASSERT_EQUAL_HEX32(can_node_param_hash(&node.params), node.can.param_hash);
    (void)ask(OP(STAGE), INDEX_OF(constant_current_mA), 5001);
    TEST_ASSERT_EQUAL(CAN_NODE_CONTRADICTION, ask(OP(APPLY), 0, 0).result);
    TEST_ASSERT_EQUAL_UINT32(1, node.retunes);
}

static void test_no_message_raises_the_ceiling_of_the_start(void) {
    board.enable = false;
    run(400);
    (void)ask(OP(STAGE), INDEX_OF(unlock_current_mA), 1000);
    for (int32_t max_mA = 4000; max_mA <= 5000; max_mA += 1000) {
        (void)ask(OP(STAGE), INDEX_OF(max_current_mA), max_mA);
        TEST_ASSERT_EQUAL(CAN_NODE_DONE, ask(OP(APPLY), 0, 0).result);
    }
    (void)ask(OP(STAGE), INDEX_OF(max_current_mA), 5001);
    const struct quiesce_can_service_reply_t reply = ask(OP(APPLY), 0, 0);
    TEST_ASSERT_EQUAL(CAN_NODE_CONTRADICTION, reply.result);
    TEST_ASSERT_EQUAL_UINT8(INDEX_OF(max_current_mA), reply.param_index);
    TEST_ASSERT_EQUAL_INT32(5000, node.params.max_current_mA);
}

static void test_driver_is_off_until_a_tick_has_seen_the_emergency_stop(void) {
    start(NODE_ENABLE_BOARD);
    TEST_ASSERT_FALSE(driver.is_enabled);
    board.estop = true;
    run(1);
    TEST_ASSERT_FALSE(driver.is_enabled);
    params.slew_mA_s = -1;
    TEST_ASSERT_FALSE(
        node_init(&node, NULL, &params, (node_sources_t){.enable = NODE_ENABLE_BOARD}));
    run(10);
    (void)ask(OP(STAGE), INDEX_OF(slew_mA_s), 5000);
    receive(make_request(OP(APPLY), 0, 0, 0)); // while the stop is pressed
    for (uint32_t i = 0; i < 5; i++) {
        run(1);
        TEST_ASSERT_FALSE(driver.is_enabled);
    }
    TEST_ASSERT_EQUAL_UINT32(1, node.restarts);
}

static void test_a_latched_fault_is_not_forgotten_by_apply(void) {
    run(2000);
    board.estop = true;
    run(1);
    board.estop = false;
    (void)ask(OP(STAGE), INDEX_OF(slew_mA_s), 5000);
    TEST_ASSERT_EQUAL(CAN_NODE_FAULT_IS_LATCHED, ask(OP(APPLY), 0, 0).result);
    TEST_ASSERT_EQUAL_UINT32(QUIESCE_STATE_FAULT, state());
    TEST_ASSERT_FALSE(driver.is_enabled);
    board.fault_reset = true;
    run(1);
    TEST_ASSERT_EQUAL(CAN_NODE_DONE, ask(OP(APPLY), 0, 0).result);
}

static void test_refused_parameters_are_mended_over_the_bus(void) {
    params.slew_mA_s = -1;
    TEST_ASSERT_FALSE(
        node_init(&node, NULL, &params, (node_sources_t){.enable = NODE_ENABLE_BOARD}));
    write_command();
    TEST_ASSERT_EQUAL_INT32(250, driver.command_mA);
    TEST_ASSERT_FALSE(driver.is_enabled);
    run(20);
    TEST_ASSERT_EQUAL_UINT32(QUIESCE_FAULT_PARAMETER, node.out.telemetry.fault);
    (void)ask(OP(STAGE), INDEX_OF(law), QUIESCE_LAW_OFF);
    const struct quiesce_can_service_reply_t refused = ask(OP(APPLY), 0, 0);
    TEST_ASSERT_EQUAL(CAN_NODE_OUT_OF_RANGE, refused.result);
    TEST_ASSERT_EQUAL_UINT8(INDEX_OF(slew_mA_s), refused.param_index);
    (void)ask(OP(STAGE), INDEX_OF(slew_mA_s), 5000);
    TEST_ASSERT_EQUAL(CAN_NODE_DONE, ask(OP(APPLY), 0, 0).result);
    run(1);
    TEST_ASSERT_EQUAL_UINT32(QUIESCE_FAULT_NONE, node.out.telemetry.fault);
    TEST_ASSERT_FALSE(driver.is_enabled);
    run(300);
    TEST_ASSERT_TRUE(driver.is_enabled);
}

static void stage_and_apply(void) {
    board.enable = false; // else it is armed
    run(1);
    (void)ask(OP(STAGE), INDEX_OF(safe_current_mA), 300);
    receive(make_request(OP(APPLY), 0, 0, 0));
}

// The driver gets the safe current of what comes while the controller still stands.
static void test_task_hands_parameters_over_before_anything_restarts(void) {
    run(2000);
    stage_and_apply();
    node_step(&node, &board);
    const quiesce_params_t *const other = node_task(&node);
    TEST_ASSERT_NOT_NULL(other);
    TEST_ASSERT_EQUAL_INT32(300, quiesce_params_safe_current_mA(other));
    TEST_ASSERT_EQUAL_UINT32(0, node.restarts);
    TEST_ASSERT_EQUAL_MEMORY(&params, &node.params, sizeof params);
    TEST_ASSERT_EQUAL_INT32(250, node.out.damper[0].current_cmd_mA);
    TEST_ASSERT_NULL(node_task(&node));
    node_restart(&node, other);
    TEST_ASSERT_EQUAL_UINT32(1, node.restarts);
    TEST_ASSERT_EQUAL_INT32(300, node.out.damper[0].current_cmd_mA);
    TEST_ASSERT_FALSE(node.out.damper[0].driver_enable);
}

static void test_tick_is_all_three_parts(void) {
    static node_t other;
    can_frame_t others[NODE_MAX_FRAMES];
    run(2000);
    stage_and_apply();
    memcpy(&other, &node, sizeof node);
    for (uint32_t i = 0; i < 500; i++) {
        board.sensor[0].counts = (int32_t)(i * 7919u % 65536u) - 32768;
        tick();
        TEST_ASSERT_EQUAL_UINT32(frame_count, node_tick(&other, &board, others));
        // Words only: the bytes between the members of other structures mean nothing.
        TEST_ASSERT_EQUAL_MEMORY(&node.out.telemetry, &other.out.telemetry,
                                 sizeof node.out.telemetry);
        TEST_ASSERT_EQUAL_MEMORY(&node.params, &other.params, sizeof node.params);
        TEST_ASSERT_EQUAL_INT32(node.out.damper[0].current_cmd_mA,
                                other.out.damper[0].current_cmd_mA);
        TEST_ASSERT_EQUAL(node.out.damper[0].driver_enable, other.out.damper[0].driver_enable);
        TEST_ASSERT_EQUAL_UINT32(node.restarts, other.restarts);
        for (uint32_t k = 0; k < frame_count; k++) {
            TEST_ASSERT_EQUAL_HEX32(frames[k].id, others[k].id);
            TEST_ASSERT_EQUAL_UINT8(frames[k].length, others[k].length);
            TEST_ASSERT_EQUAL_MEMORY(frames[k].data, others[k].data, frames[k].length);
        }
    }
    TEST_ASSERT_EQUAL_UINT32(1, other.restarts);
}

typedef struct {
    quiesce_params_t stored;
    uint32_t calls;
    bool is_full;
    bool is_slow;
} store_t;

static keeper_answer_t store(void *context, keeper_record_t record, const uint32_t *words,
                             uint32_t count) {
    store_t *const self = context;
    TEST_ASSERT_EQUAL(KEEPER_PARAMS, record);
    TEST_ASSERT_EQUAL_UINT32(QUIESCE_PARAM_COUNT, count);
    self->calls++;
    if (self->is_full) {
        return KEEPER_FAILED;
    }
    memcpy(&self->stored, words, sizeof self->stored);
    return self->is_slow ? KEEPER_BEGUN : KEEPER_DONE;
}

static void test_save_stores_what_is_in_effect(void) {
    store_t kept = {.is_full = true};
    TEST_ASSERT_EQUAL(CAN_NODE_STORE_FAILED, ask(OP(SAVE), 0, 0).result);
    node_use_store(&node, store, &kept);
    TEST_ASSERT_EQUAL(CAN_NODE_STORE_FAILED, ask(OP(SAVE), 0, 0).result);
    kept.is_full = false;
    (void)ask(OP(STAGE), INDEX_OF(slew_mA_s), 5000);
    TEST_ASSERT_EQUAL(CAN_NODE_DONE, ask(OP(SAVE), 0, 0).result);
    TEST_ASSERT_EQUAL_MEMORY(&params, &kept.stored, sizeof params);
    TEST_ASSERT_EQUAL_UINT32(2, kept.calls);
    node.params.slew_mA_s ^= 1 << 20; // by itself
    TEST_ASSERT_EQUAL(CAN_NODE_STORE_FAILED, ask(OP(SAVE), 0, 0).result);
    TEST_ASSERT_EQUAL_UINT32(2, kept.calls);
}

static void test_slow_store_is_answered_by_its_owner(void) {
    store_t kept = {.is_slow = true};
    struct quiesce_can_service_reply_t reply;
    node_use_store(&node, store, &kept);
    receive(make_request(OP(SAVE), 0, 0, 3));
    for (uint32_t i = 0; i < 50; i++) {
        run(1);
        TEST_ASSERT_NOT_EQUAL(QUIESCE_CAN_SERVICE_REPLY_FRAME_ID, frames[frame_count - 1u].id);
    }
    TEST_ASSERT_EQUAL_UINT32(1, kept.calls);
    node_stored(&node, false);
    run(1);
    TEST_ASSERT_EQUAL_HEX32(QUIESCE_CAN_SERVICE_REPLY_FRAME_ID, frames[frame_count - 1u].id);
    (void)quiesce_can_service_reply_unpack(&reply, frames[frame_count - 1u].data, 8);
    TEST_ASSERT_EQUAL(CAN_NODE_STORE_FAILED, reply.result);
    TEST_ASSERT_EQUAL_UINT32(1, kept.calls);
}

// Its outcome is of what was asked then, not of the request that came since.
static void test_a_store_that_answers_too_late_answers_nobody(void) {
    store_t kept = {.is_slow = true};
    struct quiesce_can_service_reply_t reply;
    node_use_store(&node, store, &kept);
    receive(make_request(OP(SAVE), 0, 0, 3));
    run(CAN_SERVICE_SAVE_MS + 5u);
    receive(make_request(OP(SAVE), 0, 0, 4));
    run(5);
    TEST_ASSERT_EQUAL_UINT32(1, kept.calls); // the memory is at it still
    node_stored(&node, true);
    run(5);
    TEST_ASSERT_EQUAL_UINT32(2, kept.calls);
    node_stored(&node, false);
    run(1);
    (void)quiesce_can_service_reply_unpack(&reply, frames[frame_count - 1u].data, 8);
    TEST_ASSERT_EQUAL_UINT8(4, reply.alive);
    TEST_ASSERT_EQUAL(CAN_NODE_STORE_FAILED, reply.result);
    TEST_ASSERT_EQUAL_UINT32(1, node.tables.keeper.kept[KEEPER_PARAMS].writes);
}

static void test_leaving_switches_the_output_off(void) {
    run(2000);
    TEST_ASSERT_EQUAL_UINT32(1, node_farewell(&node, frames));
    TEST_ASSERT_EQUAL_UINT16(250, demand().current_cmd_mA);
    TEST_ASSERT_EQUAL_UINT8(0, demand().driver_is_enabled);
}

static void test_lost_ticks_reach_the_controller(void) {
    run(2000);
    board.ticks_elapsed = 3;
    run(1);
    TEST_ASSERT_EQUAL_UINT32(QUIESCE_FAULT_TICK_LOST, node.out.telemetry.fault);
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(test_bus_carries_what_the_driver_is_told);
    RUN_TEST(test_enable_comes_from_where_it_is_set_up);
    RUN_TEST(test_operator_who_falls_silent_is_not_enabled);
    RUN_TEST(test_held_enable_that_is_lost_again_and_again_does_not_flap);
    RUN_TEST(test_stop_on_the_bus_acts_in_the_next_tick);
    RUN_TEST(test_stop_of_the_board_acts_in_its_tick);
    RUN_TEST(test_driver_that_fails_is_switched_off_until_it_is_acknowledged);
    RUN_TEST(test_stop_is_acknowledged_over_the_bus_once_it_is_released);
    RUN_TEST(test_bus_sample_is_there_for_its_tick);
    RUN_TEST(test_the_sensor_is_where_it_was_set_up);
    RUN_TEST(test_the_boards_measurement_goes_before_the_buss);
    RUN_TEST(test_raw_stream_has_the_samples_that_the_controller_got);
    RUN_TEST(test_apply_restarts_from_rest_with_the_safe_current);
    RUN_TEST(test_armed_takes_live_parameters_only);
    RUN_TEST(test_no_message_raises_the_ceiling_of_the_start);
    RUN_TEST(test_driver_is_off_until_a_tick_has_seen_the_emergency_stop);
    RUN_TEST(test_contradicting_parameters_change_nothing);
    RUN_TEST(test_a_latched_fault_is_not_forgotten_by_apply);
    RUN_TEST(test_refused_parameters_are_mended_over_the_bus);
    RUN_TEST(test_task_hands_parameters_over_before_anything_restarts);
    RUN_TEST(test_tick_is_all_three_parts);
    RUN_TEST(test_save_stores_what_is_in_effect);
    RUN_TEST(test_slow_store_is_answered_by_its_owner);
    RUN_TEST(test_a_store_that_answers_too_late_answers_nobody);
    RUN_TEST(test_leaving_switches_the_output_off);
    RUN_TEST(test_lost_ticks_reach_the_controller);
    return UNITY_END();
}
