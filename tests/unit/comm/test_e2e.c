#include "e2e.h"
#include "unity.h"

// Counter in the upper half of byte 2, as in CurrentDemand.
static const e2e_layout_t layout = {.id = 0x123, .length = 4, .alive_bit = 20, .crc_byte = 3};

void setUp(void) {}

void tearDown(void) {}

static can_frame_t make(uint8_t alive) {
    can_frame_t frame = {.id = layout.id, .length = 4, .data = {0x11, 0x22, 0x03}};
    e2e_protect(&layout, &alive, &frame);
    return frame;
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
            TEST_ASSERT_EQUAL(E2E_WRONG_CRC, e2e_check(&layout, &bad));
        }
    }
}

static void test_frame_under_another_id_is_found(void) {
    const e2e_layout_t other = {.id = 0x124, .length = 4, .alive_bit = 20, .crc_byte = 3};
    const can_frame_t frame = make(0);
    TEST_ASSERT_EQUAL(E2E_WRONG_CRC, e2e_check(&other, &frame));
}

static void test_wrong_shapes_are_named(void) {
    for (uint8_t length = 0; length < 20; length++) {
        can_frame_t frame = make(1);
        frame.length = length;
        TEST_ASSERT_EQUAL(length == 4 ? E2E_OK : E2E_WRONG_SHAPE, e2e_check(&layout, &frame));
    }
    can_frame_t extended = make(2);
    can_frame_t remote = make(2);
    extended.is_extended = true;
    remote.is_remote = true;
    TEST_ASSERT_EQUAL(E2E_WRONG_SHAPE, e2e_check(&layout, &extended));
    TEST_ASSERT_EQUAL(E2E_WRONG_SHAPE, e2e_check(&layout, &remote));
}

static void test_alive_is_read_wherever_it_lies(void) {
    for (uint32_t bit = 0; bit <= 20; bit += bit % 8u < 4u ? 1u : 4u) {
        const e2e_layout_t any = {.id = 1, .length = 4, .alive_bit = (uint8_t)bit, .crc_byte = 3};
        for (uint8_t sent = 0; sent < 16; sent++) {
            can_frame_t frame = {.id = 1, .length = 4, .data = {0xFF, 0xFF, 0xFF, 0}};
            uint8_t alive = sent;
            e2e_protect(&any, &alive, &frame);
            TEST_ASSERT_EQUAL_UINT8(sent, e2e_alive(&any, &frame));
        }
    }
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(test_crc_has_the_published_check_value);
    RUN_TEST(test_crc_equals_the_rule_bit_by_bit);
    RUN_TEST(test_protect_keeps_the_other_bits_and_counts_on);
    RUN_TEST(test_every_single_and_double_bit_error_is_found);
    RUN_TEST(test_frame_under_another_id_is_found);
    RUN_TEST(test_wrong_shapes_are_named);
    RUN_TEST(test_alive_is_read_wherever_it_lies);
    return UNITY_END();
}
