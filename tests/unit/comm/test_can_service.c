// Service requests: parameters read, staged, applied, saved; one at a time.
#include "can_make.h"
#include "can_node.h"
#include "unity.h"

#include <string.h>

#define OP(name) QUIESCE_CAN_SERVICE_REQUEST_OPERATION_##name##_CHOICE
#define INDEX_OF(field) (offsetof(quiesce_params_t, field) / sizeof(int32_t))

static can_node_t node;
static quiesce_params_t params;
static quiesce_out_t out;
static can_node_tick_t tick;
static quiesce_t controller;
static can_frame_t frames[CAN_NODE_MAX_FRAMES];

void setUp(void) {
    quiesce_params_default(&params);
    can_node_init(&node, NULL, &params);
    (void)quiesce_init(&controller, &params);
    memset(&out, 0, sizeof out);
    memset(&tick, 0, sizeof tick);
}

void tearDown(void) {}

static void request(uint32_t operation, uint32_t index, int32_t value, uint8_t alive) {
    const can_frame_t frame = make_request((uint8_t)operation, (uint8_t)index, value, alive);
    can_node_receive(&node, &frame);
}

// The reply of the next tick, if there is one.
static bool next_reply(struct quiesce_can_service_reply_t *reply) {
    const uint32_t count = can_node_tick(&node, &tick, &out, &controller, frames);
    const can_frame_t *last = &frames[count - 1u];
    if (message_of(last) != QUIESCE_CAN_AT_SERVICE_REPLY) {
        return false;
    }
    TEST_ASSERT_TRUE(is_well_made(last));
    (void)quiesce_can_service_reply_unpack(reply, last->data, last->length);
    return true;
}

static struct quiesce_can_service_reply_t reply_soon(void) {
    struct quiesce_can_service_reply_t reply;
    for (uint32_t i = 0; i < 11; i++) {
        if (next_reply(&reply)) {
            return reply;
        }
    }
    TEST_FAIL_MESSAGE("no reply");
    return reply;
}

static struct quiesce_can_service_reply_t ask(uint32_t operation, uint32_t index, int32_t value) {
    request(operation, index, value, 9);
    const struct quiesce_can_service_reply_t reply = reply_soon();
    TEST_ASSERT_EQUAL_UINT8(operation, reply.operation);
    TEST_ASSERT_EQUAL_UINT8(9, reply.alive);
    return reply;
}

static void test_every_parameter_is_read(void) {
    for (uint32_t index = 0; index < 256; index++) {
        int32_t value = 0;
        const bool is_there = quiesce_param_get(&params, index, &value);
        const struct quiesce_can_service_reply_t reply = ask(OP(READ), index, 99);
        TEST_ASSERT_EQUAL(is_there ? CAN_NODE_DONE : CAN_NODE_NO_SUCH_PARAMETER, reply.result);
        TEST_ASSERT_EQUAL_INT32(value, reply.param_value);
        TEST_ASSERT_EQUAL_UINT8(index, reply.param_index);
    }
}

static void test_every_parameter_is_staged_within_its_range_only(void) {
    for (uint32_t index = 0; index < QUIESCE_PARAM_COUNT; index++) {
        const quiesce_param_info_t *info = quiesce_param_info(index);
        TEST_ASSERT_EQUAL(CAN_NODE_DONE, ask(OP(STAGE), index, info->min).result);
        TEST_ASSERT_EQUAL(CAN_NODE_DONE, ask(OP(STAGE), index, info->max).result);
        TEST_ASSERT_EQUAL_INT32(info->max, node.service.reply.param_value);
        const int64_t beyond[] = {(int64_t)info->min - 1, (int64_t)info->max + 1};
        for (uint32_t i = 0; i < 2; i++) {
            if (beyond[i] >= INT32_MIN && beyond[i] <= INT32_MAX) {
                const struct quiesce_can_service_reply_t reply =
                    ask(OP(STAGE), index, (int32_t)beyond[i]);
                TEST_ASSERT_EQUAL(CAN_NODE_OUT_OF_RANGE, reply.result);
                TEST_ASSERT_EQUAL_INT32(0, reply.param_value);
            }
        }
        int32_t staged = 0;
        (void)quiesce_param_get(can_node_staged(&node), index, &staged);
        TEST_ASSERT_EQUAL_INT32(info->max, staged);
    }
    TEST_ASSERT_EQUAL(CAN_NODE_OUT_OF_RANGE,
                      ask(OP(STAGE), INDEX_OF(tick_rate_Hz), 1500).result); // no choice
    TEST_ASSERT_EQUAL(CAN_NODE_NO_SUCH_PARAMETER, ask(OP(STAGE), QUIESCE_PARAM_COUNT, 1).result);
    TEST_ASSERT_EQUAL_MEMORY(&params, &node.service.in_effect, sizeof params);
}

