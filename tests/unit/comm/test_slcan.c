#include "slcan.h"
#include "unity.h"

#include <string.h>

static slcan_decoder_t decoder;
static can_frame_t frame;

void setUp(void) {
    slcan_decoder_init(&decoder);
    memset(&frame, 0xEE, sizeof frame);
}

void tearDown(void) {}

/// Feeds the text; returns how many frames it completed. `frame` holds the last one.
static uint32_t feed(const char *text) {
    uint32_t frames = 0;
    for (const char *c = text; *c != '\0'; c++) {
        frames += slcan_decode(&decoder, (uint8_t)*c, &frame) ? 1u : 0u;
    }
    return frames;
}

static uint32_t next_random(uint32_t *state) {
    *state = *state * 1664525u + 1013904223u;
    return *state >> 8;
}

static can_frame_t random_frame(uint32_t *state) {
    can_frame_t out = {
        .is_extended = (next_random(state) & 1u) != 0,
        .is_remote = (next_random(state) & 1u) != 0,
        .length = (uint8_t)(next_random(state) % 9u),
    };
    const uint32_t id = next_random(state) << 8 | (next_random(state) & 0xFFu);
    out.id = id & (out.is_extended ? CAN_MAX_EXTENDED_ID : CAN_MAX_STANDARD_ID);
    for (uint32_t i = 0; !out.is_remote && i < out.length; i++) {
        out.data[i] = (uint8_t)next_random(state);
    }
    return out;
}

static void assert_same(const can_frame_t *expected, const can_frame_t *actual) {
    TEST_ASSERT_EQUAL_HEX32(expected->id, actual->id);
    TEST_ASSERT_EQUAL_UINT8(expected->length, actual->length);
    TEST_ASSERT_EQUAL(expected->is_extended, actual->is_extended);
    TEST_ASSERT_EQUAL(expected->is_remote, actual->is_remote);
    TEST_ASSERT_EQUAL_HEX8_ARRAY(expected->data, actual->data, CAN_MAX_BYTES);
}

static void test_standard_frame_is_decoded(void) {
    const uint8_t data[CAN_MAX_BYTES] = {0x01, 0xAB, 0xcd};
    TEST_ASSERT_EQUAL_UINT32(1, feed("t6033"
                                     "01ABcd\r"));
    TEST_ASSERT_EQUAL_HEX32(0x603, frame.id);
    TEST_ASSERT_EQUAL_UINT8(3, frame.length);
    TEST_ASSERT_FALSE(frame.is_extended);
    TEST_ASSERT_FALSE(frame.is_remote);
    TEST_ASSERT_EQUAL_HEX8_ARRAY(data, frame.data, CAN_MAX_BYTES);
}

static void test_every_kind_of_frame_is_decoded(void) {
    TEST_ASSERT_EQUAL_UINT32(1, feed("T1FFFFFFF0\r"));
    TEST_ASSERT_EQUAL_HEX32(CAN_MAX_EXTENDED_ID, frame.id);
    TEST_ASSERT_TRUE(frame.is_extended);
    TEST_ASSERT_EQUAL_UINT32(1, feed("r7FF8\n"));
    TEST_ASSERT_TRUE(frame.is_remote);
    TEST_ASSERT_EQUAL_UINT8(8, frame.length);
    TEST_ASSERT_EQUAL_UINT32(1, feed("R000000010\r"));
    TEST_ASSERT_TRUE(frame.is_remote && frame.is_extended);
    TEST_ASSERT_EQUAL_UINT32(0, decoder.malformed_count + decoder.ignored_count);
}

static void test_malformed_lines_are_counted_and_leave_the_frame_alone(void) {
    static const char *const lines[] = {
        "t\r",       "t60\r",     "t603\r",        "t6039000000000000000000\r",
        "t80000\r",  "t6032AB\r", "t6032ABCDE\r",  "t6032AG00\r",
        "tx030\r",   "t603x\r",   "T200000000\r",  "T1234567\r",
        "r6031AB\r", "t6031 A\r", "t603100\x80\r", "R1FFFFFFF9\r",
    };
    const can_frame_t untouched = frame;
    for (size_t i = 0; i < sizeof lines / sizeof lines[0]; i++) {
        TEST_ASSERT_EQUAL_UINT32_MESSAGE(0, feed(lines[i]), lines[i]);
        TEST_ASSERT_EQUAL_UINT32_MESSAGE(i + 1, decoder.malformed_count, lines[i]);
    }
    TEST_ASSERT_EQUAL_MEMORY(&untouched, &frame, sizeof frame);
    TEST_ASSERT_EQUAL_UINT32(0, decoder.ignored_count);
}

static void test_adapter_commands_are_ignored(void) {
    TEST_ASSERT_EQUAL_UINT32(0, feed("C\rS6\rO\rV\rN\r"));
    TEST_ASSERT_EQUAL_UINT32(5, decoder.ignored_count);
    TEST_ASSERT_EQUAL_UINT32(0, decoder.malformed_count);
}

