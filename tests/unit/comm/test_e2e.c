#include "e2e.h"
#include "unity.h"

// Counter in the upper half of byte 2, as in CurrentDemand.
static const e2e_layout_t layout = {.id = 0x123, .length = 4, .alive_bit = 20, .crc_byte = 3};

static e2e_receiver_t receiver;

void setUp(void) {
    receiver = (e2e_receiver_t){0};
}

void tearDown(void) {}

static can_frame_t make(uint8_t alive) {
    can_frame_t frame = {.id = layout.id, .length = 4, .data = {0x11, 0x22, 0x03}};
    e2e_protect(&layout, &alive, &frame);
    return frame;
}

static e2e_verdict_t check(uint8_t alive, uint32_t max_lost) {
    const can_frame_t frame = make(alive);
    return e2e_check(&receiver, &layout, max_lost, &frame);
}

// Published: CRC-8/SAE-J1850 of the characters 123456789 is 0x4B. The id carries the first two.
static void test_crc_has_the_published_check_value(void) {
    const e2e_layout_t nine = {.id = 0x3231, .length = 8, .crc_byte = 7};
    const can_frame_t frame = {.id = 0x3231, .length = 8, .data = "3456789"};
    TEST_ASSERT_EQUAL_HEX8(0x4B, e2e_crc(&nine, &frame));
}

// The same rule bit by bit.
static uint8_t crc_by_bits(const e2e_layout_t *of, const can_frame_t *frame) {
    uint8_t bytes[2 + CAN_MAX_BYTES] = {(uint8_t)of->id, (uint8_t)(of->id >> 8)};
    for (uint32_t i = 0; i < of->crc_byte; i++) {
        bytes[2u + i] = frame->data[i];
    }
    uint32_t crc = 0xFF;
    for (uint32_t bit = 0; bit < 8u * (2u + of->crc_byte); bit++) {
        const uint32_t in = (uint32_t)bytes[bit / 8u] >> (7u - bit % 8u) & 1u;
        const uint32_t out = crc >> 7;
        crc = (crc << 1 & 0xFFu) ^ ((in ^ out) != 0u ? 0x1Du : 0u);
    }
    return (uint8_t)~crc;
}

static void test_crc_equals_the_rule_bit_by_bit(void) {
    uint32_t seed = 7;
    for (uint32_t run = 0; run < 2000; run++) {
        can_frame_t frame = {.id = run};
        const e2e_layout_t any = {.id = run, .crc_byte = (uint8_t)(run % 8u)};
        for (uint32_t i = 0; i < CAN_MAX_BYTES; i++) {
            seed = seed * 1664525u + 1013904223u;
            frame.data[i] = (uint8_t)(seed >> 24);
        }
        TEST_ASSERT_EQUAL_HEX8(crc_by_bits(&any, &frame), e2e_crc(&any, &frame));
    }
}

static void test_protect_keeps_the_other_bits_and_counts_on(void) {
    uint8_t alive = 14;
    for (uint32_t i = 0; i < 4; i++) {
        can_frame_t frame = {.id = layout.id, .length = 4, .data = {0xFF, 0x00, 0xFF, 0x55}};
        const uint8_t sent = alive;
        e2e_protect(&layout, &alive, &frame);
        TEST_ASSERT_EQUAL_HEX8(0xFF, frame.data[0]);
        TEST_ASSERT_EQUAL_HEX8(0x0Fu | (uint32_t)sent << 4, frame.data[2]);
        TEST_ASSERT_EQUAL_HEX8(e2e_crc(&layout, &frame), frame.data[3]);
        TEST_ASSERT_EQUAL_UINT8((sent + 1u) % 16u, alive);
    }
}

static void test_every_single_and_double_bit_error_is_found(void) {
    const can_frame_t good = make(5);
    for (uint32_t i = 0; i < 32; i++) {
        for (uint32_t k = 0; k <= i; k++) {
            can_frame_t bad = good;
            bad.data[i / 8u] ^= (uint8_t)(1u << i % 8u);
            if (k < i) {
                bad.data[k / 8u] ^= (uint8_t)(1u << k % 8u);
            }
            TEST_ASSERT_EQUAL(E2E_WRONG_CRC, e2e_check(&receiver, &layout, 14, &bad));
        }
    }
    TEST_ASSERT_FALSE(receiver.has_alive);
}

