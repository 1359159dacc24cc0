#include "lockstep_can.h"
#include "unity.h"

#include <stddef.h>
#include <string.h>

static lockstep_can_t server;
static can_frame_t replies[LOCKSTEP_CAN_MAX_REPLIES];

void setUp(void) {
    lockstep_can_init(&server);
    memset(replies, 0xEE, sizeof replies);
}

void tearDown(void) {}

static can_frame_t make_frame(uint32_t id, uint8_t length) {
    return (can_frame_t){.id = id, .length = length};
}

static uint32_t send_control(uint8_t operation, uint16_t every_ticks, uint8_t frames) {
    const struct quiesce_can_lockstep_control_t control = {
        .operation = operation,
        .telemetry_every_ticks = every_ticks,
        .telemetry_frames = frames,
    };
    can_frame_t frame =
        make_frame(QUIESCE_CAN_LOCKSTEP_CONTROL_FRAME_ID, QUIESCE_CAN_LOCKSTEP_CONTROL_LENGTH);
    (void)quiesce_can_lockstep_control_pack(frame.data, &control, sizeof frame.data);
    return lockstep_can_receive(&server, &frame, replies);
}

static uint32_t start(uint16_t every_ticks, uint8_t frames) {
    return send_control(QUIESCE_CAN_LOCKSTEP_CONTROL_OPERATION_START_CHOICE, every_ticks, frames);
}

static uint32_t send_param(uint16_t index, int32_t value) {
    const struct quiesce_can_lockstep_param_write_t write = {index, value};
    can_frame_t frame = make_frame(QUIESCE_CAN_LOCKSTEP_PARAM_WRITE_FRAME_ID,
                                   QUIESCE_CAN_LOCKSTEP_PARAM_WRITE_LENGTH);
    (void)quiesce_can_lockstep_param_write_pack(frame.data, &write, sizeof frame.data);
    return lockstep_can_receive(&server, &frame, replies);
}

static uint8_t is_enabled;

static uint32_t send_stimulus(int32_t accel_counts, uint8_t sequence) {
    const struct quiesce_can_lockstep_stimulus_t stimulus = {
        .accel_counts = accel_counts,
        .accel_is_fresh = 1,
        .enable = is_enabled,
        .sequence = sequence,
    };
    can_frame_t frame =
        make_frame(QUIESCE_CAN_LOCKSTEP_STIMULUS_FRAME_ID, QUIESCE_CAN_LOCKSTEP_STIMULUS_LENGTH);
    (void)quiesce_can_lockstep_stimulus_pack(frame.data, &stimulus, sizeof frame.data);
    return lockstep_can_receive(&server, &frame, replies);
}

static uint32_t send_current(int32_t current_meas_mA, uint8_t sequence) {
    const struct quiesce_can_lockstep_current_t current = {current_meas_mA, sequence, 0};
    can_frame_t frame =
        make_frame(QUIESCE_CAN_LOCKSTEP_CURRENT_FRAME_ID, QUIESCE_CAN_LOCKSTEP_CURRENT_LENGTH);
    (void)quiesce_can_lockstep_current_pack(frame.data, &current, sizeof frame.data);
    return lockstep_can_receive(&server, &frame, replies);
}

static struct quiesce_can_lockstep_status_t get_status(void) {
    struct quiesce_can_lockstep_status_t status;
    TEST_ASSERT_EQUAL_HEX32(QUIESCE_CAN_LOCKSTEP_STATUS_FRAME_ID, replies[0].id);
    TEST_ASSERT_EQUAL(
        0, quiesce_can_lockstep_status_unpack(&status, replies[0].data, replies[0].length));
    return status;
}

static struct quiesce_can_lockstep_command_t get_command(const can_frame_t *frame) {
    struct quiesce_can_lockstep_command_t command;
    TEST_ASSERT_EQUAL_HEX32(QUIESCE_CAN_LOCKSTEP_COMMAND_FRAME_ID, frame->id);
    TEST_ASSERT_EQUAL(0, quiesce_can_lockstep_command_unpack(&command, frame->data, frame->length));
    return command;
}

