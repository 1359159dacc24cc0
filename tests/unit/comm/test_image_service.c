// An image that a running node is sent in pieces, into a store of the test's that may be slow, fail
// or refuse, and when nothing may be armed. The sender is the test's own.
#include "can_make.h"
#include "node.h"
#include "unity.h"
#include "word_crc.h"

#include <string.h>

#define OP(name) QUIESCE_CAN_SERVICE_REQUEST_OPERATION_IMAGE_##name##_CHOICE
#define MOST_WORDS (TABLE_FILE_HEAD_WORDS + QUIESCE_TABLE_WORDS)
#define ROOM_WORDS 4096u
#define ARM_TICKS 3000u

static node_t node;
static bool enable;
static bool estop;
static bool reset;
static uint32_t file[MOST_WORDS];
static can_frame_t frames[NODE_MAX_FRAMES];
static uint32_t frame_count;
static uint8_t alive;
static uint32_t seed;

static struct {
    uint32_t words[ROOM_WORDS];
    uint32_t end; ///< of what was written
    image_store_answer_t answer;
    uint32_t slow; ///< calls that it takes
    uint32_t left;
    uint32_t prepared, finished, starts;
} store;

// ---- the store ----------------------------------------------------------------------------------

// Busy so many calls, then what it is to answer.
static image_store_answer_t next(void) {
    if (store.left > 0u) {
        store.left--;
        return IMAGE_STORE_BUSY;
    }
    store.left = store.slow;
    return store.answer;
}

static image_store_answer_t prepare(void *context) {
    TEST_ASSERT_EQUAL_PTR(&store, context);
    const image_store_answer_t answer = next();
    store.prepared += answer == IMAGE_STORE_DONE ? 1u : 0u;
    return answer;
}

static image_store_answer_t write(void *context, uint32_t at, const uint32_t *words,
                                  uint32_t count) {
    (void)context;
    TEST_ASSERT_LESS_OR_EQUAL_UINT32(IMAGE_PIECE_WORDS, count);
    const image_store_answer_t answer = next();
    if (answer == IMAGE_STORE_DONE) {
        memcpy(&store.words[at], words, 4u * count);
        store.end = at + count;
    }
    return answer;
}

static image_store_answer_t finish(void *context) {
    (void)context;
    const image_store_answer_t answer = next();
    store.finished += answer == IMAGE_STORE_DONE ? 1u : 0u;
    return answer;
}

static uint32_t tell(void *context, image_info_number_t what) {
    (void)context;
    return 1000u + (uint32_t)what;
}

static void restart(void *context) {
    (void)context;
    store.starts++;
}

static const image_store_t images = {&store, prepare, write, finish, tell, restart};

// ---- the node -----------------------------------------------------------------------------------

void setUp(void) {
    quiesce_params_t params;
    memset(&store, 0, sizeof store);
    store.answer = IMAGE_STORE_DONE;
    alive = 0;
    seed = 1;
    enable = estop = reset = false;
    quiesce_params_default(&params);
    memset(&node, 0xA5, sizeof node);
    TEST_ASSERT_TRUE(
        node_init(&node, NULL, &params, (node_sources_t){.enable = NODE_ENABLE_BOARD}));
    node_use_images(&node, &images);
}

void tearDown(void) {}

static void tick(void) {
    node_inputs_t inputs = {
        .enable = enable, .estop = estop, .fault_reset = reset, .ticks_elapsed = 1};
    seed = seed * 1664525u + 1013904223u;
    inputs.sensor[0].counts = (int32_t)(seed >> 16) - 32768;
    inputs.sensor[0].is_fresh = true;
    node_step(&node, &inputs);
    TEST_ASSERT_NULL(node_task(&node));
    frame_count = node_frames(&node, frames);
    TEST_ASSERT_LESS_OR_EQUAL_UINT32(NODE_MAX_FRAMES, frame_count);
}

