#include "cosine_table.h"
#include "spectrum.h"
#include "test_signal.h"
#include "unity.h"

#define LARGEST ((1 << 29) - 1)

enum { QUARTER = COSINE_POINTS / 4, MOST_SLICES_LOG2 = 4 };

static spectrum_t spectrum;

void setUp(void) {
    spectrum_init(&spectrum, 2);
}
void tearDown(void) {}

static void feed(int32_t accel_um_s2) {
    spectrum_start_round(&spectrum, accel_um_s2);
    for (uint32_t i = 0; i < 1u << spectrum.slices_log2; i++) {
        spectrum_slice(&spectrum);
    }
}

static uint32_t bins_of(uint32_t level) {
    return spectrum_last_power(level) + 1u;
}

// Transform of what the ring holds, by its definition: angles count from ring index 0.
static spectrum_bin_t direct_bin(uint32_t level, uint32_t k) {
    const uint32_t stride = COSINE_POINTS / SPECTRUM_POINTS(level);
    spectrum_bin_t sum = {0, 0};
    for (uint32_t back = 0; back < SPECTRUM_POINTS(level); back++) {
        const uint32_t index = (spectrum.newest - back) % SPECTRUM_RING;
        const uint32_t angle = k * index * stride;
        const int64_t sample = spectrum.sample[index];
        sum.re += sample * cosine_q25[angle % COSINE_POINTS];
        sum.im -= sample * cosine_q25[(angle - QUARTER) % COSINE_POINTS];
    }
    return sum;
}

static void assert_bins_are_direct_ones(void) {
    const spectrum_bin_t *bin = spectrum.bin;
    for (uint32_t level = 0; level < SPECTRUM_LEVELS; level++) {
        for (uint32_t k = 1; k <= bins_of(level); k++, bin++) {
            const spectrum_bin_t expected = direct_bin(level, k);
            TEST_ASSERT_TRUE(expected.re == bin->re && expected.im == bin->im);
        }
    }
    TEST_ASSERT_TRUE(bin == spectrum.bin + SPECTRUM_BINS);
}

static void assert_bins_are_zero(void) {
    for (uint32_t i = 0; i < SPECTRUM_BINS; i++) {
        TEST_ASSERT_TRUE(spectrum.bin[i].re == 0 && spectrum.bin[i].im == 0);
    }
}

static void test_bins_never_drift_from_a_direct_transform(void) {
    for (uint32_t slices_log2 = 1; slices_log2 <= MOST_SLICES_LOG2; slices_log2++) {
        uint32_t seed = slices_log2;
        spectrum_init(&spectrum, slices_log2);
        for (uint32_t i = 1; i <= 20000; i++) {
            const int32_t sample = signal_noise(&seed, LARGEST) >> (i / 1000 % 20);
            feed(sample);
            TEST_ASSERT_EQUAL_INT32(sample, spectrum.sample[spectrum.newest]);
            if (i % 6661 == 0 || i == 100 || i == 20000) {
                assert_bins_are_direct_ones();
            }
        }
        for (uint32_t i = 0; i < 600; i++) {
            feed(0);
        }
        assert_bins_are_zero();
    }
}

static void test_constant_leaves_no_trace(void) {
    for (int32_t sign = -1; sign <= 1; sign += 2) {
        for (uint32_t i = 0; i < SPECTRUM_POINTS(SPECTRUM_LONGEST); i++) {
            feed(sign * LARGEST);
        }
        assert_bins_are_zero();
        for (uint32_t level = 0; level < SPECTRUM_LEVELS; level++) {
            TEST_ASSERT_EQUAL_INT32(sign * LARGEST, spectrum_mean_um_s2(&spectrum, level));
        }
    }
}

static void test_mean_of_each_window_is_its_floor(void) {
    uint32_t seed = 3;
    for (uint32_t i = 0; i < 1500; i++) {
        feed(signal_noise(&seed, LARGEST));
    }
    for (uint32_t level = 0; level < SPECTRUM_LEVELS; level++) {
        const int64_t points = SPECTRUM_POINTS(level);
        int64_t rest = -points * spectrum_mean_um_s2(&spectrum, level);
        for (uint32_t back = 0; back < SPECTRUM_POINTS(level); back++) {
            rest += spectrum.sample[(spectrum.newest - back) % SPECTRUM_RING];
        }
        TEST_ASSERT_TRUE(rest >= 0 && rest < points);
    }
}