static uint32_t ticks_run(void) {
    return server.reply.telemetry.tick;
}

static void test_start_accepts_the_defaults(void) {
    TEST_ASSERT_EQUAL_UINT32(1, start(0, 0));
    const struct quiesce_can_lockstep_status_t status = get_status();
    TEST_ASSERT_EQUAL_UINT8(1, status.is_started);
    TEST_ASSERT_EQUAL_UINT8(0, status.param_is_refused);
    TEST_ASSERT_EQUAL_UINT8(QUIESCE_PARAM_COUNT, status.param_count);
    TEST_ASSERT_EQUAL_UINT8(QUIESCE_CAN_TELEMETRY_WORDS, status.telemetry_words);
}

static void test_greeting_says_that_nothing_is_started(void) {
    lockstep_can_greet(&server, &replies[0]);
    TEST_ASSERT_EQUAL_UINT8(0, get_status().is_started);
    TEST_ASSERT_EQUAL_UINT8(QUIESCE_PARAM_COUNT, get_status().param_count);
}

static void test_replies_equal_the_server_called_directly(void) {
    static lockstep_t direct;
    quiesce_params_t params;
    quiesce_params_default(&params);
    TEST_ASSERT_TRUE(lockstep_start(&direct, NULL, &params, NULL));
    (void)start(0, 0);
    uint32_t seed = 5;
    for (uint32_t tick = 0; tick < 500; tick++) {
        seed = seed * 1664525u + 1013904223u;
        const int32_t counts = (int32_t)(seed >> 16) - 32768;
        is_enabled = tick > 0; // its edge arms
        const uint32_t flags = LOCKSTEP_FRESH | (tick > 0 ? LOCKSTEP_ENABLE : 0u);
        const lockstep_stimulus_t stimulus = {flags, {counts}, {0}};
        lockstep_reply_t expected = {0};
        lockstep_exchange(&direct, &stimulus, &expected);
        TEST_ASSERT_EQUAL_UINT32(1, send_stimulus(counts, (uint8_t)(tick % 16u)));
        const struct quiesce_can_lockstep_command_t command = get_command(&replies[0]);
        TEST_ASSERT_EQUAL_INT32(expected.current_cmd_mA[0], command.current_cmd_mA);
        TEST_ASSERT_EQUAL_UINT32(expected.drivers_enabled, command.driver_is_enabled);
        TEST_ASSERT_EQUAL_UINT32(expected.telemetry.state, command.state);
        TEST_ASSERT_EQUAL_UINT32(expected.telemetry.fault, command.fault);
        TEST_ASSERT_EQUAL_MEMORY(&expected, &server.reply, sizeof expected);
    }
}

static void test_accel_counts_keep_their_sign_and_all_24_bits(void) {
    static const int32_t edges[] = {-8388608, -1, 0, 1, 8388607};
    (void)start(0, 0);
    for (uint8_t i = 0; i < 5; i++) {
        TEST_ASSERT_EQUAL_UINT32(1, send_stimulus(edges[i], i));
        TEST_ASSERT_EQUAL_INT32(edges[i], server.server.in.sensor[0].counts);
    }
}

static void test_wrong_sequence_is_counted_and_no_tick_runs(void) {
    (void)start(0, 0);
    TEST_ASSERT_EQUAL_UINT32(1, send_stimulus(10, 0));
    TEST_ASSERT_EQUAL_UINT32(0, send_stimulus(10, 0)); // repeated
    TEST_ASSERT_EQUAL_UINT32(0, send_stimulus(10, 2)); // one lost
    TEST_ASSERT_EQUAL_UINT32(1, ticks_run());
    TEST_ASSERT_EQUAL_UINT32(1, send_stimulus(10, 1));
    TEST_ASSERT_EQUAL_UINT32(2, ticks_run());
    TEST_ASSERT_EQUAL_UINT16(2, server.sequence_errors);
}