static void run(uint32_t ticks) {
    for (uint32_t i = 0; i < ticks; i++) {
        tick();
    }
}

typedef struct quiesce_can_service_reply_t reply_t;

static bool took_reply(reply_t *reply) {
    for (uint32_t i = 0; i < frame_count; i++) {
        if (frames[i].id == QUIESCE_CAN_SERVICE_REPLY_FRAME_ID) {
            (void)quiesce_can_service_reply_unpack(reply, frames[i].data, frames[i].length);
            return true;
        }
    }
    return false;
}

static reply_t ask(uint32_t operation, uint32_t index, uint32_t value) {
    reply_t reply = {0};
    alive = (uint8_t)((alive + 1u) & 15u);
    const can_frame_t request =
        make_request((uint8_t)operation, (uint8_t)index, (int32_t)value, alive);
    node_receive(&node, &request);
    for (uint32_t i = 0; i < CAN_SERVICE_IMAGE_MS + 100u; i++) {
        tick();
        if (took_reply(&reply)) {
            TEST_ASSERT_EQUAL_UINT8(alive, reply.alive);
            return reply;
        }
    }
    TEST_FAIL_MESSAGE("no reply");
    return reply;
}

static void assert_result(can_node_result_t expected, uint32_t operation, uint32_t value) {
    TEST_ASSERT_EQUAL(expected, ask(operation, 0, value).result);
}

static bool is_armed(void) {
    return quiesce_is_armed(&node.controller);
}

static void arm(void) {
    enable = false;
    run(ARM_TICKS);
    enable = true;
    run(ARM_TICKS);
}

// ---- the sender ---------------------------------------------------------------------------------

static uint32_t crc_of(const uint32_t *words, uint32_t count) {
    uint32_t crc = WORD_CRC_START;
    for (uint32_t i = 0; i < count; i++) {
        crc = word_crc_append(crc, words[i]);
    }
    return ~crc;
}

static uint32_t image_word(uint32_t at) {
    return at * 2654435761u + 12345u;
}

// The file of a piece in file[]. Returns the piece's CRC.
static uint32_t pack(uint32_t at, uint32_t count) {
    uint32_t *const piece = &file[TABLE_FILE_HEAD_WORDS];
    piece[0] = IMAGE_PIECE_MAGIC;
    piece[2] = IMAGE_PIECE_HEAD_WORDS + count;
    piece[3] = at;
    for (uint32_t i = 0; i < count; i++) {
        piece[IMAGE_PIECE_HEAD_WORDS + i] = image_word(at + i);
    }
    piece[1] = crc_of(&piece[2], piece[2] - 2u);
    table_file_head(file, 0, piece[2]);
    return piece[1];
}

static void send(uint32_t words) {
    const uint32_t bytes = 4u * words;
    const uint8_t *const data = (const uint8_t *)file;
    can_frame_t frame = {.id = QUIESCE_CAN_TABLE_DATA_FRAME_ID, .length = 8};
    frame.data[0] = 0x10;
    for (uint32_t i = 0; i < 4u; i++) {
        frame.data[2u + i] = (uint8_t)(bytes >> (24u - 8u * i));
    }
    memcpy(&frame.data[6], data, 2);
    node_receive(&node, &frame);
    run(2);
    for (uint32_t done = 2, number = 1; done < bytes; number++) {
        const uint32_t left = bytes - done;
        frame.data[0] = (uint8_t)(0x20u | (number & 15u));
        memcpy(&frame.data[1], &data[done], left < 7u ? left : 7u);
        done += 7u;
        node_receive(&node, &frame);
        run(2);
    }
}

// Returns the piece's CRC.
static uint32_t send_piece(uint32_t at, uint32_t count) {
    const uint32_t crc = pack(at, count);
    send(TABLE_FILE_HEAD_WORDS + IMAGE_PIECE_HEAD_WORDS + count);
    return crc;
}

