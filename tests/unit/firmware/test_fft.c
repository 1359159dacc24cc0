// The transform against its definition, its slices, and the limits of its numbers.
#include "fft.h"
#include "test_signal.h"
#include "trig.h"
#include "unity.h"

#define LARGEST ((1 << 29) - 1)

static fft_t fft;

void setUp(void) {
    fft_init(&fft, FFT_MAX_LOG2);
}
void tearDown(void) {}

static uint32_t points(void) {
    return 1u << fft.points_log2;
}

static void work_all(void) {
    int32_t credit = INT32_MAX;
    TEST_ASSERT_TRUE(fft_work(&fft, &credit));
    TEST_ASSERT_EQUAL_UINT32(fft_cost(&fft), (uint32_t)(INT32_MAX - credit));
}

static void transform(void) {
    fft_start(&fft);
    work_all();
}

// Bin k of what the ring holds by its definition, with a window from base/trig: um/s2, to 1.
static fft_bin_t direct_bin(uint32_t k) {
    int64_t re = 0;
    int64_t im = 0;
    const uint32_t turn = 1u << (32u - fft.points_log2);
    for (uint32_t n = 0; n < points(); n++) {
        const uint32_t at = (fft.newest + FFT_RING - (points() - 1u) + n) % FFT_RING;
        const int64_t x = (int64_t)fft.sample[at] - fft.mean_um_s2;
        const int64_t hann_q30 = ((INT64_C(1) << 30) - sincos_q30(n * turn).cos) / 2;
        const int64_t windowed = (x * hann_q30) >> 30;
        const sincos_t angle = sincos_q30(n * k * turn);
        re += (windowed * angle.cos) >> 20;
        im -= (windowed * angle.sin) >> 20;
    }
    const uint32_t shift = 10u + fft.points_log2 - 2u;
    return (fft_bin_t){(int32_t)(re >> shift), (int32_t)(im >> shift)};
}

static void assert_bins_are_direct_ones(int32_t tolerance_um_s2) {
    for (uint32_t k = 1; k <= FFT_LAST_BIN; k++) {
        const fft_bin_t expected = direct_bin(k);
        TEST_ASSERT_INT32_WITHIN(tolerance_um_s2, expected.re, fft.bin[k].re);
        TEST_ASSERT_INT32_WITHIN(tolerance_um_s2, expected.im, fft.bin[k].im);
    }
}

static void test_noise_of_any_size_is_transformed_as_defined(void) {
    for (uint32_t log2 = FFT_MAX_LOG2 - 1u; log2 <= FFT_MAX_LOG2; log2++) {
        for (uint32_t down = 0; down < 24; down += 3) {
            uint32_t seed = 7 + down;
            fft_init(&fft, log2);
            for (uint32_t i = 0; i < 3000; i++) {
                fft_push(&fft, signal_noise(&seed, LARGEST) >> down);
            }
            transform();
            assert_bins_are_direct_ones(2 + (LARGEST >> down >> 23));
        }
    }
}

// The largest that there can be, in phase with a bin: nothing overflows (the sanitizers look on).
static void test_full_scale_square_waves_do_not_overflow(void) {
    static const uint32_t bins[] = {1, 2, 3, 8, 16, 31, 32, 33, 51, 52};
    for (uint32_t i = 0; i < sizeof bins / sizeof bins[0]; i++) {
        fft_init(&fft, FFT_MAX_LOG2);
        for (uint32_t n = 0; n < points(); n++) {
            fft_push(&fft, (bins[i] * n << 22 >> 31) != 0 ? LARGEST : -LARGEST);
        }
        transform();
        assert_bins_are_direct_ones(2 + (LARGEST >> 23));
        const fft_bin_t bin = fft.bin[bins[i]];
        const int64_t square = (int64_t)bin.re * bin.re + (int64_t)bin.im * bin.im;
        TEST_ASSERT_TRUE(square > (int64_t)LARGEST * LARGEST); // 4 / pi of it
    }
}

