#include "displacement.h"
#include "unity.h"

static displacement_t displacement;

void setUp(void) {
    displacement_reset(&displacement);
}
void tearDown(void) {}

// - (fundamental cos + third cos), from the exact cosine.
static int64_t expected_nm(int32_t fundamental, int32_t third, uint32_t third_turn, uint32_t turn) {
    const int64_t sum_q30 = (int64_t)fundamental * sincos_q30(turn).cos +
                            (int64_t)third * sincos_q30(3u * turn + third_turn).cos;
    return -(sum_q30 / (1 << 30));
}

static void run_search(void) {
    for (uint32_t i = 0; i < HARMONIC_SPAN_POINTS / 2; i++) {
        displacement_step(&displacement, 0);
    }
}

static void test_half_peak_to_peak_against_every_point_of_the_cycle(void) {
    static const int32_t thirds[] = {0, 3000, 111111, 400000, 1000000, 3000000};
    const int32_t fundamental = 1000000;
    for (uint32_t t = 0; t < sizeof thirds / sizeof thirds[0]; t++) {
        for (uint32_t p = 0; p < 11; p++) {
            const uint32_t third_turn = p * 390451573u;
            displacement_load(&displacement, fundamental, thirds[t], third_turn);
            run_search();
            int64_t low = 0;
            int64_t high = 0;
            for (uint32_t i = 0; i < 4096; i++) {
                const int64_t x = expected_nm(fundamental, thirds[t], third_turn, i << 20);
                low = x < low ? x : low;
                high = x > high ? x : high;
            }
            const int32_t brute = (int32_t)((high - low) / 2);
            const int32_t linear = (fundamental + thirds[t]) / 13000 + 2; // of the cosine
            const int32_t missed = fundamental / 200 + thirds[t] / 1000 * 11;
            TEST_ASSERT_LESS_OR_EQUAL_INT32(brute + linear, displacement.half_peak_to_peak_nm);
            TEST_ASSERT_GREATER_OR_EQUAL_INT32(brute - missed - linear - 11,
                                               displacement.half_peak_to_peak_nm);
        }
    }
}

static void test_the_last_search_stands_until_the_next_has_finished(void) {
    displacement_load(&displacement, 1000000, 0, 0);
    for (uint32_t i = 0; i < HARMONIC_SPAN_POINTS / 2; i++) {
        TEST_ASSERT_EQUAL_INT32(0, displacement.half_peak_to_peak_nm);
        displacement_step(&displacement, 0);
    }
    TEST_ASSERT_INT32_WITHIN(1, 1000000, displacement.half_peak_to_peak_nm);
    displacement_load(&displacement, 2000, 0, 0);
    displacement_step(&displacement, 0);
    TEST_ASSERT_INT32_WITHIN(1, 1000000, displacement.half_peak_to_peak_nm);
    run_search();
    TEST_ASSERT_INT32_WITHIN(1, 2000, displacement.half_peak_to_peak_nm);
    displacement_reset(&displacement);
    TEST_ASSERT_EQUAL_INT32(0, displacement.half_peak_to_peak_nm);
    TEST_ASSERT_EQUAL_INT32(0, displacement_step(&displacement, 0));
}

static void test_instantaneous_value_opposes_the_acceleration(void) {
    displacement_load(&displacement, 1000000, 0, 0);
    TEST_ASSERT_INT32_WITHIN(1, -1000000, displacement_step(&displacement, 0));
    TEST_ASSERT_INT32_WITHIN(1, 0, displacement_step(&displacement, 0x40000000u));
    TEST_ASSERT_INT32_WITHIN(1, 1000000, displacement_step(&displacement, 0x80000000u));
    const uint32_t third_turn = 0x12345678u;
    displacement_load(&displacement, 1000000, 300000, third_turn);
    for (uint32_t i = 0; i < 5000; i++) {
        const uint32_t turn = i * 0x9E3779B9u;
        TEST_ASSERT_INT32_WITHIN(100, expected_nm(1000000, 300000, third_turn, turn),
                                 displacement_step(&displacement, turn));
    }
}

static void test_saturates(void) {
    displacement_load(&displacement, INT32_MAX, INT32_MAX, 0);
    run_search();
    TEST_ASSERT_EQUAL_INT32(INT32_MAX, displacement.half_peak_to_peak_nm);
    TEST_ASSERT_EQUAL_INT32(-INT32_MAX, displacement_step(&displacement, 0));
    TEST_ASSERT_EQUAL_INT32(INT32_MAX, displacement_step(&displacement, 0x80000000u));
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(test_half_peak_to_peak_against_every_point_of_the_cycle);
    RUN_TEST(test_the_last_search_stands_until_the_next_has_finished);
    RUN_TEST(test_instantaneous_value_opposes_the_acceleration);
    RUN_TEST(test_saturates);
    return UNITY_END();
}