// ---- tests --------------------------------------------------------------------------------------

static void test_an_image_comes_in_pieces(void) {
    store.slow = store.left = 5;
    assert_result(CAN_NODE_DONE, OP(PREPARE), 0);
    TEST_ASSERT_EQUAL_UINT32(1, store.prepared);
    uint32_t at = 0;
    for (uint32_t count = IMAGE_PIECE_WORDS; at < 2600u; at += count) {
        count = 2600u - at < count ? 2600u - at : count;
        assert_result(CAN_NODE_DONE, OP(PIECE), send_piece(at, count));
    }
    TEST_ASSERT_EQUAL_INT32(2600, ask(OP(INFO), IMAGE_INFO_WORDS, 0).param_value);
    for (uint32_t i = 0; i < 2600u; i++) {
        TEST_ASSERT_EQUAL_HEX32(image_word(i), store.words[i]);
    }
    assert_result(CAN_NODE_DONE, OP(FINISH), 0);
    TEST_ASSERT_EQUAL_UINT32(1, store.finished);
    assert_result(CAN_NODE_DONE, OP(START), 0);
    TEST_ASSERT_EQUAL_UINT32(1, store.starts);
}

static void test_without_a_store_there_is_no_such_operation(void) {
    node_use_images(&node, NULL);
    for (uint32_t operation = OP(INFO); operation <= OP(START); operation++) {
        assert_result(CAN_NODE_NO_SUCH_OPERATION, operation, 0);
    }
    enable = true;
    run(ARM_TICKS);
    TEST_ASSERT_TRUE(is_armed());
}

static void test_it_tells_what_the_target_says(void) {
    for (uint32_t i = 0; i < IMAGE_INFO_WORDS; i++) {
        TEST_ASSERT_EQUAL_INT32((int32_t)(1000u + i), ask(OP(INFO), i, 0).param_value);
    }
    TEST_ASSERT_EQUAL(CAN_NODE_NO_SUCH_TABLE, ask(OP(INFO), IMAGE_INFOS, 0).result);
}

static void test_all_but_telling_is_refused_while_armed(void) {
    arm();
    TEST_ASSERT_TRUE(is_armed());
    TEST_ASSERT_EQUAL(CAN_NODE_DONE, ask(OP(INFO), 0, 0).result);
    for (uint32_t operation = OP(PREPARE); operation <= OP(START); operation++) {
        assert_result(CAN_NODE_IS_ARMED, operation, 0);
    }
    TEST_ASSERT_EQUAL_UINT32(0, store.prepared + store.starts);
    TEST_ASSERT_TRUE(is_armed());
}

static void test_nothing_is_armed_from_the_first_request_to_the_end(void) {
    assert_result(CAN_NODE_DONE, OP(PREPARE), 0);
    arm();
    TEST_ASSERT_FALSE(is_armed());
    const uint32_t crc = send_piece(0, 16);
    assert_result(CAN_NODE_DONE, OP(PIECE), crc);
    assert_result(CAN_NODE_DONE, OP(FINISH), 0);
    arm();
    TEST_ASSERT_TRUE(is_armed()); // it is tried at the next start, whenever that is
    enable = false;
    run(ARM_TICKS);
    assert_result(CAN_NODE_DONE, OP(START), 0);
    arm();
    TEST_ASSERT_FALSE(is_armed());
}