// A tone in the middle of bin k, `sixteenths` of a turn ahead, on a constant.
static int32_t tone(int32_t amp, uint32_t level, uint32_t k, uint32_t sixteenths, uint32_t i) {
    const uint32_t angle = k * i * (COSINE_POINTS / SPECTRUM_POINTS(level)) + 16u * sixteenths;
    return (int32_t)(((int64_t)amp * cosine_q25[angle % COSINE_POINTS]) >> 25);
}

// Powers of a tone in the middle of bin k: A^2 there, A^2/4 beside, nothing else; each with the
// steps of the amplitude, one for a bin and one for each of its neighbours' halves.
static void assert_tone_powers(uint32_t level, uint32_t k, int64_t amp) {
    const int64_t steps = 3 * (256 / (int64_t)SPECTRUM_POINTS(level)) + 3;
    for (uint32_t j = 1; j <= spectrum_last_power(level); j++) {
        const uint32_t apart = j > k ? j - k : k - j;
        const int64_t expected = apart == 0 ? amp : apart == 1 ? amp / 2 : 0;
        const int64_t low = expected > steps ? expected - steps : 0;
        const int64_t high = expected + steps;
        const int64_t power = (int64_t)spectrum.power[j];
        TEST_ASSERT_TRUE(power >= low * low);
        TEST_ASSERT_TRUE(power <= 2 * high * high || apart < 2);
        TEST_ASSERT_TRUE(power <= high * high || apart >= 2);
    }
}

static void want(uint32_t level, int32_t constant_um_s2, int32_t amp, uint32_t k, uint32_t from) {
    spectrum_want_powers(&spectrum, level, constant_um_s2);
    TEST_ASSERT_FALSE(spectrum.has_powers);
    for (uint32_t round = 0; round < 3 && !spectrum.has_powers; round++) {
        feed(constant_um_s2 + tone(amp, level, k, 3, from + round));
    }
    TEST_ASSERT_TRUE(spectrum.has_powers);
}

static void test_powers_of_a_tone_on_a_constant_in_every_window(void) {
    const int32_t amp = 3000000;
    for (uint32_t slices_log2 = 1; slices_log2 <= MOST_SLICES_LOG2; slices_log2++) {
        for (uint32_t level = 0; level < SPECTRUM_LEVELS; level++) {
            for (uint32_t k = 1; k <= spectrum_last_power(level); k += 1u + level) {
                const int32_t constant = -700000 + 100000 * (int32_t)k;
                spectrum_init(&spectrum, slices_log2);
                uint32_t i = 0;
                for (; i < SPECTRUM_POINTS(level) + 37u; i++) {
                    feed(constant + tone(amp, level, k, 3, i));
                }
                want(level, constant, amp, k, i);
                assert_tone_powers(level, k, amp);
            }
        }
    }
}

// Amplitude at bin k under 1 - cos, which starts at the window's oldest sample, by its definition.
static int64_t direct_amplitude(uint32_t level, uint32_t k, int32_t constant_um_s2) {
    const uint32_t points = SPECTRUM_POINTS(level);
    const uint32_t stride = COSINE_POINTS / points;
    int64_t re = 0;
    int64_t im = 0;
    for (uint32_t n = 0; n < points; n++) {
        const uint32_t index = (spectrum.newest + 1u + n - points) % SPECTRUM_RING;
        const int64_t weight_q25 = (1 << 25) - cosine_q25[n * stride];
        const int64_t rest = spectrum.sample[index] - constant_um_s2;
        const int64_t weighted = (rest * weight_q25) >> 25;
        re += weighted * cosine_q25[k * n * stride % COSINE_POINTS];
        im += weighted * cosine_q25[(k * n * stride - QUARTER) % COSINE_POINTS];
    }
    re >>= 24 + SPECTRUM_POINTS_LOG2(level);
    im >>= 24 + SPECTRUM_POINTS_LOG2(level);
    return isqrt_u64((uint64_t)(re * re + im * im));
}

static bool is_near(uint64_t power, int64_t amplitude) {
    const int64_t low = amplitude > 30 ? amplitude - 30 : 0;
    const int64_t high = amplitude + 30;
    return power >= (uint64_t)(low * low) && power <= (uint64_t)(high * high);
}

