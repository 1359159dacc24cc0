#include "decimate.h"

#include "test_signal.h"
#include "unity.h"

enum { RATES = 4 };

static const uint32_t rates_Hz[RATES] = {500, 1000, 2000, 4000};
static decimate_t decimate;

void setUp(void) {}
void tearDown(void) {}

static uint32_t start(uint32_t rate) {
    decimate_init(&decimate, rates_Hz[rate], DECIMATE_RATE_Hz);
    return rates_Hz[rate] / DECIMATE_RATE_Hz;
}

static void test_a_sample_every_ratio_ticks(void) {
    for (uint32_t r = 0; r < RATES; r++) {
        const uint32_t ratio = start(r);
        for (uint32_t i = 1; i <= 1000; i++) {
            int32_t value = 0;
            TEST_ASSERT_EQUAL(i % ratio == 0, decimate_step(&decimate, &value));
        }
    }
}

static void test_constant_passes_exactly(void) {
    static const int32_t constants[] = {
        0, 1, -1, 9806650, -123456789, DECIMATE_LIMIT, -DECIMATE_LIMIT};
    for (uint32_t r = 0; r < RATES; r++) {
        for (uint32_t c = 0; c < sizeof constants / sizeof constants[0]; c++) {
            const uint32_t ratio = start(r);
            for (uint32_t i = 0; i < 40 * ratio; i++) {
                int32_t value = constants[c];
                // The memory is twice the delay.
                if (decimate_step(&decimate, &value) && i >= 2u * DECIMATE_DELAY(ratio)) {
                    TEST_ASSERT_EQUAL_INT32(constants[c], value);
                }
            }
        }
    }
}

// An output sample's share of an impulse `at` ticks before it, for every `at`.
static void measure_response(uint32_t rate, int32_t *response, uint32_t length) {
    for (uint32_t at = 0; at < length; at++) {
        const uint32_t ratio = start(rate);
        const uint32_t read = (length / ratio + 2u) * ratio - 1u;
        for (uint32_t i = 0; i <= read; i++) {
            int32_t value = i == read - at ? DECIMATE_LIMIT : 0;
            if (decimate_step(&decimate, &value) && i == read) {
                response[at] = value;
            }
        }
    }
}

// Symmetric about its middle, so that the delay is the same at every frequency; nothing beyond it.
static void test_impulse_is_delayed_by_the_stated_ticks_at_every_rate(void) {
    enum { LONGEST = 2 * DECIMATE_DELAY(16) + 4 };
    static int32_t response[LONGEST];
    for (uint32_t r = 0; r < RATES; r++) {
        const uint32_t delay = DECIMATE_DELAY(rates_Hz[r] / DECIMATE_RATE_Hz);
        measure_response(r, response, 2u * delay + 4u);
        int32_t sum = 0;
        for (uint32_t i = 0; i <= 2u * delay; i++) {
            TEST_ASSERT_INT32_WITHIN(4, response[2u * delay - i], response[i]);
            TEST_ASSERT_TRUE(response[i] <= response[delay]);
            sum += response[i];
        }
        TEST_ASSERT_NOT_EQUAL(0, response[2u * delay]);
        for (uint32_t i = 1; i < 4; i++) {
            TEST_ASSERT_EQUAL_INT32(0, response[2u * delay + i]);
        }
        TEST_ASSERT_INT32_WITHIN(200, DECIMATE_LIMIT, sum);
    }
}

// Largest output for a tone, once the memory is filled.
static int32_t peak_of_tone(uint32_t rate, int32_t amplitude, uint32_t freq_mHz) {
    const uint32_t ratio = start(rate);
    int32_t peak = 0;
    for (uint32_t i = 0; i < 500 * ratio; i++) {
        int32_t value = signal_sine(amplitude, freq_mHz, i, rates_Hz[rate]);
        if (decimate_step(&decimate, &value) && i > 2u * DECIMATE_DELAY(ratio)) {
            peak = abs_i32(value) > peak ? abs_i32(value) : peak;
        }
    }
    return peak;
}

// 62 dB: 1 / 1259.
static void test_nothing_above_200_Hz_reaches_the_band(void) {
    static const uint32_t freqs_mHz[] = {200000, 201300,  213700,  230000,  249000, 251000,
                                         270100, 299900,  450100,  549900,  701000, 799000,
                                         951000, 1049000, 1230000, 1799000, 1951000};
    for (uint32_t r = 0; r < RATES; r++) {
        for (uint32_t f = 0; f < sizeof freqs_mHz / sizeof freqs_mHz[0]; f++) {
            if (freqs_mHz[f] < 500u * rates_Hz[r]) {
                TEST_ASSERT_LESS_THAN_INT32(100000000 / 1259,
                                            peak_of_tone(r, 100000000, freqs_mHz[f]));
            }
        }
    }
}

// 0.0063 dB a stage: 7.3e-4 of the amplitude, and 1e-4 for the signal.
static void test_band_passes_flat(void) {
    static const uint32_t freqs_mHz[] = {1010, 5030, 10070, 20090, 35110, 49970};
    for (uint32_t r = 0; r < RATES; r++) {
        for (uint32_t f = 0; f < sizeof freqs_mHz / sizeof freqs_mHz[0]; f++) {
            const int32_t most = 730 * ((int32_t)r + 1) + 100;
            TEST_ASSERT_INT32_WITHIN(most, 1000000, peak_of_tone(r, 1000000, freqs_mHz[f]));
        }
    }
}

// A step from one limit to the other would overshoot.
static void test_output_saturates(void) {
    for (uint32_t r = 0; r < RATES; r++) {
        const uint32_t ratio = start(r);
        int32_t peak = 0;
        for (uint32_t i = 0; i < 100 * ratio; i++) {
            int32_t value = i < 50 * ratio ? -DECIMATE_LIMIT : DECIMATE_LIMIT;
            if (decimate_step(&decimate, &value)) {
                TEST_ASSERT_INT32_WITHIN(DECIMATE_LIMIT, 0, value);
                peak = value > peak ? value : peak;
            }
        }
        TEST_ASSERT_EQUAL_INT32(DECIMATE_LIMIT, peak);
        start(r);
        for (uint32_t i = 0; i < 50 * ratio; i++) {
            int32_t value = i / 3 % 2 ? INT32_MAX : INT32_MIN;
            if (decimate_step(&decimate, &value)) {
                TEST_ASSERT_INT32_WITHIN(DECIMATE_LIMIT, 0, value);
            }
        }
    }
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(test_a_sample_every_ratio_ticks);
    RUN_TEST(test_constant_passes_exactly);
    RUN_TEST(test_impulse_is_delayed_by_the_stated_ticks_at_every_rate);
    RUN_TEST(test_nothing_above_200_Hz_reaches_the_band);
    RUN_TEST(test_band_passes_flat);
    RUN_TEST(test_output_saturates);
    return UNITY_END();
}
