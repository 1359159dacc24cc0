#include "crc32.h"

#include "unity.h"

void setUp(void) {}
void tearDown(void) {}

// The definition, a bit at a time.
static uint32_t bitwise(const uint32_t *words, uint32_t count) {
    uint32_t crc = UINT32_MAX;
    for (uint32_t i = 0; i < 32u * count; i++) {
        const uint32_t bit = words[i / 32u] >> i % 32u & 1u;
        crc = crc >> 1 ^ (((crc ^ bit) & 1u) != 0 ? 0xEDB88320u : 0);
    }
    return ~crc;
}

// Known answers of any CRC-32, the bytes of each text in words, the first in the lowest byte.
static void test_crc32_of_known_texts(void) {
    const uint32_t digits[] = {0x34333231u, 0x38373635u}; // "1234", "5678"
    TEST_ASSERT_EQUAL_HEX32(0x9BE3E0A3u, crc32_words(digits, 1));
    TEST_ASSERT_EQUAL_HEX32(0x9AE0DAAFu, crc32_words(digits, 2));
    const uint32_t fox[] = {0x20656854u, 0x63697571u, 0x7262206Bu, 0x206E776Fu,
                            0x20786F66u, 0x706D756Au, 0x766F2073u, 0x74207265u,
                            0x6C206568u, 0x20797A61u, 0x2E676F64u};
    TEST_ASSERT_EQUAL_HEX32(0x519025E9u, crc32_words(fox, 11));
}

static void test_crc32_of_nothing_zeros_and_ones(void) {
    const uint32_t zero = 0;
    const uint32_t ones = UINT32_MAX;
    TEST_ASSERT_EQUAL_HEX32(0, crc32_words(&zero, 0));
    TEST_ASSERT_EQUAL_HEX32(0x2144DF1Cu, crc32_words(&zero, 1));
    TEST_ASSERT_EQUAL_HEX32(UINT32_MAX, crc32_words(&ones, 1));
}

static void test_crc32_is_the_remainder_of_its_polynomial(void) {
    uint32_t words[40];
    uint32_t state = 7;
    for (uint32_t length = 0; length < 40u; length++) {
        state = state * 1664525u + 1013904223u;
        words[length] = state;
        TEST_ASSERT_EQUAL_HEX32(bitwise(words, length + 1u), crc32_words(words, length + 1u));
    }
}

static void test_crc32_sees_every_single_bit_and_exchanged_words(void) {
    uint32_t words[] = {1, 2, 3, 4};
    const uint32_t good = crc32_words(words, 4);
    for (uint32_t bit = 0; bit < 128u; bit++) {
        words[bit / 32u] ^= 1u << bit % 32u;
        TEST_ASSERT_NOT_EQUAL(good, crc32_words(words, 4));
        words[bit / 32u] ^= 1u << bit % 32u;
    }
    const uint32_t exchanged[] = {1, 3, 2, 4};
    TEST_ASSERT_NOT_EQUAL(good, crc32_words(exchanged, 4));
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(test_crc32_of_known_texts);
    RUN_TEST(test_crc32_of_nothing_zeros_and_ones);
    RUN_TEST(test_crc32_is_the_remainder_of_its_polynomial);
    RUN_TEST(test_crc32_sees_every_single_bit_and_exchanged_words);
    return UNITY_END();
}
