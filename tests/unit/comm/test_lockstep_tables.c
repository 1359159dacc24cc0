// Tables on their way to a lock-step server over CAN: friction of a damper and its map.
#include "lockstep_can.h"
#include "unity.h"
#include "word_crc.h"

#include <string.h>

enum { FRICTION_WORDS = 9, MAP_WORDS = 15 };

static lockstep_can_t server;
static can_frame_t replies[LOCKSTEP_CAN_MAX_REPLIES];
static uint32_t friction[FRICTION_WORDS];
static uint32_t map[MAP_WORDS];

static void seal(uint32_t *words, uint32_t count) {
    words[2] = count;
    uint32_t crc = WORD_CRC_START;
    for (uint32_t i = 2; i < count; i++) {
        crc = word_crc_append(crc, words[i]);
    }
    words[1] = ~crc;
}

static bool write_word(uint32_t index, uint32_t value) {
    const struct quiesce_can_lockstep_param_write_t write = {(uint16_t)index, (int32_t)value};
    can_frame_t frame = {.id = QUIESCE_CAN_LOCKSTEP_PARAM_WRITE_FRAME_ID,
                         .length = QUIESCE_CAN_LOCKSTEP_PARAM_WRITE_LENGTH};
    struct quiesce_can_lockstep_param_ack_t ack;
    (void)quiesce_can_lockstep_param_write_pack(frame.data, &write, sizeof frame.data);
    TEST_ASSERT_EQUAL_UINT32(1, lockstep_can_receive(&server, &frame, replies));
    (void)quiesce_can_lockstep_param_ack_unpack(&ack, replies[0].data, replies[0].length);
    TEST_ASSERT_EQUAL_UINT32(index, ack.param_index);
    TEST_ASSERT_EQUAL_HEX32(ack.is_stored != 0 ? value : 0, (uint32_t)ack.param_value);
    return ack.is_stored != 0;
}

static uint32_t index_of(uint32_t table, uint32_t word) {
    return LOCKSTEP_CAN_TABLE_INDEX + LOCKSTEP_CAN_TABLE_INDICES * table + word;
}

static bool write_count(uint32_t table, uint32_t count) {
    return write_word(index_of(table, LOCKSTEP_CAN_TABLE_COUNT), count);
}

static void write_table(uint32_t table, const uint32_t *words, uint32_t count) {
    for (uint32_t i = 0; i < count; i++) {
        TEST_ASSERT_TRUE(write_word(index_of(table, i), words[i]));
    }
    TEST_ASSERT_TRUE(write_count(table, count));
}

static struct quiesce_can_lockstep_status_t control(uint8_t operation) {
    const struct quiesce_can_lockstep_control_t wanted = {.operation = operation};
    can_frame_t frame = {.id = QUIESCE_CAN_LOCKSTEP_CONTROL_FRAME_ID,
                         .length = QUIESCE_CAN_LOCKSTEP_CONTROL_LENGTH};
    struct quiesce_can_lockstep_status_t status;
    (void)quiesce_can_lockstep_control_pack(frame.data, &wanted, sizeof frame.data);
    TEST_ASSERT_EQUAL_UINT32(1, lockstep_can_receive(&server, &frame, replies));
    (void)quiesce_can_lockstep_status_unpack(&status, replies[0].data, replies[0].length);
    return status;
}

static struct quiesce_can_lockstep_status_t start(void) {
    return control(QUIESCE_CAN_LOCKSTEP_CONTROL_OPERATION_START_BOARD_CHOICE);
}

static uint32_t tick(uint8_t sequence) {
    const struct quiesce_can_lockstep_stimulus_t wanted = {
        .accel_counts = 1000, .accel_is_fresh = 1, .sequence = sequence};
    can_frame_t frame = {.id = QUIESCE_CAN_LOCKSTEP_STIMULUS_FRAME_ID,
                         .length = QUIESCE_CAN_LOCKSTEP_STIMULUS_LENGTH};
    (void)quiesce_can_lockstep_stimulus_pack(frame.data, &wanted, sizeof frame.data);
    return lockstep_can_receive(&server, &frame, replies);
}