static void test_staged_values_are_not_in_effect(void) {
    (void)ask(OP(STAGE), INDEX_OF(slew_mA_s), 12345);
    TEST_ASSERT_EQUAL_INT32(params.slew_mA_s, ask(OP(READ), INDEX_OF(slew_mA_s), 0).param_value);
}

static void test_apply_is_the_applications_task(void) {
    struct quiesce_can_service_reply_t reply;
    (void)ask(OP(STAGE), INDEX_OF(slew_mA_s), 12345);
    request(OP(APPLY), 7, 0, 4);
    TEST_ASSERT_EQUAL(CAN_NODE_APPLY, can_node_task(&node));
    TEST_ASSERT_EQUAL_INT32(12345, can_node_staged(&node)->slew_mA_s);
    for (uint32_t i = 0; i < 20; i++) {
        TEST_ASSERT_FALSE(next_reply(&reply));
    }
    params.slew_mA_s = 12345;
    can_node_use_params(&node, NULL, &params);
    can_node_answer(&node, CAN_NODE_DONE, 0);
    TEST_ASSERT_EQUAL(CAN_NODE_NOTHING, can_node_task(&node));
    TEST_ASSERT_TRUE(next_reply(&reply));
    TEST_ASSERT_EQUAL(CAN_NODE_DONE, reply.result);
    TEST_ASSERT_EQUAL_UINT8(7, reply.param_index);
    TEST_ASSERT_EQUAL_UINT8(4, reply.alive);
    TEST_ASSERT_EQUAL_INT32(12345, ask(OP(READ), INDEX_OF(slew_mA_s), 0).param_value);
}

static void test_refused_apply_names_the_parameter_and_keeps_what_is_staged(void) {
    (void)ask(OP(STAGE), INDEX_OF(slew_mA_s), 12345);
    request(OP(APPLY), 0, 0, 0);
    can_node_answer(&node, CAN_NODE_CONTRADICTION, 22);
    const struct quiesce_can_service_reply_t reply = reply_soon();
    TEST_ASSERT_EQUAL(CAN_NODE_CONTRADICTION, reply.result);
    TEST_ASSERT_EQUAL_UINT8(22, reply.param_index);
    TEST_ASSERT_EQUAL_INT32(12345, can_node_staged(&node)->slew_mA_s);
}

static void test_apply_with_nothing_staged_does_nothing(void) {
    TEST_ASSERT_EQUAL(CAN_NODE_DONE, ask(OP(APPLY), 0, 0).result);
    (void)ask(OP(STAGE), INDEX_OF(slew_mA_s), 12345);
    TEST_ASSERT_EQUAL(CAN_NODE_DONE, ask(OP(DISCARD), 0, 0).result);
    TEST_ASSERT_EQUAL_MEMORY(&params, can_node_staged(&node), sizeof params);
    TEST_ASSERT_EQUAL(CAN_NODE_DONE, ask(OP(APPLY), 0, 0).result);
}

static void test_save_is_the_applications_task(void) {
    request(OP(SAVE), 0, 0, 0);
    TEST_ASSERT_EQUAL(CAN_NODE_SAVE, can_node_task(&node));
    can_node_answer(&node, CAN_NODE_STORE_FAILED, 0);
    TEST_ASSERT_EQUAL(CAN_NODE_STORE_FAILED, reply_soon().result);
}

static void test_answer_without_a_task_does_nothing(void) {
    struct quiesce_can_service_reply_t reply;
    can_node_answer(&node, CAN_NODE_DONE, 0);
    TEST_ASSERT_FALSE(next_reply(&reply));
}

static void test_second_request_is_busy_and_a_third_gets_no_answer(void) {
    struct quiesce_can_service_reply_t reply;
    request(OP(SAVE), 0, 0, 1);
    request(OP(READ), 3, 0, 2);
    request(OP(READ), 4, 0, 3);
    TEST_ASSERT_TRUE(next_reply(&reply));
    TEST_ASSERT_EQUAL(CAN_NODE_BUSY, reply.result);
    TEST_ASSERT_EQUAL_UINT8(2, reply.alive);
    TEST_ASSERT_EQUAL_UINT8(3, reply.param_index);
    can_node_answer(&node, CAN_NODE_DONE, 0);
    TEST_ASSERT_EQUAL_UINT8(1, reply_soon().alive);
    for (uint32_t i = 0; i < 30; i++) {
        TEST_ASSERT_FALSE(next_reply(&reply));
    }
}