// The restart would forget it.
static void test_a_latched_fault_is_to_be_acknowledged_first(void) {
    estop = true;
    run(10);
    estop = false;
    run(10);
    TEST_ASSERT_EQUAL(QUIESCE_STATE_FAULT, node.out.telemetry.state);
    assert_result(CAN_NODE_FAULT_IS_LATCHED, OP(PREPARE), 0);
    assert_result(CAN_NODE_FAULT_IS_LATCHED, OP(START), 0);
    TEST_ASSERT_EQUAL(CAN_NODE_DONE, ask(OP(INFO), 0, 0).result);
    TEST_ASSERT_EQUAL_UINT32(0, store.prepared + store.starts);
    reset = true;
    run(10);
    reset = false;
    run(10);
    assert_result(CAN_NODE_DONE, OP(PREPARE), 0);
    estop = true; // in the middle of it
    run(10);
    estop = false;
    assert_result(CAN_NODE_DONE, OP(PIECE), send_piece(0, 16));
    assert_result(CAN_NODE_DONE, OP(FINISH), 0);
    assert_result(CAN_NODE_FAULT_IS_LATCHED, OP(START), 0);
}

static void test_an_image_on_trial_is_not_armed(void) {
    node.images.is_held = true;
    arm();
    TEST_ASSERT_FALSE(is_armed());
    node.images.is_held = false;
    arm();
    TEST_ASSERT_TRUE(is_armed());
}

static void test_an_update_that_falls_silent_is_given_up(void) {
    assert_result(CAN_NODE_DONE, OP(PREPARE), 0);
    run(IMAGE_SERVICE_QUIET_MS - 100u);
    assert_result(CAN_NODE_DONE, OP(PIECE), send_piece(0, 16)); // time begins anew
    run(IMAGE_SERVICE_QUIET_MS - 100u);
    TEST_ASSERT_TRUE(image_service_holds(&node.images));
    run(200);
    TEST_ASSERT_FALSE(image_service_holds(&node.images));
    assert_result(CAN_NODE_NOTHING_RECEIVED, OP(PIECE), send_piece(16, 16));
    assert_result(CAN_NODE_NOTHING_RECEIVED, OP(FINISH), 0);
    arm();
    TEST_ASSERT_TRUE(is_armed());
}

static void test_nothing_comes_before_it_is_prepared(void) {
    assert_result(CAN_NODE_NOTHING_RECEIVED, OP(PIECE), send_piece(0, 16));
    assert_result(CAN_NODE_NOTHING_RECEIVED, OP(FINISH), 0);
    TEST_ASSERT_EQUAL_UINT32(0, store.end + store.finished);
}

static void test_pieces_come_in_their_order_the_last_one_twice(void) {
    assert_result(CAN_NODE_DONE, OP(PREPARE), 0);
    assert_result(CAN_NODE_OUT_OF_RANGE, OP(PIECE), send_piece(16, 16));
    assert_result(CAN_NODE_DONE, OP(PIECE), send_piece(0, 32));
    assert_result(CAN_NODE_DONE, OP(PIECE), send_piece(0, 32)); // its reply was lost
    assert_result(CAN_NODE_OUT_OF_RANGE, OP(PIECE), send_piece(0, 16));
    assert_result(CAN_NODE_OUT_OF_RANGE, OP(PIECE), send_piece(36, 16));
    assert_result(CAN_NODE_OUT_OF_RANGE, OP(PIECE), send_piece(2, 16));
    assert_result(CAN_NODE_OUT_OF_RANGE, OP(PIECE), send_piece(32, IMAGE_PIECE_WORDS + 4u));
    assert_result(CAN_NODE_DONE, OP(PIECE), send_piece(32, 16));
    TEST_ASSERT_EQUAL_UINT32(48, store.end);
}

static void test_what_is_damaged_or_another_thing_is_not_written(void) {
    assert_result(CAN_NODE_DONE, OP(PREPARE), 0);
    const uint32_t crc = pack(0, 16);
    assert_result(CAN_NODE_NOTHING_RECEIVED, OP(PIECE), crc); // it was not sent
    file[TABLE_FILE_HEAD_WORDS + 9u] ^= 1u;
    send(TABLE_FILE_HEAD_WORDS + IMAGE_PIECE_HEAD_WORDS + 16u);
    assert_result(CAN_NODE_NOTHING_RECEIVED, OP(PIECE), crc);
    (void)pack(0, 16);
    file[TABLE_FILE_HEAD_WORDS] ^= 1u; // of another kind
    send(TABLE_FILE_HEAD_WORDS + IMAGE_PIECE_HEAD_WORDS + 16u);
    assert_result(CAN_NODE_NOTHING_RECEIVED, OP(PIECE), crc);
    assert_result(CAN_NODE_NOTHING_RECEIVED, OP(PIECE), send_piece(0, 16) + 1u);
    TEST_ASSERT_EQUAL_UINT32(0, store.end);
    assert_result(CAN_NODE_DONE, OP(PIECE), send_piece(0, 16));
}