// An accelerometer, and a sensor of the damper's stroke.
static void make_board(quiesce_board_t *board) {
    board->sensors = 2;
    board->sensor[1] = board->sensor[0];
    board->sensor[1].sense = QUIESCE_SENSE_STROKE;
    board->sensor[1].scale = 1000;
}

void setUp(void) {
    lockstep_can_init(&server);
    make_board(&server.board);
    server.params.law = QUIESCE_LAW_FRICTION;
    server.params.tracker = QUIESCE_TRACKER_INVERSE;
    const uint32_t of_law[FRICTION_WORDS] = {0x31524651, 0, 0, 1, 5000, 100000, 30000, 200, 3};
    const uint32_t of_tracker[MAP_WORDS] = {
        0x32464D51,      0, 0,   1, 4, 2, 2, (uint32_t)-1000, 1000, 0, 2000, (uint32_t)-1,
        (uint32_t)-1000, 1, 1000};
    memcpy(friction, of_law, sizeof friction);
    memcpy(map, of_tracker, sizeof map);
    seal(friction, FRICTION_WORDS);
    seal(map, MAP_WORDS);
}

void tearDown(void) {}

static void assert_refused(uint32_t table, quiesce_table_verdict_t verdict) {
    const struct quiesce_can_lockstep_status_t status = start();
    TEST_ASSERT_EQUAL_UINT8(verdict, status.table_verdict);
    TEST_ASSERT_EQUAL_UINT8(table, status.refused_index);
    TEST_ASSERT_EQUAL_UINT8(0, status.param_is_refused);
    TEST_ASSERT_EQUAL_UINT8(0, status.board_is_refused);
    TEST_ASSERT_EQUAL_UINT32(1, tick(0)); // latched: it answers, and runs nothing
    TEST_ASSERT_EQUAL_UINT32(QUIESCE_FAULT_PARAMETER, server.reply.telemetry.fault);
    TEST_ASSERT_EQUAL_UINT32(0, server.reply.drivers_enabled);
}

static void assert_accepted(void) {
    const struct quiesce_can_lockstep_status_t status = start();
    TEST_ASSERT_EQUAL_UINT8(1, status.is_started);
    TEST_ASSERT_EQUAL_UINT8(QUIESCE_TABLE_OK, status.table_verdict);
    TEST_ASSERT_EQUAL_UINT8(0, status.refused_index);
    TEST_ASSERT_EQUAL_UINT8(0, status.board_is_refused);
    TEST_ASSERT_EQUAL_UINT32(1, tick(0));
    TEST_ASSERT_EQUAL_UINT32(QUIESCE_FAULT_NONE, server.reply.telemetry.fault);
}

static void test_tables_get_there_word_by_word(void) {
    assert_accepted();
    TEST_ASSERT_EQUAL_STRING("friction", quiesce_lacks_table(&server.server.controller));
    write_table(LOCKSTEP_LAW_TABLE, friction, FRICTION_WORDS);
    assert_accepted();
    TEST_ASSERT_EQUAL_STRING("inverse", quiesce_lacks_table(&server.server.controller));
    write_table(LOCKSTEP_TRACKER_TABLE, map, MAP_WORDS);
    assert_accepted();
    TEST_ASSERT_NULL(quiesce_lacks_table(&server.server.controller));
    TEST_ASSERT_EQUAL_HEX32(friction[1], quiesce_table_hash(&server.server.controller));
    assert_accepted(); // as parameters and board they stay
    TEST_ASSERT_NULL(quiesce_lacks_table(&server.server.controller));
    (void)write_count(LOCKSTEP_LAW_TABLE, 0);
    assert_accepted();
    TEST_ASSERT_EQUAL_STRING("friction", quiesce_lacks_table(&server.server.controller));
}