// Each power is the direct one at the end of one of the rounds that the request took.
static void test_powers_of_noise_are_those_of_a_direct_hann_window(void) {
    const int32_t constant = 1234567;
    uint32_t seed = 17;
    for (uint32_t level = 0; level < SPECTRUM_LEVELS; level++) {
        for (uint32_t i = 0; i < 300; i++) {
            feed(constant + signal_noise(&seed, 5000000));
        }
        int64_t direct[3][SPECTRUM_MAX_POWERS] = {{0}};
        uint32_t rounds = 0;
        spectrum_want_powers(&spectrum, level, constant);
        for (; rounds < 3 && !spectrum.has_powers; rounds++) {
            feed(constant + signal_noise(&seed, 5000000));
            for (uint32_t k = 1; k <= spectrum_last_power(level); k++) {
                direct[rounds][k] = direct_amplitude(level, k, constant);
            }
        }
        TEST_ASSERT_TRUE(spectrum.has_powers);
        for (uint32_t k = 1; k <= spectrum_last_power(level); k++) {
            bool is_direct = false;
            for (uint32_t round = 0; round < rounds; round++) {
                is_direct = is_direct || is_near(spectrum.power[k], direct[round][k]);
            }
            TEST_ASSERT_TRUE(is_direct);
        }
    }
}

static void test_constant_that_is_left_in_shows_in_the_first_power(void) {
    for (uint32_t i = 0; i < 600; i++) {
        feed(1000000);
    }
    spectrum_want_powers(&spectrum, 0, 0);
    feed(1000000);
    TEST_ASSERT_TRUE(spectrum.has_powers);
    // Bin 0 counts twice the mean, half of it reaches bin 1.
    TEST_ASSERT_TRUE(spectrum.power[1] > UINT64_C(999970) * 999970);
    TEST_ASSERT_TRUE(spectrum.power[1] < UINT64_C(1000030) * 1000030);
    TEST_ASSERT_TRUE(spectrum.power[2] < 30 * 30);
}

static void test_full_scale_does_not_overflow(void) {
    for (uint32_t level = 0; level < SPECTRUM_LEVELS; level++) {
        const uint32_t k = SPECTRUM_POINTS(level) / 8u;
        spectrum_init(&spectrum, 1);
        uint32_t i = 0;
        for (; i < 700; i++) {
            feed(tone(LARGEST, level, k, 3, i));
        }
        want(level, 0, LARGEST, k, i);
        const uint64_t most = (uint64_t)LARGEST * LARGEST;
        TEST_ASSERT_TRUE(spectrum.power[k] > most - most / 1000000);
        TEST_ASSERT_TRUE(spectrum.power[k] < most + most / 1000000);
    }
}

static void test_powers_come_only_on_request_and_the_last_request_counts(void) {
    for (uint32_t i = 0; i < 300; i++) {
        feed(tone(1000000, 1, 5, 0, i));
    }
    TEST_ASSERT_FALSE(spectrum.has_powers);
    spectrum_want_powers(&spectrum, SPECTRUM_LONGEST, 0);
    feed(tone(1000000, 1, 5, 0, 300));
    TEST_ASSERT_FALSE(spectrum.has_powers);
    spectrum_want_powers(&spectrum, 1, 0);
    feed(tone(1000000, 1, 5, 0, 301));
    TEST_ASSERT_TRUE(spectrum.has_powers);
    assert_tone_powers(1, 5, 1000000);
    const uint64_t power = spectrum.power[5];
    feed(0);
    TEST_ASSERT_TRUE(power == spectrum.power[5]);
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(test_bins_never_drift_from_a_direct_transform);
    RUN_TEST(test_constant_leaves_no_trace);
    RUN_TEST(test_mean_of_each_window_is_its_floor);
    RUN_TEST(test_powers_of_a_tone_on_a_constant_in_every_window);
    RUN_TEST(test_powers_of_noise_are_those_of_a_direct_hann_window);
    RUN_TEST(test_constant_that_is_left_in_shows_in_the_first_power);
    RUN_TEST(test_full_scale_does_not_overflow);
    RUN_TEST(test_powers_come_only_on_request_and_the_last_request_counts);
    return UNITY_END();
}
