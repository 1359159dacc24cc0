// Whether an image is whole: sealed, not yet sealed, damaged anywhere.
#include "image_info.h"
#include "unity.h"

#include <string.h>

#define BYTES 1000u

static uint8_t image[BYTES + SHA256_BYTES];
static const image_info_t info = {.begin = image, .seal = image + BYTES};

void setUp(void) {
    for (uint32_t i = 0; i < BYTES; i++) {
        image[i] = (uint8_t)(37u * i + (i >> 8));
    }
    sha256(image, BYTES, image + BYTES);
}

void tearDown(void) {}

static void test_a_sealed_image_is_whole(void) {
    TEST_ASSERT_EQUAL(IMAGE_WHOLE, image_state(&info));
}

static void test_any_bit_that_changes_breaks_it(void) {
    for (uint32_t i = 0; i < sizeof image; i++) {
        image[i] ^= (uint8_t)(1u << i % 8u);
        TEST_ASSERT_EQUAL(IMAGE_BROKEN, image_state(&info));
        image[i] ^= (uint8_t)(1u << i % 8u);
    }
}

static void test_all_ones_are_no_seal(void) {
    memset(image + BYTES, 0xFF, SHA256_BYTES);
    TEST_ASSERT_EQUAL(IMAGE_UNSEALED, image_state(&info));
    image[BYTES + SHA256_BYTES - 1u] = 0xFE;
    TEST_ASSERT_EQUAL(IMAGE_BROKEN, image_state(&info));
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(test_a_sealed_image_is_whole);
    RUN_TEST(test_any_bit_that_changes_breaks_it);
    RUN_TEST(test_all_ones_are_no_seal);
    return UNITY_END();
}
