#include "fixq.h"
#include "test_signal.h"
#include "unity.h"

void setUp(void) {}
void tearDown(void) {}

static void test_division_by_16_bit_is_that_of_64_bit(void) {
    const uint32_t divisors[] = {1, 2, 3, 5, 7, 255, 256, 2000, 32767, 32768, 65534, 65535};
    const uint64_t dividends[] = {
        0, 1, 65535, 65536, UINT32_MAX, UINT64_C(1) << 32, UINT64_C(1) << 63, UINT64_MAX};
    uint32_t seed = 5;
    for (uint32_t i = 0; i < sizeof divisors / sizeof *divisors; i++) {
        for (uint32_t k = 0; k < sizeof dividends / sizeof *dividends; k++) {
            const uint64_t product = dividends[k] / divisors[i] * divisors[i];
            TEST_ASSERT_TRUE(dividends[k] / divisors[i] == div_u64_u16(dividends[k], divisors[i]));
            TEST_ASSERT_TRUE(product / divisors[i] == div_u64_u16(product, divisors[i]));
            TEST_ASSERT_TRUE((product - 1u) / divisors[i] ==
                             div_u64_u16(product - 1u, divisors[i]));
        }
    }
    for (uint32_t i = 0; i < 20000; i++) {
        const uint64_t high = (uint32_t)signal_noise(&seed, INT32_MAX);
        const uint64_t value = (high << 32 | (uint32_t)signal_noise(&seed, INT32_MAX)) >> (i % 64u);
        const uint32_t divisor = 1u + (uint32_t)signal_noise(&seed, INT32_MAX) % UINT16_MAX;
        TEST_ASSERT_TRUE(value / divisor == div_u64_u16(value, divisor));
    }
}

static void test_isqrt_is_the_floor_of_the_root(void) {
    uint32_t seed = 1;
    for (int i = 0; i < 2000; i++) {
        const uint64_t high = (uint32_t)signal_noise(&seed, INT32_MAX);
        const uint64_t value = (high << 32 | (uint32_t)signal_noise(&seed, INT32_MAX)) >> (i % 64);
        const uint64_t root = isqrt_u64(value);
        TEST_ASSERT_TRUE(root * root <= value);
        TEST_ASSERT_TRUE(root == UINT32_MAX || (root + 1) * (root + 1) > value);
        TEST_ASSERT_EQUAL_UINT32(isqrt_u64((uint32_t)value), isqrt_u32((uint32_t)value));
    }
    TEST_ASSERT_EQUAL_UINT32(UINT32_MAX, isqrt_u64(UINT64_MAX));
    TEST_ASSERT_EQUAL_UINT32(0, isqrt_u64(0));
    TEST_ASSERT_EQUAL_UINT32(65535, isqrt_u32(UINT32_MAX));
}

static void test_fast_root_keeps_fifteen_bits(void) {
    for (uint64_t value = 1; value < (UINT64_C(1) << 61); value = value * 3 + 1) {
        const uint64_t exact = isqrt_u64(value);
        const uint64_t fast = sqrt_fast_u64(value);
        TEST_ASSERT_TRUE(fast <= exact);
        TEST_ASSERT_TRUE(exact - fast <= (exact >> 15) + 1);
    }
    TEST_ASSERT_EQUAL_UINT32(0, sqrt_fast_u64(0));
}

static void test_log2_at_powers_of_two_and_between(void) {
    for (uint32_t bit = 0; bit < 64; bit++) {
        TEST_ASSERT_EQUAL_UINT32(bit << 8, log2_q8_u64(UINT64_C(1) << bit));
    }
    // The eight bits after the leading one, wherever it stands.
    for (uint32_t bit = 0; bit < 64; bit++) {
        const uint64_t value = UINT64_C(0xB5C3A1D2F4E60817) >> bit;
        const uint32_t fraction = (uint32_t)((value << bit) >> 55) & 0xFFu;
        TEST_ASSERT_EQUAL_UINT32((63u - bit) << 8 | fraction, log2_q8_u64(value));
    }
    TEST_ASSERT_EQUAL_UINT32((1u << 8) | 128u, log2_q8_u64(3));
    TEST_ASSERT_EQUAL_UINT32(0, log2_q8_u64(0));
    TEST_ASSERT_EQUAL_UINT32((63u << 8) | 255u, log2_q8_u64(UINT64_MAX));
}

static void test_clamps_and_signs_at_their_edges(void) {
    TEST_ASSERT_EQUAL_INT32(-3, clamp_i32(-4, -3, 5));
    TEST_ASSERT_EQUAL_INT32(5, clamp_i32(6, -3, 5));
    TEST_ASSERT_EQUAL_INT32(4, clamp_i32(4, -3, 5));
    TEST_ASSERT_EQUAL_INT32(INT32_MAX, abs_i32(INT32_MIN));
    TEST_ASSERT_EQUAL_INT32(7, abs_i32(-7));
    TEST_ASSERT_EQUAL_INT32(-1, sign_i64(INT64_MIN));
    TEST_ASSERT_EQUAL_INT32(0, sign_i64(0));
    TEST_ASSERT_EQUAL_INT32(1, sign_i64(INT64_MAX));
    TEST_ASSERT_EQUAL_UINT32(UINT32_MAX, increment_sat_u32(UINT32_MAX));
}

static void test_scale_applies_a_ratio_and_saturates(void) {
    const scale_t scale = scale_from_ratio(57751, 1000);
    const scale_t large = scale_from_ratio(1000000000, 1000);
    const scale_t small = scale_from_ratio(1, 1000);
    TEST_ASSERT_EQUAL_INT32(57751, scale_apply(&scale, 1000, INT32_MAX));
    TEST_ASSERT_INT32_WITHIN(1, -57751000, scale_apply(&scale, -1000000, INT32_MAX));
    TEST_ASSERT_EQUAL_INT32(500, scale_apply(&scale, 1000, 500));
    TEST_ASSERT_EQUAL_INT32(-500, scale_apply(&scale, -1000, 500));
    TEST_ASSERT_EQUAL_INT32(1000000000, scale_apply(&large, 1000, INT32_MAX));
    TEST_ASSERT_INT32_WITHIN(1, 8388, scale_apply(&small, 8388607, INT32_MAX));
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(test_division_by_16_bit_is_that_of_64_bit);
    RUN_TEST(test_isqrt_is_the_floor_of_the_root);
    RUN_TEST(test_fast_root_keeps_fifteen_bits);
    RUN_TEST(test_log2_at_powers_of_two_and_between);
    RUN_TEST(test_clamps_and_signs_at_their_edges);
    RUN_TEST(test_scale_applies_a_ratio_and_saturates);
    return UNITY_END();
}