static void test_stimulus_before_start_is_counted_and_no_tick_runs(void) {
    TEST_ASSERT_EQUAL_UINT32(0, send_stimulus(10, 0));
    TEST_ASSERT_EQUAL_UINT32(0, send_current(10, 0));
    TEST_ASSERT_EQUAL_UINT16(2, server.unknown_frames);
    TEST_ASSERT_EQUAL_UINT32(0, ticks_run());
}

static void test_unknown_or_misshapen_frames_change_nothing_but_their_counter(void) {
    can_frame_t wrong[] = {
        make_frame(0x000, 0),
        make_frame(0x7FF, 8),
        make_frame(QUIESCE_CAN_LOCKSTEP_COMMAND_FRAME_ID, 4), // the target's own
        make_frame(QUIESCE_CAN_LOCKSTEP_STIMULUS_FRAME_ID, 3),
        make_frame(QUIESCE_CAN_LOCKSTEP_STIMULUS_FRAME_ID, 5),
        make_frame(QUIESCE_CAN_LOCKSTEP_STIMULUS_FRAME_ID, 4),
        make_frame(QUIESCE_CAN_LOCKSTEP_STIMULUS_FRAME_ID, 4),
        make_frame(QUIESCE_CAN_LOCKSTEP_CONTROL_FRAME_ID, 4), // operation 0
    };
    wrong[5].is_extended = true;
    wrong[6].is_remote = true;
    (void)start(0, 0);
    static lockstep_can_t before;
    before = server;
    for (size_t i = 0; i < sizeof wrong / sizeof wrong[0]; i++) {
        TEST_ASSERT_EQUAL_UINT32(0, lockstep_can_receive(&server, &wrong[i], replies));
    }
    before.unknown_frames = sizeof wrong / sizeof wrong[0];
    TEST_ASSERT_EQUAL_MEMORY(&before, &server, sizeof server);
}

static void test_more_telemetry_than_there_is_is_refused(void) {
    TEST_ASSERT_EQUAL_UINT32(0, start(1, QUIESCE_CAN_TELEMETRY_WORDS + 1u));
    TEST_ASSERT_FALSE(server.is_started);
    TEST_ASSERT_EQUAL_UINT16(1, server.unknown_frames);
}

static void test_counters_saturate(void) {
    const can_frame_t unknown = make_frame(1, 0);
    for (uint32_t i = 0; i < 65540; i++) {
        (void)lockstep_can_receive(&server, &unknown, replies);
    }
    TEST_ASSERT_EQUAL_UINT16(UINT16_MAX, server.unknown_frames);
}

static void test_parameters_are_stored_and_acknowledged(void) {
    struct quiesce_can_lockstep_param_ack_t ack;
    int32_t stored = 0;
    TEST_ASSERT_EQUAL_UINT32(1, send_param(3, -123456789));
    TEST_ASSERT_EQUAL_HEX32(QUIESCE_CAN_LOCKSTEP_PARAM_ACK_FRAME_ID, replies[0].id);
    (void)quiesce_can_lockstep_param_ack_unpack(&ack, replies[0].data, replies[0].length);
    TEST_ASSERT_EQUAL_UINT8(1, ack.is_stored);
    TEST_ASSERT_EQUAL_INT32(-123456789, ack.param_value);
    TEST_ASSERT_TRUE(quiesce_param_get(&server.params, 3, &stored));
    TEST_ASSERT_EQUAL_INT32(-123456789, stored);

    TEST_ASSERT_EQUAL_UINT32(1, send_param(QUIESCE_PARAM_COUNT, 1));
    (void)quiesce_can_lockstep_param_ack_unpack(&ack, replies[0].data, replies[0].length);
    TEST_ASSERT_EQUAL_UINT8(0, ack.is_stored);
}

static void test_start_names_the_refused_parameter(void) {
    for (uint16_t index = 0; index < QUIESCE_PARAM_COUNT; index++) {
        lockstep_can_init(&server);
        (void)send_param(index, INT32_MIN);
        (void)start(0, 0);
        TEST_ASSERT_EQUAL_UINT8(1, get_status().param_is_refused);
        TEST_ASSERT_EQUAL_UINT8(index, get_status().refused_index);
    }
}

