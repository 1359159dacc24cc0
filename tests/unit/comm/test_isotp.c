// Two ends of ISO-TP on a line that the test carries frame by frame, and frames as the standard has
// them, byte for byte.
#include "isotp.h"
#include "unity.h"

#include <string.h>

#define MOST 9000u
#define ROOM 8300u

typedef uint8_t frame_t[ISOTP_FRAME_BYTES];

static isotp_t sender;
static isotp_t receiver;
static uint8_t message[MOST];
static uint8_t received[MOST];
static uint32_t parts;

void setUp(void) {
    sender = (isotp_t){0};
    receiver = (isotp_t){0};
    memset(received, 0, sizeof received);
    parts = 0;
    for (uint32_t i = 0; i < MOST; i++) {
        message[i] = (uint8_t)(i * 31u + i / 256u);
    }
}

void tearDown(void) {}

static uint8_t byte_of(const void *context, uint32_t at) {
    return ((const uint8_t *)context)[at];
}

static void hand_over(const frame_t frame) {
    const isotp_part_t part = isotp_take(&receiver, frame, ROOM);
    TEST_ASSERT_LESS_OR_EQUAL_UINT32(ROOM, part.at + part.count);
    if (part.count > 0u) {
        memcpy(&received[part.at], part.bytes, part.count);
        parts++;
    }
}

// A millisecond; frames of the sender numbered from 0 on: lost is not handed over, twice is twice.
typedef struct {
    uint32_t number, lost, twice;
} line_t;

static void pass_ms(line_t *line) {
    frame_t frame;
    if (isotp_tick(&sender, 1, byte_of, message, frame)) {
        const uint32_t number = line->number++;
        for (uint32_t k = number == line->lost ? 1u : 0u; k < (number == line->twice ? 2u : 1u);
             k++) {
            hand_over(frame);
        }
    }
    if (isotp_tick(&receiver, 1, byte_of, message, frame)) {
        (void)isotp_take(&sender, frame, 0);
    }
}

#define NEVER UINT32_MAX

static uint32_t carry(uint32_t length, line_t *line) {
    uint32_t ms = 0;
    isotp_send(&sender, length);
    while (!isotp_is_idle(&sender) || !isotp_is_idle(&receiver)) {
        pass_ms(line);
        TEST_ASSERT_LESS_THAN_UINT32(60000, ++ms);
    }
    return ms;
}

static void test_messages_of_all_lengths_come_whole(void) {
    for (uint32_t length = 8; length <= ROOM; length += length < 300u ? 1u : 397u) {
        line_t line = {0, NEVER, NEVER};
        memset(received, 0, sizeof received);
        carry(length, &line);
        TEST_ASSERT_TRUE(isotp_is_whole(&receiver));
        TEST_ASSERT_EQUAL_MEMORY(message, received, length);
    }
}

static void test_4_kB_take_a_second_and_a_half_at_the_most(void) {
    line_t line = {0, NEVER, NEVER};
    const uint32_t ms = carry(4096u + 16u, &line);
    TEST_ASSERT_LESS_THAN_UINT32(1500, ms);
    TEST_ASSERT_EQUAL_UINT32(1u + (4112u - 2u + 6u) / 7u,
                             line.number); // the long first frame has 2
}

static void test_frames_are_those_of_the_standard(void) {
    frame_t frame;
    const frame_t first = {0x10, 0x14, 0, 31, 62, 93, 124, 155};
    const frame_t flow = {0x30, 0, 0, 0xAA, 0xAA, 0xAA, 0xAA, 0xAA};
    isotp_send(&sender, 20);
    TEST_ASSERT_TRUE(isotp_tick(&sender, 1, byte_of, message, frame));
    TEST_ASSERT_EQUAL_HEX8_ARRAY(first, frame, 8);
    TEST_ASSERT_FALSE(isotp_tick(&sender, 1, byte_of, message, frame));
    (void)isotp_take(&sender, flow, 0);
    TEST_ASSERT_TRUE(isotp_tick(&sender, 1, byte_of, message, frame));
    TEST_ASSERT_EQUAL_HEX8(0x21, frame[0]);
    TEST_ASSERT_FALSE(isotp_tick(&sender, 1, byte_of, message, frame)); // 2 ms at the least
    TEST_ASSERT_TRUE(isotp_tick(&sender, 1, byte_of, message, frame));
    TEST_ASSERT_EQUAL_HEX8(0x22, frame[0]);
    TEST_ASSERT_EQUAL_HEX8(message[19], frame[7]);
    TEST_ASSERT_TRUE(isotp_is_idle(&sender));

    const frame_t long_first = {0x10, 0, 0, 0, 0x10, 0x10, 1, 2};
    const frame_t clear = {0x30, ISOTP_BLOCK, ISOTP_GAP_MS, 0xCC, 0xCC, 0xCC, 0xCC, 0xCC};
    hand_over(long_first);
    TEST_ASSERT_EQUAL_UINT32(0x1010, receiver.length);
    TEST_ASSERT_TRUE(isotp_tick(&receiver, 1, byte_of, message, frame));
    TEST_ASSERT_EQUAL_HEX8_ARRAY(clear, frame, 8);
}

static void test_a_lost_frame_gives_up_the_message(void) {
    const uint32_t length = 1000;
    for (uint32_t lost = 0; lost < 143u; lost++) {
        line_t line = {0, lost, NEVER};
        receiver = (isotp_t){0};
        carry(length, &line);
        TEST_ASSERT_FALSE(isotp_is_whole(&receiver));
        line = (line_t){0, NEVER, NEVER};
        carry(length, &line); // and the next one comes whole
        TEST_ASSERT_TRUE(isotp_is_whole(&receiver));
        TEST_ASSERT_EQUAL_MEMORY(message, received, length);
    }
}

