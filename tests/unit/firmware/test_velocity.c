#include "unity.h"
#include "velocity.h"

enum { POWERS = 64 };

static velocity_t velocity;
static uint64_t power[POWERS];

void setUp(void) {
    for (uint32_t k = 0; k < POWERS; k++) {
        power[k] = 0;
    }
    velocity_init(&velocity, 1000, 50000);
}
void tearDown(void) {}

// A tone in the middle of bin k as the Hann window shows it.
static void put_tone(uint32_t k, int64_t amp_um_s2) {
    power[k] = (uint64_t)(amp_um_s2 * amp_um_s2);
    power[k - 1u] = power[k] / 4u;
    power[k + 1u] = power[k] / 4u;
}

static int32_t measure(uint32_t points_log2) {
    velocity_start(&velocity, points_log2);
    velocity_read(&velocity, power, 1, 8);
    velocity_read(&velocity, power, 8, 9);
    velocity_read(&velocity, power, 9, POWERS);
    velocity_end(&velocity);
    return velocity.rms_um_s;
}

// amp / (2 pi f sqrt 2), f in the middle of bin k.
static int64_t rms_of_tone(int64_t amp_um_s2, uint32_t k, uint32_t points_log2) {
    return (amp_um_s2 << points_log2) * 1125395 / (INT64_C(2500000000) * k);
}

static void test_tone_within_the_stated_error(void) {
    static const struct {
        uint32_t k;
        int32_t per_mille;
    } high[] = {{3, 100}, {6, 20}, {10, 10}, {20, 10}, {45, 10}};
    for (int64_t amp = 1000; amp <= 500000000; amp = amp * 5 + 7) {
        for (uint32_t i = 0; i < sizeof high / sizeof high[0]; i++) {
            setUp();
            put_tone(high[i].k, amp);
            const int32_t expected = (int32_t)rms_of_tone(amp, high[i].k, 8);
            const int32_t got = measure(8);
            TEST_ASSERT_GREATER_OR_EQUAL_INT32(expected - expected / 2000 - 2, got);
            TEST_ASSERT_LESS_OR_EQUAL_INT32(
                expected + (int32_t)((int64_t)expected * high[i].per_mille / 1000) + 1, got);
        }
    }
}

static void test_every_window_length(void) {
    for (uint32_t points_log2 = 5; points_log2 <= 8; points_log2++) {
        const uint32_t k = 3u << (points_log2 - 5u); // 23.4375 Hz
        setUp();
        put_tone(k, 3000000);
        const int32_t expected = (int32_t)rms_of_tone(3000000, k, points_log2);
        TEST_ASSERT_INT32_WITHIN(expected / 10, expected, measure(points_log2));
    }
}

static void test_two_tones_add_in_squares(void) {
    put_tone(20, 3000000);
    const int64_t one = measure(8);
    setUp();
    put_tone(40, 8000000);
    const int64_t other = measure(8);
    put_tone(20, 3000000);
    const int64_t both = measure(8);
    const int64_t square = one * one + other * other;
    TEST_ASSERT_TRUE((both + 4) * (both + 4) > square);
    TEST_ASSERT_TRUE((both - 4) * (both - 4) < square);
}

static void test_powers_outside_the_band_are_ignored(void) {
    velocity_init(&velocity, 5000, 40000);
    put_tone(20, 3000000);
    const int32_t alone = measure(8);
    TEST_ASSERT_GREATER_THAN_INT32(1000, alone);
    for (uint32_t k = 0; k < POWERS; k++) {
        if (k <= 4 || k >= 42) { // 3.9 Hz and 41.0 Hz
            power[k] = UINT64_C(1) << 60;
        }
    }
    TEST_ASSERT_EQUAL_INT32(alone, measure(8));
    power[5] = UINT64_C(1) << 50; // 4.88 Hz: the edge belongs to its bin
    TEST_ASSERT_GREATER_THAN_INT32(2 * alone, measure(8));
    power[5] = 0;
    power[41] = UINT64_C(1) << 56; // 40.04 Hz
    TEST_ASSERT_GREATER_THAN_INT32(2 * alone, measure(8));
}

static void test_silence_is_zero_and_the_last_result_stays_until_the_end(void) {
    TEST_ASSERT_EQUAL_INT32(0, measure(8));
    put_tone(20, 3000000);
    const int32_t before = measure(8);
    velocity_start(&velocity, 8);
    TEST_ASSERT_EQUAL_INT32(before, velocity.rms_um_s);
    velocity_end(&velocity);
    TEST_ASSERT_EQUAL_INT32(0, velocity.rms_um_s);
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(test_tone_within_the_stated_error);
    RUN_TEST(test_every_window_length);
    RUN_TEST(test_two_tones_add_in_squares);
    RUN_TEST(test_powers_outside_the_band_are_ignored);
    RUN_TEST(test_silence_is_zero_and_the_last_result_stays_until_the_end);
    return UNITY_END();
}