static bool send_board_word(uint32_t word, int32_t value) {
    struct quiesce_can_lockstep_param_ack_t ack;
    TEST_ASSERT_EQUAL_UINT32(1, send_param((uint16_t)(LOCKSTEP_CAN_BOARD_INDEX + word), value));
    (void)quiesce_can_lockstep_param_ack_unpack(&ack, replies[0].data, replies[0].length);
    return ack.is_stored != 0;
}

static void send_board(const quiesce_board_t *board) {
    for (uint32_t i = 0; i < LOCKSTEP_CAN_BOARD_WORDS; i++) {
        int32_t value;
        memcpy(&value, (const uint8_t *)board + 4u * i, sizeof value);
        TEST_ASSERT_TRUE(send_board_word(i, value));
    }
}

static uint32_t start_board(void) {
    return send_control(QUIESCE_CAN_LOCKSTEP_CONTROL_OPERATION_START_BOARD_CHOICE, 0, 0);
}

// Two storeys: an accelerometer on each, a damper below each.
static quiesce_board_t two_storeys(void) {
    quiesce_board_t board;
    quiesce_board_default(&board);
    board.sensors = board.bodies = board.dampers = 2;
    board.sensor[1] = board.sensor[0];
    board.sensor[1].at = 1;
    board.damper[1] = board.damper[0];
    board.damper[1].end_a = 1;
    board.damper[1].end_b = 0;
    board.damper[1].safe_mA = 321;
    return board;
}

static void test_a_board_gets_there_word_by_word(void) {
    const quiesce_board_t board = two_storeys();
    send_board(&board);
    TEST_ASSERT_EQUAL_MEMORY(&board, &server.board, sizeof board);
    TEST_ASSERT_FALSE(send_board_word(LOCKSTEP_CAN_BOARD_WORDS, 1));
    TEST_ASSERT_EQUAL_UINT32(1, start_board());
    // A build for one of each says that it is too small.
    TEST_ASSERT_EQUAL_UINT8(QUIESCE_SENSORS == 1, get_status().board_is_refused);
    TEST_ASSERT_EQUAL_UINT8(0, get_status().param_is_refused);
}

static void test_a_board_that_is_refused_commands_nothing(void) {
    quiesce_board_t board;
    quiesce_board_default(&board);
    board.damper[0].safe_mA = 700;
    board.damper[0].ceiling_mA = 600;
    send_board(&board);
    (void)start_board();
    TEST_ASSERT_EQUAL_UINT8(1, get_status().board_is_refused);
    TEST_ASSERT_EQUAL_UINT32(1, send_stimulus(1, 0));
    const struct quiesce_can_lockstep_command_t command = get_command(&replies[0]);
    TEST_ASSERT_EQUAL_INT32(0, command.current_cmd_mA);
    TEST_ASSERT_EQUAL_UINT32(0, command.driver_is_enabled);
    TEST_ASSERT_EQUAL_UINT32(QUIESCE_FAULT_PARAMETER, command.fault);
}

#if QUIESCE_SENSORS > 1 && QUIESCE_DAMPERS > 1
static uint32_t send_sample(int32_t counts, uint8_t number, uint8_t sequence) {
    const struct quiesce_can_lockstep_sensor_t sample = {counts, number, sequence};
    can_frame_t frame =
        make_frame(QUIESCE_CAN_LOCKSTEP_SENSOR_FRAME_ID, QUIESCE_CAN_LOCKSTEP_SENSOR_LENGTH);
    (void)quiesce_can_lockstep_sensor_pack(frame.data, &sample, sizeof frame.data);
    return lockstep_can_receive(&server, &frame, replies);
}