static void test_a_frame_that_comes_twice_gives_up_the_message(void) {
    for (uint32_t twice = 1; twice < 142u; twice++) {
        line_t line = {0, NEVER, twice};
        carry(1000, &line);
        TEST_ASSERT_FALSE(isotp_is_whole(&receiver));
    }
    line_t line = {0, NEVER, 0}; // the first frame begins anew
    carry(1000, &line);
    TEST_ASSERT_TRUE(isotp_is_whole(&receiver));
}

static void test_silence_gives_up_on_either_side(void) {
    frame_t frame;
    const frame_t first = {0x10, 0x40, 1, 2, 3, 4, 5, 6};
    hand_over(first);
    TEST_ASSERT_TRUE(isotp_tick(&receiver, 0, byte_of, message, frame));
    for (uint32_t ms = 0; ms < ISOTP_PATIENCE_MS; ms++) {
        TEST_ASSERT_EQUAL(ISOTP_RECEIVING, receiver.state);
        TEST_ASSERT_FALSE(isotp_tick(&receiver, 1, byte_of, message, frame));
    }
    TEST_ASSERT_TRUE(isotp_is_idle(&receiver));
    isotp_send(&sender, 100);
    TEST_ASSERT_TRUE(isotp_tick(&sender, 0, byte_of, message, frame));
    TEST_ASSERT_FALSE(isotp_tick(&sender, ISOTP_PATIENCE_MS, byte_of, message, frame));
    TEST_ASSERT_TRUE(isotp_is_idle(&sender));
}

static void test_what_is_too_long_is_told(void) {
    frame_t frame;
    const frame_t huge = {0x10, 0, 0xFF, 0xFF, 0xFF, 0xFF, 0, 0};
    hand_over(huge);
    TEST_ASSERT_EQUAL_UINT32(0, parts);
    TEST_ASSERT_TRUE(isotp_tick(&receiver, 1, byte_of, message, frame));
    TEST_ASSERT_EQUAL_HEX8(0x32, frame[0]);
    TEST_ASSERT_TRUE(isotp_is_idle(&receiver));
    isotp_send(&sender, 100);
    (void)isotp_tick(&sender, 1, byte_of, message, frame);
    const frame_t overflow = {0x32, 0, 0, 0, 0, 0, 0, 0};
    (void)isotp_take(&sender, overflow, 0);
    TEST_ASSERT_TRUE(isotp_is_idle(&sender));
}

static void test_the_other_side_may_ask_to_wait_and_sets_the_pace(void) {
    frame_t frame;
    const frame_t wait = {0x31, 0, 0, 0, 0, 0, 0, 0};
    const frame_t slow = {0x30, 2, 20, 0, 0, 0, 0, 0};
    isotp_send(&sender, 100);
    (void)isotp_tick(&sender, 1, byte_of, message, frame);
    for (uint32_t i = 0; i < 5; i++) {
        TEST_ASSERT_FALSE(isotp_tick(&sender, ISOTP_PATIENCE_MS - 1u, byte_of, message, frame));
        (void)isotp_take(&sender, wait, 0);
    }
    (void)isotp_take(&sender, slow, 0);
    TEST_ASSERT_TRUE(isotp_tick(&sender, 1, byte_of, message, frame));
    for (uint32_t ms = 0; ms < 19u; ms++) {
        TEST_ASSERT_FALSE(isotp_tick(&sender, 1, byte_of, message, frame));
    }
    TEST_ASSERT_TRUE(isotp_tick(&sender, 1, byte_of, message, frame));
    TEST_ASSERT_EQUAL(ISOTP_AWAITING, sender.state); // two frames a block
    const frame_t reserved = {0x30, 0, 0x80, 0, 0, 0, 0, 0};
    (void)isotp_take(&sender, reserved, 0);
    TEST_ASSERT_EQUAL_UINT32(127, sender.gap_ms);
}

// Whatever comes, nothing is beyond the room, and a good message still gets through.
static void test_noise_does_no_harm(void) {
    uint32_t seed = 7;
    frame_t frame;
    for (uint32_t i = 0; i < 200000u; i++) {
        for (uint32_t k = 0; k < ISOTP_FRAME_BYTES; k++) {
            seed = seed * 1664525u + 1013904223u;
            frame[k] = (uint8_t)(seed >> 24);
        }
        frame[0] = (uint8_t)(frame[0] & 0x3Fu);
        hand_over(frame);
        (void)isotp_tick(&receiver, seed & 1u, byte_of, message, frame);
    }
    line_t line = {0, NEVER, NEVER};
    carry(5000, &line);
    TEST_ASSERT_TRUE(isotp_is_whole(&receiver));
    TEST_ASSERT_EQUAL_MEMORY(message, received, 5000);
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(test_messages_of_all_lengths_come_whole);
    RUN_TEST(test_4_kB_take_a_second_and_a_half_at_the_most);
    RUN_TEST(test_frames_are_those_of_the_standard);
    RUN_TEST(test_a_lost_frame_gives_up_the_message);
    RUN_TEST(test_a_frame_that_comes_twice_gives_up_the_message);
    RUN_TEST(test_silence_gives_up_on_either_side);
    RUN_TEST(test_what_is_too_long_is_told);
    RUN_TEST(test_the_other_side_may_ask_to_wait_and_sets_the_pace);
    RUN_TEST(test_noise_does_no_harm);
    return UNITY_END();
}