static void test_empty_lines_count_as_nothing(void) {
    TEST_ASSERT_EQUAL_UINT32(1, feed("\r\n\r\nt6030\r\n\r"));
    TEST_ASSERT_EQUAL_UINT32(0, decoder.malformed_count + decoder.ignored_count);
}

static void test_longest_line_is_taken_and_one_more_byte_is_too_long(void) {
    TEST_ASSERT_EQUAL_UINT32(1, feed("T1ABCDEF080011223344556677\r"));
    TEST_ASSERT_EQUAL_UINT32(0, feed("T1ABCDEF0800112233445566770\r"));
    TEST_ASSERT_EQUAL_UINT32(1, decoder.malformed_count);
    TEST_ASSERT_EQUAL_UINT32(1, feed("t6030\r"));
}

static void test_endless_line_is_one_malformed_line(void) {
    for (uint32_t i = 0; i < 100000; i++) {
        TEST_ASSERT_FALSE(slcan_decode(&decoder, 't', &frame));
    }
    TEST_ASSERT_EQUAL_UINT32(1, feed("\rt6030\r"));
    TEST_ASSERT_EQUAL_UINT32(1, decoder.malformed_count);
}

static void test_encode_writes_upper_case_and_exact_length(void) {
    const can_frame_t standard = {.id = 0x60A, .length = 2, .data = {0x0F, 0xA0}};
    uint8_t out[SLCAN_MAX_BYTES + 1];
    memset(out, 0x55, sizeof out);
    TEST_ASSERT_EQUAL_UINT32(10, slcan_encode(&standard, out));
    TEST_ASSERT_EQUAL_MEMORY("t60A20FA0\r\x55", out, 11);
}

static void test_encode_refuses_what_is_no_frame(void) {
    uint8_t out[SLCAN_MAX_BYTES] = {0};
    const can_frame_t wide = {.id = 0x800};
    const can_frame_t wider = {.id = 0x20000000u, .is_extended = true};
    const can_frame_t long_frame = {.id = 1, .length = 9};
    TEST_ASSERT_EQUAL_UINT32(0, slcan_encode(&wide, out));
    TEST_ASSERT_EQUAL_UINT32(0, slcan_encode(&wider, out));
    TEST_ASSERT_EQUAL_UINT32(0, slcan_encode(&long_frame, out));
    TEST_ASSERT_EQUAL_HEX8(0, out[0]);
}

static void test_encode_then_decode_gives_the_frame_back(void) {
    uint32_t seed = 1;
    for (uint32_t round = 0; round < 3000; round++) {
        const can_frame_t sent = random_frame(&seed);
        uint8_t text[SLCAN_MAX_BYTES];
        const size_t count = slcan_encode(&sent, text);
        TEST_ASSERT_GREATER_THAN_UINT32(0, count);
        uint32_t frames = 0;
        for (size_t i = 0; i < count; i++) {
            frames += slcan_decode(&decoder, text[i], &frame) ? 1u : 0u;
        }
        TEST_ASSERT_EQUAL_UINT32(1, frames);
        assert_same(&sent, &frame);
    }
    TEST_ASSERT_EQUAL_UINT32(0, decoder.malformed_count + decoder.ignored_count);
}

static void test_a_flipped_byte_costs_at_most_that_line_and_its_neighbour(void) {
    uint32_t seed = 7;
    for (uint32_t round = 0; round < 3000; round++) {
        const can_frame_t sent = {.id = 0x603, .length = 4, .data = {1, 2, 3, 4}};
        uint8_t text[SLCAN_MAX_BYTES];
        const size_t count = slcan_encode(&sent, text);
        text[next_random(&seed) % count] ^= (uint8_t)(1u + next_random(&seed) % 255u);
        for (size_t i = 0; i < count; i++) {
            (void)slcan_decode(&decoder, text[i], &frame);
        }
        TEST_ASSERT_EQUAL_UINT32(1, feed("\rt1230\r"));
        TEST_ASSERT_EQUAL_HEX32(0x123, frame.id);
    }
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(test_standard_frame_is_decoded);
    RUN_TEST(test_every_kind_of_frame_is_decoded);
    RUN_TEST(test_malformed_lines_are_counted_and_leave_the_frame_alone);
    RUN_TEST(test_adapter_commands_are_ignored);
    RUN_TEST(test_empty_lines_count_as_nothing);
    RUN_TEST(test_longest_line_is_taken_and_one_more_byte_is_too_long);
    RUN_TEST(test_endless_line_is_one_malformed_line);
    RUN_TEST(test_encode_writes_upper_case_and_exact_length);
    RUN_TEST(test_encode_refuses_what_is_no_frame);
    RUN_TEST(test_encode_then_decode_gives_the_frame_back);
    RUN_TEST(test_a_flipped_byte_costs_at_most_that_line_and_its_neighbour);
    return UNITY_END();
}