static void test_samples_and_commands_of_further_sensors_and_dampers(void) {
    const quiesce_board_t board = two_storeys();
    send_board(&board);
    (void)start_board();
    TEST_ASSERT_EQUAL_UINT32(0, send_sample(-77, 1, 0));
    TEST_ASSERT_EQUAL_UINT32(2, send_stimulus(5, 0));
    TEST_ASSERT_EQUAL_INT32(-77, server.server.in.sensor[1].counts);
    TEST_ASSERT_TRUE(server.server.in.sensor[1].is_fresh);
    struct quiesce_can_lockstep_damper_t damper;
    TEST_ASSERT_EQUAL_HEX32(QUIESCE_CAN_LOCKSTEP_DAMPER_FRAME_ID, replies[0].id);
    (void)quiesce_can_lockstep_damper_unpack(&damper, replies[0].data, replies[0].length);
    TEST_ASSERT_EQUAL_UINT8(1, damper.damper_number);
    TEST_ASSERT_EQUAL_UINT16(321, damper.current_cmd_mA);
    TEST_ASSERT_EQUAL_UINT8(0, damper.driver_is_enabled); // the self-test
    TEST_ASSERT_EQUAL_UINT8(0, damper.sequence);
    (void)get_command(&replies[1]);
    // Not twice, not of another tick, not the first sensor's.
    (void)send_stimulus(5, 1);
    TEST_ASSERT_FALSE(server.server.in.sensor[1].is_fresh);
    TEST_ASSERT_EQUAL_UINT32(0, send_sample(1, 1, 7));
    TEST_ASSERT_EQUAL_UINT16(1, server.sequence_errors);
    TEST_ASSERT_EQUAL_UINT32(0, send_sample(1, 0, 2));
    TEST_ASSERT_EQUAL_UINT16(1, server.unknown_frames);
    (void)send_stimulus(5, 2);
    TEST_ASSERT_FALSE(server.server.in.sensor[1].is_fresh);
}
#endif

static void test_current_reaches_its_own_stimulus_only(void) {
    (void)start(0, 0);
    TEST_ASSERT_EQUAL_UINT32(0, send_current(-5, 0));
    (void)send_stimulus(1, 0);
    TEST_ASSERT_TRUE(server.server.in.driver[0].is_measured);
    TEST_ASSERT_EQUAL_INT32(-5, server.server.in.driver[0].current_mA);
    (void)send_stimulus(1, 1);
    TEST_ASSERT_FALSE(server.server.in.driver[0].is_measured);
    TEST_ASSERT_EQUAL_UINT32(0, send_current(7, 1)); // late
    (void)send_stimulus(1, 2);
    TEST_ASSERT_FALSE(server.server.in.driver[0].is_measured);
    TEST_ASSERT_EQUAL_UINT16(1, server.sequence_errors);
}

static void test_full_telemetry_carries_every_word_then_the_command(void) {
    (void)start(1, QUIESCE_CAN_TELEMETRY_WORDS);
    TEST_ASSERT_EQUAL_UINT32(QUIESCE_CAN_TELEMETRY_WORDS + 1u, send_stimulus(-4321, 0));
    uint32_t words[QUIESCE_CAN_TELEMETRY_WORDS];
    for (uint32_t i = 0; i < QUIESCE_CAN_TELEMETRY_WORDS; i++) {
        TEST_ASSERT_EQUAL_HEX32(QUIESCE_CAN_TELEMETRY_FIRST_ID + i, replies[i].id);
        TEST_ASSERT_EQUAL_UINT8(4, replies[i].length);
        const uint8_t *d = replies[i].data;
        words[i] =
            (uint32_t)d[0] | (uint32_t)d[1] << 8 | (uint32_t)d[2] << 16 | (uint32_t)d[3] << 24;
    }
    // The report follows the telemetry.
    TEST_ASSERT_EQUAL_size_t(sizeof words, offsetof(lockstep_reply_t, picture) -
                                               offsetof(lockstep_reply_t, telemetry));
    TEST_ASSERT_EQUAL_MEMORY((const uint8_t *)&server.reply + offsetof(lockstep_reply_t, telemetry),
                             words, sizeof words);
    (void)get_command(&replies[QUIESCE_CAN_TELEMETRY_WORDS]);
}