static void test_frame_under_another_id_is_found(void) {
    const e2e_layout_t other = {.id = 0x124, .length = 4, .alive_bit = 20, .crc_byte = 3};
    const can_frame_t frame = make(0);
    TEST_ASSERT_EQUAL(E2E_WRONG_CRC, e2e_check(&receiver, &other, 14, &frame));
}

static void test_wrong_shapes_are_named_and_change_nothing(void) {
    for (uint8_t length = 0; length < 20; length++) {
        can_frame_t frame = make(1);
        frame.length = length;
        TEST_ASSERT_EQUAL(length == 4 ? E2E_OK : E2E_WRONG_SHAPE,
                          e2e_check(&receiver, &layout, 14, &frame));
    }
    can_frame_t extended = make(2);
    can_frame_t remote = make(2);
    extended.is_extended = true;
    remote.is_remote = true;
    TEST_ASSERT_EQUAL(E2E_WRONG_SHAPE, e2e_check(&receiver, &layout, 14, &extended));
    TEST_ASSERT_EQUAL(E2E_WRONG_SHAPE, e2e_check(&receiver, &layout, 14, &remote));
    TEST_ASSERT_EQUAL_UINT8(1, receiver.alive);
}

static void test_counter_goes_on_over_its_wrap(void) {
    for (uint32_t i = 0; i < 40; i++) {
        TEST_ASSERT_EQUAL(E2E_OK, check((uint8_t)(i % 16u), 0));
    }
}

static void test_every_step_of_the_counter(void) {
    for (uint32_t max_lost = 0; max_lost <= 14; max_lost++) {
        for (uint32_t from = 0; from < 16; from++) {
            for (uint32_t step = 0; step < 16; step++) {
                receiver = (e2e_receiver_t){.has_alive = true, .alive = (uint8_t)from};
                const e2e_verdict_t expected = step == 0              ? E2E_REPEATED
                                               : step <= max_lost + 1 ? E2E_OK
                                                                      : E2E_JUMPED;
                TEST_ASSERT_EQUAL(expected, check((uint8_t)((from + step) % 16u), max_lost));
            }
        }
    }
}

static void test_restarted_sender_is_accepted_from_its_second_frame_on(void) {
    TEST_ASSERT_EQUAL(E2E_OK, check(9, 2));
    TEST_ASSERT_EQUAL(E2E_JUMPED, check(0, 2));
    TEST_ASSERT_EQUAL(E2E_OK, check(1, 2));
}

static void test_any_counter_is_right_at_first_and_after_forgetting(void) {
    TEST_ASSERT_EQUAL(E2E_OK, check(9, 0));
    TEST_ASSERT_EQUAL(E2E_REPEATED, check(9, 0));
    e2e_forget(&receiver);
    TEST_ASSERT_EQUAL(E2E_OK, check(9, 0));
}

static void test_free_counter_is_not_judged(void) {
    e2e_layout_t free_layout = layout;
    free_layout.alive_is_free = true;
    const can_frame_t frame = make(3);
    for (uint32_t i = 0; i < 3; i++) {
        TEST_ASSERT_EQUAL(E2E_OK, e2e_check(&receiver, &free_layout, 0, &frame));
    }
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(test_crc_has_the_published_check_value);
    RUN_TEST(test_crc_equals_the_rule_bit_by_bit);
    RUN_TEST(test_protect_keeps_the_other_bits_and_counts_on);
    RUN_TEST(test_every_single_and_double_bit_error_is_found);
    RUN_TEST(test_frame_under_another_id_is_found);
    RUN_TEST(test_wrong_shapes_are_named_and_change_nothing);
    RUN_TEST(test_counter_goes_on_over_its_wrap);
    RUN_TEST(test_every_step_of_the_counter);
    RUN_TEST(test_restarted_sender_is_accepted_from_its_second_frame_on);
    RUN_TEST(test_any_counter_is_right_at_first_and_after_forgetting);
    RUN_TEST(test_free_counter_is_not_judged);
    return UNITY_END();
}