static void test_replies_keep_their_distance(void) {
    struct quiesce_can_service_reply_t reply;
    request(OP(READ), 0, 0, 0);
    TEST_ASSERT_TRUE(next_reply(&reply));
    request(OP(READ), 0, 0, 1);
    for (uint32_t i = 0; i < 9; i++) {
        TEST_ASSERT_FALSE(next_reply(&reply));
    }
    TEST_ASSERT_TRUE(next_reply(&reply));
}

static void test_stream_takes_a_bounded_time(void) {
    TEST_ASSERT_EQUAL(CAN_NODE_OUT_OF_RANGE, ask(OP(RAW_STREAM), 0, 3601).result);
    TEST_ASSERT_EQUAL(CAN_NODE_OUT_OF_RANGE, ask(OP(RAW_STREAM), 0, -1).result);
    TEST_ASSERT_EQUAL(CAN_NODE_OUT_OF_RANGE, ask(OP(RAW_STREAM), 0, INT32_MAX).result);
    TEST_ASSERT_EQUAL_UINT32(0, node.service.raw_ms);
    TEST_ASSERT_EQUAL(CAN_NODE_DONE, ask(OP(RAW_STREAM), 0, 3600).result);
    TEST_ASSERT_GREATER_THAN_UINT32(3599000, node.service.raw_ms);
    TEST_ASSERT_EQUAL(CAN_NODE_DONE, ask(OP(RAW_STREAM), 0, 0).result);
    TEST_ASSERT_EQUAL_UINT32(0, node.service.raw_ms);
}

static void test_unknown_operations_are_refused(void) {
    for (uint32_t operation = 0; operation < 256; operation++) {
        if (operation < OP(READ) || operation > OP(IMAGE_START)) {
            TEST_ASSERT_EQUAL(CAN_NODE_NO_SUCH_OPERATION, ask(operation, 0, 0).result);
        }
    }
    TEST_ASSERT_EQUAL(CAN_NODE_NOTHING, can_node_task(&node));
}

static void test_record_without_a_fault_is_nothing_to_send(void) {
    TEST_ASSERT_EQUAL(CAN_NODE_NOTHING_TO_SEND, ask(OP(FAULT_RECORD), 0, 0).result);
    TEST_ASSERT_EQUAL(CAN_NODE_NOTHING_TO_SEND, ask(OP(CLEAR_RECORD), 0, 0).result);
}

static uint32_t count_pages(uint32_t ticks) {
    uint32_t count = 0;
    for (uint32_t i = 0; i < ticks; i++) {
        const uint32_t sent = can_node_tick(&node, &tick, &out, &controller, frames);
        for (uint32_t k = 0; k < sent; k++) {
            count += message_of(&frames[k]) == QUIESCE_CAN_AT_FAULT_RECORD ? 1u : 0u;
        }
    }
    return count;
}

static void test_record_is_sent_by_pages_and_cleared(void) {
    tick.ticks = 1;
    out.telemetry.fault = QUIESCE_FAULT_ESTOP;
    out.telemetry.fault_count = 1;
    TEST_ASSERT_EQUAL_UINT32(0, count_pages(10));
    TEST_ASSERT_EQUAL(CAN_NODE_BUSY, ask(OP(FAULT_RECORD), 0, 0).result);
    TEST_ASSERT_EQUAL(CAN_NODE_BUSY, ask(OP(CLEAR_RECORD), 0, 0).result);
    TEST_ASSERT_EQUAL_UINT32(0, count_pages(1000));
    out.telemetry.fault_count = 3;
    TEST_ASSERT_EQUAL_UINT32(0, count_pages(10));
    const struct quiesce_can_service_reply_t all = ask(OP(FAULT_RECORD), 0, 0);
    TEST_ASSERT_EQUAL(CAN_NODE_DONE, all.result);
    TEST_ASSERT_EQUAL_INT32(FAULT_RECORD_PAGES | 1 << 16, all.param_value);
    TEST_ASSERT_UINT32_WITHIN(2, FAULT_RECORD_PAGES, count_pages(10u * FAULT_RECORD_PAGES + 20u));
    TEST_ASSERT_EQUAL(CAN_NODE_DONE, ask(OP(FAULT_RECORD), 0, 300 | 5 << 16).result);
    TEST_ASSERT_UINT32_WITHIN(1, 5, count_pages(100));
    TEST_ASSERT_EQUAL(CAN_NODE_OUT_OF_RANGE, ask(OP(FAULT_RECORD), 0, 318).result);
    TEST_ASSERT_EQUAL(CAN_NODE_OUT_OF_RANGE, ask(OP(FAULT_RECORD), 0, -1).result);
    TEST_ASSERT_EQUAL(CAN_NODE_DONE, ask(OP(CLEAR_RECORD), 0, 0).result);
    TEST_ASSERT_EQUAL(CAN_NODE_NOTHING_TO_SEND, ask(OP(FAULT_RECORD), 0, 0).result);
}