static void test_a_piece_is_no_table(void) {
    const uint32_t crc = send_piece(0, 16);
    const reply_t reply = ask(QUIESCE_CAN_SERVICE_REQUEST_OPERATION_TABLE_COMMIT_CHOICE, 0, crc);
    TEST_ASSERT_EQUAL(CAN_NODE_TABLE_REFUSED, reply.result);
    TEST_ASSERT_EQUAL_INT32(QUIESCE_TABLE_MAGIC, reply.param_value);
}

static void test_a_store_that_fails_or_refuses_is_told(void) {
    store.answer = IMAGE_STORE_FAILED;
    assert_result(CAN_NODE_STORE_FAILED, OP(PREPARE), 0);
    TEST_ASSERT_FALSE(image_service_holds(&node.images));
    store.answer = IMAGE_STORE_DONE;
    assert_result(CAN_NODE_DONE, OP(PREPARE), 0);
    const uint32_t crc = send_piece(0, 16);
    store.answer = IMAGE_STORE_FAILED;
    assert_result(CAN_NODE_STORE_FAILED, OP(PIECE), crc);
    store.answer = IMAGE_STORE_DONE;
    assert_result(CAN_NODE_DONE, OP(PIECE), crc);
    store.answer = IMAGE_STORE_REFUSED;
    assert_result(CAN_NODE_IMAGE_REFUSED, OP(FINISH), 0);
    TEST_ASSERT_FALSE(image_service_holds(&node.images));
    TEST_ASSERT_EQUAL_UINT32(0, store.finished);
}

// Its reply was lost, or its sender went away: what erases goes on to its end.
static void test_a_request_that_is_left_alone_is_brought_to_its_end(void) {
    store.slow = store.left = CAN_SERVICE_IMAGE_MS + 7000u;
    assert_result(CAN_NODE_STORE_FAILED, OP(PREPARE), 0);
    arm();
    TEST_ASSERT_TRUE(image_service_holds(&node.images));
    TEST_ASSERT_FALSE(is_armed());
    run(2000);
    TEST_ASSERT_EQUAL_UINT32(1, store.prepared);
    store.slow = store.left = 0;
    assert_result(CAN_NODE_DONE, OP(PIECE), send_piece(0, 16));
    assert_result(CAN_NODE_DONE, OP(FINISH), 0);
    assert_result(CAN_NODE_DONE, OP(FINISH), 0);
    TEST_ASSERT_EQUAL_UINT32(1, store.finished);
    assert_result(CAN_NODE_DONE, OP(PREPARE), 0);
    assert_result(CAN_NODE_DONE, OP(PIECE), send_piece(0, 16));
    assert_result(CAN_NODE_DONE, OP(FINISH), 0);
    TEST_ASSERT_EQUAL_UINT32(2, store.finished);
    assert_result(CAN_NODE_DONE, OP(START), 0);
    assert_result(CAN_NODE_DONE, OP(START), 0);
    TEST_ASSERT_EQUAL_UINT32(1, store.starts);
}

static bool is_driven(void) {
    return node.out.damper[0].driver_enable;
}