static void test_a_refused_table_is_named_with_the_reason(void) {
    write_table(LOCKSTEP_LAW_TABLE, friction, FRICTION_WORDS);
    write_table(LOCKSTEP_TRACKER_TABLE, map, MAP_WORDS);
    (void)write_word(index_of(LOCKSTEP_LAW_TABLE, 1), friction[1] ^ 1u);
    assert_refused(LOCKSTEP_LAW_TABLE, QUIESCE_TABLE_CRC);
    (void)write_word(index_of(LOCKSTEP_LAW_TABLE, 0), 0x31545A46); // rules
    assert_refused(LOCKSTEP_LAW_TABLE, QUIESCE_TABLE_MAGIC);
    write_table(LOCKSTEP_LAW_TABLE, friction, FRICTION_WORDS - 1u);
    assert_refused(LOCKSTEP_LAW_TABLE, QUIESCE_TABLE_SIZE);
    write_table(LOCKSTEP_LAW_TABLE, friction, FRICTION_WORDS);
    write_table(LOCKSTEP_TRACKER_TABLE, map, MAP_WORDS - 1u);
    assert_refused(LOCKSTEP_TRACKER_TABLE, QUIESCE_TABLE_SIZE);
    map[12] = 1;
    seal(map, MAP_WORDS);
    write_table(LOCKSTEP_TRACKER_TABLE, map, MAP_WORDS);
    assert_refused(LOCKSTEP_TRACKER_TABLE, QUIESCE_TABLE_POINT);
    // A refused parameter is all that is said.
    (void)write_word(0, (uint32_t)INT32_MIN);
    TEST_ASSERT_EQUAL_UINT8(1, start().param_is_refused);
    TEST_ASSERT_EQUAL_UINT8(QUIESCE_TABLE_OK, start().table_verdict);
}

static void test_more_words_than_there_can_be_are_refused_unread(void) {
    write_table(LOCKSTEP_LAW_TABLE, friction, FRICTION_WORDS);
    TEST_ASSERT_TRUE(write_count(LOCKSTEP_LAW_TABLE, QUIESCE_TABLE_WORDS + 1u));
    assert_refused(LOCKSTEP_LAW_TABLE, QUIESCE_TABLE_SIZE);
    TEST_ASSERT_TRUE(write_count(LOCKSTEP_LAW_TABLE, UINT32_MAX));
    assert_refused(LOCKSTEP_LAW_TABLE, QUIESCE_TABLE_SIZE);
    TEST_ASSERT_FALSE(write_word(index_of(LOCKSTEP_LAW_TABLE, QUIESCE_TABLE_WORDS), 1));
    TEST_ASSERT_FALSE(write_word(index_of(LOCKSTEP_LAW_TABLE, LOCKSTEP_CAN_TABLE_COUNT - 1u), 1));
    TEST_ASSERT_FALSE(write_word(index_of(LOCKSTEP_TABLES, 0), 1));
    TEST_ASSERT_FALSE(write_word(UINT16_MAX, 1));
}

// What runs has its table in this memory.
static void test_a_word_of_a_table_ends_the_run(void) {
    write_table(LOCKSTEP_LAW_TABLE, friction, FRICTION_WORDS);
    assert_accepted();
    TEST_ASSERT_EQUAL_UINT32(1, tick(1));
    (void)write_word(index_of(LOCKSTEP_TRACKER_TABLE, 5), 7);
    TEST_ASSERT_EQUAL_UINT8(
        0, control(QUIESCE_CAN_LOCKSTEP_CONTROL_OPERATION_STATUS_CHOICE).is_started);
    TEST_ASSERT_EQUAL_UINT32(0, tick(2));
    TEST_ASSERT_EQUAL_UINT16(1, server.unknown_frames);
    assert_accepted();
    // A parameter or a word of the board does not.
    (void)write_word(3, 7);
    (void)write_word(LOCKSTEP_CAN_BOARD_INDEX, 1);
    TEST_ASSERT_EQUAL_UINT32(1, tick(1));
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(test_tables_get_there_word_by_word);
    RUN_TEST(test_a_refused_table_is_named_with_the_reason);
    RUN_TEST(test_more_words_than_there_can_be_are_refused_unread);
    RUN_TEST(test_a_word_of_a_table_ends_the_run);
    return UNITY_END();
}
