// Bytes that are an image of a board at a place, and all the ways in which they are none.
#include "image_info.h"
#include "image_place.h"
#include "sha256.h"
#include "unity.h"

#include <string.h>

#define ADDRESS 0x08004000u
#define ROOM 6000u
#define INFO_AT 452u
#define NAME_POINTER_AT 700u
#define NAME_AT 720u
#define SEAL_AT 1000u
#define BOARD "some_board"

static uint8_t bytes[ROOM];
static image_place_t place;

static void put(uint32_t at, uint32_t word) {
    for (uint32_t i = 0; i < 4u; i++) {
        bytes[at + i] = (uint8_t)(word >> (8u * i));
    }
}

static void put_info(uint32_t at, uint32_t seal_at) {
    const uint32_t words[8] = {
        IMAGE_INFO_MAGIC,  IMAGE_INFO_LAYOUT,         0x000100u,     9u, ADDRESS,
        ADDRESS + seal_at, ADDRESS + NAME_POINTER_AT, ADDRESS + 800u};
    for (uint32_t i = 0; i < 8u; i++) {
        put(at + 4u * i, words[i]);
    }
}

static void seal(uint32_t at) {
    sha256(bytes, at, &bytes[at]);
}

void setUp(void) {
    place = (image_place_t){bytes, ROOM, ADDRESS};
    for (uint32_t i = 0; i < ROOM; i++) {
        bytes[i] = (uint8_t)(29u * i + (i >> 7));
    }
    put_info(INFO_AT, SEAL_AT);
    put(NAME_POINTER_AT, ADDRESS + NAME_AT);
    memcpy(&bytes[NAME_AT], BOARD, sizeof BOARD);
    seal(SEAL_AT);
}

void tearDown(void) {}

static void assert_none_with(uint32_t at, uint32_t word) {
    put(at, word);
    seal(SEAL_AT);
    TEST_ASSERT_FALSE(image_is_in(&place, BOARD));
    setUp();
}

static void test_a_sealed_image_is_one(void) {
    TEST_ASSERT_TRUE(image_is_in(&place, BOARD));
    bytes[SEAL_AT + SHA256_BYTES] ^= 0xFFu; // behind it
    TEST_ASSERT_TRUE(image_is_in(&place, BOARD));
}

static void test_a_check_in_parts_comes_to_the_same(void) {
    image_check_t check;
    image_check_begin(&check, &place, BOARD);
    for (uint32_t i = 0; i < SEAL_AT / 64u - 1u; i++) {
        TEST_ASSERT_EQUAL(IMAGE_CHECK_BUSY, image_check_work(&check, 1));
    }
    TEST_ASSERT_EQUAL(IMAGE_CHECK_GOOD, image_check_work(&check, 1));
    bytes[500] ^= 1u;
    image_check_begin(&check, &place, BOARD);
    image_check_result_t result = IMAGE_CHECK_BUSY;
    while (result == IMAGE_CHECK_BUSY) {
        result = image_check_work(&check, 3);
    }
    TEST_ASSERT_EQUAL(IMAGE_CHECK_BAD, result);
    image_check_begin(&check, &place, "other");
    TEST_ASSERT_EQUAL(IMAGE_CHECK_BAD, image_check_work(&check, 1));
}

static void test_any_bit_that_changes_makes_it_none(void) {
    for (uint32_t i = 0; i < SEAL_AT + SHA256_BYTES; i++) {
        bytes[i] ^= (uint8_t)(1u << i % 8u);
        TEST_ASSERT_FALSE(image_is_in(&place, BOARD));
        bytes[i] ^= (uint8_t)(1u << i % 8u);
    }
}

static void test_one_for_another_board_is_none(void) {
    static const char *const others[] = {"some_boar", "some_board2", "", "other"};
    for (uint32_t i = 0; i < sizeof others / sizeof others[0]; i++) {
        TEST_ASSERT_FALSE(image_is_in(&place, others[i]));
    }
}

static void test_one_that_was_linked_for_another_place_is_none(void) {
    assert_none_with(INFO_AT + 16u, 0x08000000u);
    place.address = 0x08020000u;
    TEST_ASSERT_FALSE(image_is_in(&place, BOARD));
}

static void test_pointers_out_of_the_place_are_not_followed(void) {
    static const uint32_t wrong[] = {
        0,          ADDRESS - 1u, ADDRESS + ROOM,      ADDRESS + ROOM - 3u,
        UINT32_MAX, 0x20000000u,  ADDRESS + ROOM - 31u};
    for (uint32_t i = 0; i < sizeof wrong / sizeof wrong[0]; i++) {
        assert_none_with(INFO_AT + 20u, wrong[i]); // seal
        assert_none_with(INFO_AT + 24u, wrong[i]); // pointer to the name
        assert_none_with(NAME_POINTER_AT, wrong[i]);
    }
}

// The name would go on behind the place's end.
static void test_a_name_without_an_end_is_none(void) {
    memset(&bytes[SEAL_AT + SHA256_BYTES], 'a', ROOM - SEAL_AT - SHA256_BYTES);
    put(NAME_POINTER_AT, ADDRESS + ROOM - 2u);
    seal(SEAL_AT);
    TEST_ASSERT_FALSE(image_is_in(&place, "aaaa"));
    TEST_ASSERT_FALSE(image_is_in(&place, "aa"));
}

static void test_a_seal_of_ones_is_none(void) {
    memset(&bytes[SEAL_AT], 0xFF, SHA256_BYTES);
    TEST_ASSERT_FALSE(image_is_in(&place, BOARD));
}

static void test_an_empty_place_and_a_small_one_have_none(void) {
    memset(bytes, 0xFF, ROOM);
    TEST_ASSERT_FALSE(image_is_in(&place, BOARD));
    setUp();
    for (uint32_t count = 0; count < SEAL_AT + SHA256_BYTES; count += 4u) {
        place.count = count;
        TEST_ASSERT_FALSE(image_is_in(&place, BOARD));
    }
    place.count = SEAL_AT + SHA256_BYTES;
    TEST_ASSERT_TRUE(image_is_in(&place, BOARD));
}

static void test_what_it_says_has_to_be_in_its_beginning(void) {
    memset(&bytes[INFO_AT], 0, 32);
    put_info(4096, 5000);
    seal(5000);
    TEST_ASSERT_FALSE(image_is_in(&place, BOARD));
    put_info(4092, 5000);
    seal(5000);
    TEST_ASSERT_TRUE(image_is_in(&place, BOARD));
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(test_a_sealed_image_is_one);
    RUN_TEST(test_a_check_in_parts_comes_to_the_same);
    RUN_TEST(test_any_bit_that_changes_makes_it_none);
    RUN_TEST(test_one_for_another_board_is_none);
    RUN_TEST(test_one_that_was_linked_for_another_place_is_none);
    RUN_TEST(test_pointers_out_of_the_place_are_not_followed);
    RUN_TEST(test_a_name_without_an_end_is_none);
    RUN_TEST(test_a_seal_of_ones_is_none);
    RUN_TEST(test_an_empty_place_and_a_small_one_have_none);
    RUN_TEST(test_what_it_says_has_to_be_in_its_beginning);
    return UNITY_END();
}