static void test_constant_of_full_scale_leaves_no_trace(void) {
    for (uint32_t n = 0; n < 2000; n++) {
        fft_push(&fft, LARGEST);
    }
    transform();
    for (uint32_t k = 1; k <= FFT_LAST_BIN; k++) {
        TEST_ASSERT_INT32_WITHIN(1, 0, fft.bin[k].re);
        TEST_ASSERT_INT32_WITHIN(1, 0, fft.bin[k].im);
    }
}

// Right after a spike of full scale on silence: the mean is tiny, the spike fills the block.
static void test_spike_is_flat(void) {
    for (uint32_t n = 0; n < points(); n++) {
        fft_push(&fft, n == points() / 2u ? LARGEST : 0);
    }
    transform();
    assert_bins_are_direct_ones(2 + (LARGEST >> 23));
    for (uint32_t k = 2; k <= FFT_LAST_BIN; k++) {
        TEST_ASSERT_INT32_WITHIN(100, k % 2u == 0 ? LARGEST / 256 : -LARGEST / 256, fft.bin[k].re);
    }
}

static void test_bin_of_a_tone_has_its_amplitude_and_its_phase_at_the_middle(void) {
    const uint32_t phase = 0x23456789u; // at the middle
    for (uint32_t k = 3; k <= FFT_LAST_BIN; k += 7) {
        for (uint32_t n = 0; n < points(); n++) {
            fft_push(&fft, signal_cosine(1000000, phase + (n - points() / 2u) * (k << 22)));
        }
        transform();
        const int32_t sign = k % 2u == 0 ? 1 : -1;
        TEST_ASSERT_INT32_WITHIN(3, signal_cosine(1000000, phase), sign * fft.bin[k].re);
        TEST_ASSERT_INT32_WITHIN(3, signal_cosine(1000000, phase - (1u << 30)),
                                 sign * fft.bin[k].im);
    }
}

static void test_slices_and_later_samples_change_nothing(void) {
    uint32_t seed = 3;
    for (uint32_t n = 0; n < 1500; n++) {
        fft_push(&fft, signal_noise(&seed, 3000000));
    }
    transform();
    static fft_t whole;
    whole = fft;
    static const int32_t slices[] = {100, 333, 2901, 4000};
    for (uint32_t i = 0; i < sizeof slices / sizeof slices[0]; i++) {
        fft = whole;
        int32_t credit = 0;
        uint32_t later = 0;
        fft_start(&fft);
        do {
            credit += slices[i];
            if (later < FFT_ROOM) {
                fft_push(&fft, LARGEST);
                later++;
            }
        } while (!fft_work(&fft, &credit));
        TEST_ASSERT_EQUAL_MEMORY(whole.bin + 1, fft.bin + 1, FFT_LAST_BIN * sizeof fft.bin[0]);
    }
}

static void test_without_work_or_credit_nothing_finishes(void) {
    int32_t credit = INT32_MAX;
    TEST_ASSERT_FALSE(fft_work(&fft, &credit));
    TEST_ASSERT_EQUAL_INT32(INT32_MAX, credit);
    fft_start(&fft);
    credit = 0;
    TEST_ASSERT_FALSE(fft_work(&fft, &credit));
    TEST_ASSERT_EQUAL_INT32(0, credit);
    credit = -5;
    TEST_ASSERT_FALSE(fft_work(&fft, &credit));
    TEST_ASSERT_EQUAL_INT32(-5, credit);
    work_all();
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(test_noise_of_any_size_is_transformed_as_defined);
    RUN_TEST(test_full_scale_square_waves_do_not_overflow);
    RUN_TEST(test_constant_of_full_scale_leaves_no_trace);
    RUN_TEST(test_spike_is_flat);
    RUN_TEST(test_bin_of_a_tone_has_its_amplitude_and_its_phase_at_the_middle);
    RUN_TEST(test_slices_and_later_samples_change_nothing);
    RUN_TEST(test_without_work_or_credit_nothing_finishes);
    return UNITY_END();
}
