#include "rms.h"
#include "test_signal.h"
#include "unity.h"

static rms_t rms;

void setUp(void) {}
void tearDown(void) {}

static int32_t feed_sine(int32_t amplitude, uint32_t ticks, uint32_t rate_Hz) {
    int32_t value = 0;
    for (uint32_t i = 0; i < ticks; i++) {
        value = rms_step(&rms, signal_sine(amplitude, 10000, i, rate_Hz));
    }
    return value;
}

static void test_sine_at_every_rate_and_level(void) {
    const uint32_t rates[] = {500, 1000, 2000, 4000};
    for (uint32_t i = 0; i < 4; i++) {
        for (int32_t amplitude = 1000; amplitude <= 100000000; amplitude *= 10) {
            rms_init(&rms, rates[i], 500);
            const int64_t expected = (int64_t)amplitude * 70711 / 100000;
            TEST_ASSERT_INT32_WITHIN(expected / 1000 + 6, expected,
                                     feed_sine(amplitude, rates[i], rates[i]));
        }
    }
}

static void test_full_scale_does_not_overflow_in_the_longest_window(void) {
    rms_init(&rms, 4000, 4000);
    int32_t value = 0;
    for (uint32_t i = 0; i < 20000; i++) {
        value = rms_step(&rms, i % 2 ? 500000000 : -500000000);
    }
    TEST_ASSERT_INT32_WITHIN(1000, 500000000, value);
}

static void test_window_forgets_exactly(void) {
    rms_init(&rms, 1000, 100);
    feed_sine(500000000, 100000, 1000);
    int32_t value = 0;
    for (uint32_t i = 0; i < 110; i++) {
        value = rms_step(&rms, 0);
    }
    TEST_ASSERT_EQUAL_INT32(0, value);
}

// What add and remove leave behind after a long run is what a fresh sum of the ring gives.
static void test_total_never_drifts_from_a_fresh_sum(void) {
    uint32_t seed = 7;
    rms_init(&rms, 1000, 500);
    for (uint32_t i = 0; i < 300000; i++) {
        rms_step(&rms, signal_noise(&seed, 500000000) >> (i / 1000 % 28));
    }
    uint64_t fresh = 0;
    for (uint32_t i = 0; i < rms.window_blocks; i++) {
        fresh += rms.block[i];
    }
    TEST_ASSERT_TRUE(fresh == rms.total);
}

static void test_reset_forgets_everything(void) {
    rms_init(&rms, 1000, 500);
    feed_sine(400000000, 3000, 1000);
    rms_reset(&rms);
    TEST_ASSERT_INT32_WITHIN(1000, 707110, feed_sine(1000000, 700, 1000));
}

static void test_before_the_first_block_it_is_zero(void) {
    rms_init(&rms, 1000, 500);
    for (uint32_t i = 0; i < 9; i++) {
        TEST_ASSERT_EQUAL_INT32(0, rms_step(&rms, 1000000));
    }
    TEST_ASSERT_INT32_WITHIN(6, 1000000, rms_step(&rms, 1000000));
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(test_sine_at_every_rate_and_level);
    RUN_TEST(test_full_scale_does_not_overflow_in_the_longest_window);
    RUN_TEST(test_window_forgets_exactly);
    RUN_TEST(test_total_never_drifts_from_a_fresh_sum);
    RUN_TEST(test_reset_forgets_everything);
    RUN_TEST(test_before_the_first_block_it_is_zero);
    return UNITY_END();
}