static void test_decimated_telemetry_goes_round_all_words(void) {
    uint32_t next_id = QUIESCE_CAN_TELEMETRY_FIRST_ID;
    (void)start(5, 2);
    for (uint32_t tick = 1; tick <= 5u * QUIESCE_CAN_TELEMETRY_WORDS; tick++) {
        const uint32_t count = send_stimulus(1, (uint8_t)((tick - 1u) % 16u));
        TEST_ASSERT_EQUAL_UINT32(tick % 5u == 0 ? 3 : 1, count);
        for (uint32_t i = 0; i + 1u < count; i++) {
            TEST_ASSERT_EQUAL_HEX32(next_id, replies[i].id);
            next_id++;
            if (next_id == QUIESCE_CAN_TELEMETRY_FIRST_ID + QUIESCE_CAN_TELEMETRY_WORDS) {
                next_id = QUIESCE_CAN_TELEMETRY_FIRST_ID;
            }
        }
    }
    TEST_ASSERT_EQUAL_HEX32(QUIESCE_CAN_TELEMETRY_FIRST_ID, next_id);
}

static void test_restart_begins_from_rest(void) {
    (void)start(0, 0);
    (void)send_stimulus(1000, 0);
    (void)send_stimulus(1000, 1);
    (void)start(0, 0);
    TEST_ASSERT_EQUAL_UINT32(1, send_stimulus(1000, 0));
    TEST_ASSERT_EQUAL_UINT32(1, ticks_run());
}

static void test_stop_ends_and_status_reports(void) {
    (void)start(0, 0);
    TEST_ASSERT_EQUAL_UINT32(
        1, send_control(QUIESCE_CAN_LOCKSTEP_CONTROL_OPERATION_STATUS_CHOICE, 0, 0));
    TEST_ASSERT_EQUAL_UINT8(1, get_status().is_started);
    TEST_ASSERT_FALSE(server.is_stopped);
    TEST_ASSERT_EQUAL_UINT32(
        1, send_control(QUIESCE_CAN_LOCKSTEP_CONTROL_OPERATION_STOP_CHOICE, 0, 0));
    TEST_ASSERT_EQUAL_UINT8(0, get_status().is_started);
    TEST_ASSERT_TRUE(server.is_stopped);
    TEST_ASSERT_EQUAL_UINT32(0, send_stimulus(1, 0));
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(test_start_accepts_the_defaults);
    RUN_TEST(test_greeting_says_that_nothing_is_started);
    RUN_TEST(test_replies_equal_the_server_called_directly);
    RUN_TEST(test_accel_counts_keep_their_sign_and_all_24_bits);
    RUN_TEST(test_wrong_sequence_is_counted_and_no_tick_runs);
    RUN_TEST(test_stimulus_before_start_is_counted_and_no_tick_runs);
    RUN_TEST(test_unknown_or_misshapen_frames_change_nothing_but_their_counter);
    RUN_TEST(test_more_telemetry_than_there_is_is_refused);
    RUN_TEST(test_counters_saturate);
    RUN_TEST(test_parameters_are_stored_and_acknowledged);
    RUN_TEST(test_start_names_the_refused_parameter);
    RUN_TEST(test_a_board_gets_there_word_by_word);
    RUN_TEST(test_a_board_that_is_refused_commands_nothing);
#if QUIESCE_SENSORS > 1 && QUIESCE_DAMPERS > 1
    RUN_TEST(test_samples_and_commands_of_further_sensors_and_dampers);
#endif
    RUN_TEST(test_current_reaches_its_own_stimulus_only);
    RUN_TEST(test_full_telemetry_carries_every_word_then_the_command);
    RUN_TEST(test_decimated_telemetry_goes_round_all_words);
    RUN_TEST(test_restart_begins_from_rest);
    RUN_TEST(test_stop_ends_and_status_reports);
    return UNITY_END();
}
