// The windowed RMS over 10^8 samples: what it has added and taken away leaves nothing behind.
#include "rms.h"

#include "test_signal.h"
#include "unity.h"

enum {
    SAMPLES = 100000000,
    CHECKS = 500,
    WINDOW_ms = 4000,
    RATE_Hz = 4000,
    WINDOW_SAMPLES = WINDOW_ms / 1000 * RATE_Hz,
    BLOCK_SAMPLES = RATE_Hz / 100,
    LIMIT_um_s2 = 500000000,
};

static rms_t sliding;
static rms_t fresh;
static int32_t recent[WINDOW_SAMPLES]; // a ring

void setUp(void) {}
void tearDown(void) {}

// Noise whose span changes every 1000 samples, from full scale down to nothing.
static int32_t sample_at(uint32_t i, uint32_t *seed) {
    return signal_noise(seed, LIMIT_um_s2 >> (i / 1000u * 7u % 30u));
}

// Over the samples of the ring, oldest first; `end` is where the next one would go.
static void sum_up_afresh(uint32_t end) {
    rms_init(&fresh, RATE_Hz, WINDOW_ms);
    for (uint32_t i = 0; i < WINDOW_SAMPLES; i++) {
        (void)rms_step(&fresh, recent[(end + i) % WINDOW_SAMPLES]);
    }
}

// floor(sqrt(mean square)) without the blocks' scaling: the sum in two words.
static uint32_t exact_rms_um_s2(void) {
    uint64_t high = 0;
    uint64_t low = 0;
    for (uint32_t i = 0; i < WINDOW_SAMPLES; i++) {
        const uint64_t square = (uint64_t)((int64_t)recent[i] * recent[i]);
        high += square >> 32;
        low += square & UINT32_MAX;
    }
    const uint64_t mean_low = ((high % WINDOW_SAMPLES << 32) + low) / WINDOW_SAMPLES;
    return isqrt_u64((high / WINDOW_SAMPLES << 32) + mean_low);
}

static void test_rms_over_1e8_samples_equals_a_fresh_sum(void) {
    uint32_t seed = 3;
    rms_init(&sliding, RATE_Hz, WINDOW_ms);
    for (uint32_t i = 0; i < SAMPLES; i++) {
        recent[i % WINDOW_SAMPLES] = sample_at(i, &seed);
        const int32_t rms_um_s2 = rms_step(&sliding, recent[i % WINDOW_SAMPLES]);
        const uint32_t done = i + 1u;
        if (done % (SAMPLES / CHECKS) == 0) {
            TEST_ASSERT_EQUAL_UINT32(0, done % BLOCK_SAMPLES);
            sum_up_afresh(done % WINDOW_SAMPLES);
            TEST_ASSERT_TRUE(fresh.total == sliding.total);
            TEST_ASSERT_EQUAL_INT32(fresh.rms_um_s2, rms_um_s2);
            TEST_ASSERT_UINT32_WITHIN(16, exact_rms_um_s2(), (uint32_t)rms_um_s2);
        }
    }
}

// Every square at its largest, every block and the total at theirs.
static void test_rms_of_full_scale_fits_its_words(void) {
    rms_init(&sliding, RATE_Hz, WINDOW_ms);
    for (uint32_t i = 0; i < 3u * WINDOW_SAMPLES; i++) {
        const int32_t rms_um_s2 = rms_step(&sliding, i % 2u ? LIMIT_um_s2 : -LIMIT_um_s2);
        TEST_ASSERT_INT32_WITHIN(16, i + 1u < BLOCK_SAMPLES ? 0 : LIMIT_um_s2, rms_um_s2);
    }
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(test_rms_over_1e8_samples_equals_a_fresh_sum);
    RUN_TEST(test_rms_of_full_scale_fits_its_words);
    return UNITY_END();
}