static void test_freeze_frame_without_a_fault_is_nothing_to_send(void) {
    TEST_ASSERT_EQUAL(CAN_NODE_NOTHING_TO_SEND, ask(OP(FREEZE_FRAME), 0, 0).result);
}

// CRC-32 by the published rule, bit by bit, over the words' bytes.
static uint32_t crc32_of(const quiesce_params_t *of) {
    uint32_t crc = UINT32_MAX;
    for (uint32_t i = 0; i < QUIESCE_PARAM_COUNT; i++) {
        int32_t value = 0;
        (void)quiesce_param_get(of, i, &value);
        for (uint32_t bit = 0; bit < 32; bit++) {
            const uint32_t out_bit = (crc ^ (uint32_t)value >> bit) & 1u;
            crc = crc >> 1 ^ (out_bit != 0u ? 0xEDB88320u : 0u);
        }
    }
    return ~crc;
}

static void test_hash_is_of_the_parameters_in_effect(void) {
    TEST_ASSERT_EQUAL_HEX32(crc32_of(&params), can_node_param_hash(&params));
    TEST_ASSERT_EQUAL_HEX32(crc32_of(&params), node.param_hash);
    params.slew_mA_s = 1;
    can_node_use_params(&node, NULL, &params);
    TEST_ASSERT_EQUAL_HEX32(crc32_of(&params), node.param_hash);
}

// A store that never says how it went does not keep the service busy.
static void test_a_save_without_an_answer_has_failed_after_two_seconds(void) {
    struct quiesce_can_service_reply_t reply;
    request(OP(SAVE), 0, 0, 5);
    for (uint32_t i = 0; i < 1999; i++) {
        TEST_ASSERT_FALSE(next_reply(&reply));
        TEST_ASSERT_EQUAL(CAN_NODE_SAVE, can_node_task(&node));
    }
    TEST_ASSERT_TRUE(next_reply(&reply));
    TEST_ASSERT_EQUAL_UINT8(OP(SAVE), reply.operation);
    TEST_ASSERT_EQUAL_UINT8(5, reply.alive);
    TEST_ASSERT_EQUAL(CAN_NODE_STORE_FAILED, reply.result);
    TEST_ASSERT_EQUAL(CAN_NODE_NOTHING, can_node_task(&node));
    can_node_answer(&node, CAN_NODE_DONE, 0); // late
    TEST_ASSERT_EQUAL(CAN_NODE_DONE, ask(OP(READ), 0, 0).result);
    request(OP(SAVE), 0, 0, 6);
    for (uint32_t i = 0; i < 1500; i++) {
        TEST_ASSERT_FALSE(next_reply(&reply));
    }
    can_node_answer(&node, CAN_NODE_DONE, 0);
    TEST_ASSERT_EQUAL(CAN_NODE_DONE, reply_soon().result);
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(test_every_parameter_is_read);
    RUN_TEST(test_every_parameter_is_staged_within_its_range_only);
    RUN_TEST(test_staged_values_are_not_in_effect);
    RUN_TEST(test_apply_is_the_applications_task);
    RUN_TEST(test_refused_apply_names_the_parameter_and_keeps_what_is_staged);
    RUN_TEST(test_apply_with_nothing_staged_does_nothing);
    RUN_TEST(test_save_is_the_applications_task);
    RUN_TEST(test_answer_without_a_task_does_nothing);
    RUN_TEST(test_second_request_is_busy_and_a_third_gets_no_answer);
    RUN_TEST(test_replies_keep_their_distance);
    RUN_TEST(test_stream_takes_a_bounded_time);
    RUN_TEST(test_unknown_operations_are_refused);
    RUN_TEST(test_record_without_a_fault_is_nothing_to_send);
    RUN_TEST(test_record_is_sent_by_pages_and_cleared);
    RUN_TEST(test_freeze_frame_without_a_fault_is_nothing_to_send);
    RUN_TEST(test_hash_is_of_the_parameters_in_effect);
    RUN_TEST(test_a_save_without_an_answer_has_failed_after_two_seconds);
    return UNITY_END();
}