// Flash is erased in this time, and the processor stands still for it.
static void test_drivers_are_off_while_nothing_may_be_armed(void) {
    run(ARM_TICKS);
    TEST_ASSERT_TRUE(is_driven());
    assert_result(CAN_NODE_DONE, OP(PREPARE), 0);
    run(1);
    TEST_ASSERT_FALSE(is_driven());
    run(IMAGE_SERVICE_QUIET_MS + NODE_HELD_MS);
    TEST_ASSERT_TRUE(is_driven());
    TEST_ASSERT_EQUAL(QUIESCE_STATE_IDLE, node.out.telemetry.state);
}

// The switch was left on when the update began, or when the board was started on trial.
static void test_nothing_is_armed_by_itself_once_it_may_be(void) {
    arm();
    estop = true;
    run(10);
    estop = false;
    reset = true;
    run(10);
    reset = false;
    assert_result(CAN_NODE_DONE, OP(PREPARE), 0);
    run(IMAGE_SERVICE_QUIET_MS + ARM_TICKS);
    TEST_ASSERT_FALSE(image_service_holds(&node.images));
    TEST_ASSERT_FALSE(is_armed());
    enable = false;
    run(10);
    enable = true;
    run(ARM_TICKS);
    TEST_ASSERT_TRUE(is_armed());
}

static void test_a_trial_that_ends_well_arms_nothing_by_itself(void) {
    enable = true;
    node.images.is_held = true;
    run(ARM_TICKS);
    node.images.is_held = false;
    run(ARM_TICKS);
    TEST_ASSERT_FALSE(is_armed());
    arm();
    TEST_ASSERT_TRUE(is_armed());
}

// It would be its last start.
static void test_an_image_on_trial_is_not_started_again(void) {
    node.images.is_held = true;
    assert_result(CAN_NODE_IMAGE_REFUSED, OP(START), 0);
    TEST_ASSERT_EQUAL_UINT32(0, store.starts);
}

static void test_a_store_that_never_answers_costs_nothing_else(void) {
    store.slow = store.left = UINT32_MAX;
    assert_result(CAN_NODE_STORE_FAILED, OP(PREPARE), 0);
    TEST_ASSERT_EQUAL(CAN_NODE_DONE, ask(OP(INFO), 0, 0).result);
    TEST_ASSERT_TRUE(image_service_holds(&node.images));
    run(IMAGE_SERVICE_QUIET_MS);
    TEST_ASSERT_FALSE(image_service_holds(&node.images));
    arm();
    TEST_ASSERT_TRUE(is_armed());
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(test_an_image_comes_in_pieces);
    RUN_TEST(test_without_a_store_there_is_no_such_operation);
    RUN_TEST(test_it_tells_what_the_target_says);
    RUN_TEST(test_all_but_telling_is_refused_while_armed);
    RUN_TEST(test_nothing_is_armed_from_the_first_request_to_the_end);
    RUN_TEST(test_a_latched_fault_is_to_be_acknowledged_first);
    RUN_TEST(test_an_image_on_trial_is_not_armed);
    RUN_TEST(test_an_update_that_falls_silent_is_given_up);
    RUN_TEST(test_nothing_comes_before_it_is_prepared);
    RUN_TEST(test_pieces_come_in_their_order_the_last_one_twice);
    RUN_TEST(test_what_is_damaged_or_another_thing_is_not_written);
    RUN_TEST(test_a_piece_is_no_table);
    RUN_TEST(test_a_store_that_fails_or_refuses_is_told);
    RUN_TEST(test_a_request_that_is_left_alone_is_brought_to_its_end);
    RUN_TEST(test_drivers_are_off_while_nothing_may_be_armed);
    RUN_TEST(test_nothing_is_armed_by_itself_once_it_may_be);
    RUN_TEST(test_a_trial_that_ends_well_arms_nothing_by_itself);
    RUN_TEST(test_an_image_on_trial_is_not_started_again);
    RUN_TEST(test_a_store_that_never_answers_costs_nothing_else);
    return UNITY_END();
}
