// Spectrum and tracker together, wired as the controller wires them.
#include "spectrum.h"
#include "test_signal.h"
#include "tracker.h"
#include "unity.h"

static spectrum_t spectrum;
static tracker_t tracker;
static uint32_t rate_Hz;

static void start(uint32_t tick_rate_Hz) {
    rate_Hz = tick_rate_Hz;
    spectrum_init(&spectrum, rate_Hz);
    tracker_init(&tracker, &(tracker_cfg_t){
                               .band_low_mHz = 1000,
                               .band_high_mHz = 50000,
                               .min_accel_um_s2 = 10000,
                               .snr_dB = 15,
                               .rate_uHz = SPECTRUM_RATE_Hz * 1000000u,
                               .points_log2 = SPECTRUM_POINTS_LOG2,
                               .window_rounds = SPECTRUM_POINTS,
                           });
}

void setUp(void) {
    start(1000);
}
void tearDown(void) {}

static void step(int32_t accel_um_s2) {
    const spectrum_span_t span = spectrum_step(&spectrum, accel_um_s2);
    tracker_read(&tracker, spectrum.power, span.first, span.end);
    if (span.is_round_end) {
        tracker_end_round(&tracker, spectrum.power);
    }
    tracker_tick(&tracker, true);
}

typedef struct {
    int32_t amp_um_s2;
    uint32_t freq_mHz;
} tone_t;

static void feed(const tone_t *tones, uint32_t count, int32_t noise_um_s2, uint32_t ticks) {
    uint32_t seed = 3;
    for (uint32_t i = 0; i < ticks; i++) {
        int32_t sum = noise_um_s2 == 0 ? 0 : signal_noise(&seed, noise_um_s2);
        for (uint32_t k = 0; k < count; k++) {
            sum += signal_sine(tones[k].amp_um_s2, tones[k].freq_mHz, i, rate_Hz);
        }
        step(sum);
    }
}

static void assert_dominant(uint32_t freq_mHz, int32_t tolerance_uHz) {
    TEST_ASSERT_TRUE(tracker.is_valid);
    TEST_ASSERT_INT32_WITHIN(tolerance_uHz, (int32_t)freq_mHz * 1000, tracker.dominant.freq_uHz);
}

static void test_tone_across_the_band_at_every_rate(void) {
    static const uint32_t rates[] = {500, 1000, 2000, 4000};
    static const uint32_t freqs_mHz[] = {2200, 3700, 5000, 7321, 10000, 15000, 20000, 33300, 49000};
    for (uint32_t r = 0; r < 4; r++) {
        for (uint32_t f = 0; f < sizeof freqs_mHz / sizeof freqs_mHz[0]; f++) {
            start(rates[r]);
            feed(&(tone_t){300000, freqs_mHz[f]}, 1, 0, 3 * rates[r] / 2);
            // The image at negative frequency is what limits few cycles.
            assert_dominant(freqs_mHz[f], freqs_mHz[f] < 4000 ? 25000 : 2500);
            TEST_ASSERT_INT32_WITHIN(3600, 300000, tracker.dominant.amp_um_s2);
        }
    }
}

static void test_silence_and_small_vibration_are_never_valid(void) {
    feed(NULL, 0, 0, 3000);
    TEST_ASSERT_FALSE(tracker.is_valid);
    start(1000);
    feed(&(tone_t){5000, 8000}, 1, 0, 3000);
    TEST_ASSERT_FALSE(tracker.is_valid);
    TEST_ASSERT_EQUAL_UINT32(UINT32_MAX, tracker.age_ticks);
}

static void test_noise_alone_is_not_a_frequency(void) {
    uint32_t seed = 11;
    for (uint32_t i = 0; i < 60000; i++) {
        step(signal_noise(&seed, 2000000)); // peaks pass min_accel, not the noise floor
        TEST_ASSERT_FALSE(tracker.is_valid);
    }
}

static void test_needs_a_full_window_before_it_is_valid(void) {
    feed(&(tone_t){300000, 10000}, 1, 5000, 1020);
    TEST_ASSERT_FALSE(tracker.is_valid);
    feed(&(tone_t){300000, 10000}, 1, 5000, 40);
    TEST_ASSERT_TRUE(tracker.is_valid);
    TEST_ASSERT_EQUAL_UINT32(0, tracker.age_ticks);
}

static void test_stronger_third_harmonic_does_not_win(void) {
    feed((tone_t[]){{50000, 5000}, {90000, 15000}}, 2, 8000, 2000);
    assert_dominant(5000, 20000);
    TEST_ASSERT_INT32_WITHIN(20000, 15000000, tracker.peak[0].freq_uHz);
    TEST_ASSERT_INT32_WITHIN(20000, 5000000, tracker.peak[1].freq_uHz);
    TEST_ASSERT_EQUAL_INT32(0, tracker.peak[2].freq_uHz);
}

static void test_of_unrelated_tones_the_larger_displacement_wins(void) {
    feed((tone_t[]){{400000, 17300}, {400000, 31000}}, 2, 8000, 2000);
    assert_dominant(17300, 10000);
    start(1000);
    feed((tone_t[]){{100000, 17300}, {400000, 31000}}, 2, 8000, 2000);
    assert_dominant(31000, 10000);
}

static void test_drift_below_the_band_is_ignored(void) {
    feed((tone_t[]){{300000, 300}, {200000, 12000}}, 2, 5000, 4000);
    assert_dominant(12000, 10000);
}

static void test_band_limits_bind(void) {
    tracker.cfg.band_low_mHz = 8000;
    tracker.cfg.band_high_mHz = 18000;
    feed((tone_t[]){{300000, 5000}, {200000, 12000}}, 2, 5000, 2000);
    assert_dominant(12000, 10000);
    start(1000);
    tracker.cfg.band_low_mHz = 8000;
    tracker.cfg.band_high_mHz = 18000;
    feed((tone_t[]){{300000, 5000}, {200000, 25000}}, 2, 5000, 2000);
    TEST_ASSERT_FALSE(tracker.is_valid);
}

static void test_frequency_step_arrives_within_a_window(void) {
    feed(&(tone_t){600000, 10000}, 1, 5000, 2000);
    assert_dominant(10000, 5000);
    feed(&(tone_t){230000, 20000}, 1, 5000, 1100);
    assert_dominant(20000, 20000);
}

static void test_lost_input_invalidates_at_once_and_until_the_window_is_new(void) {
    feed(&(tone_t){300000, 10000}, 1, 5000, 2000);
    tracker_tick(&tracker, false);
    TEST_ASSERT_FALSE(tracker.is_valid);
    TEST_ASSERT_EQUAL_UINT32(1, tracker.age_ticks);
    feed(&(tone_t){300000, 10000}, 1, 5000, 1020);
    TEST_ASSERT_FALSE(tracker.is_valid);
    feed(&(tone_t){300000, 10000}, 1, 5000, 100);
    TEST_ASSERT_TRUE(tracker.is_valid);
}

// After any history the bins equal a sum over the ring: nothing drifts.
static void test_bins_stay_exact(void) {
    uint32_t seed = 5;
    for (uint32_t i = 0; i < 40003; i++) {
        step(signal_noise(&seed, 500000000));
    }
    while (spectrum.next_bin != SPECTRUM_BINS) {
        step(0);
    }
    for (uint32_t i = 0; i < 8000; i++) {
        step(0);
    }
    for (uint32_t k = 0; k < SPECTRUM_BINS; k++) {
        TEST_ASSERT_TRUE(spectrum.bin[k].re == 0);
        TEST_ASSERT_TRUE(spectrum.bin[k].im == 0);
    }
}

// A tick works off at most its share of the bins, and every round is complete.
static void test_slices_cover_every_round_evenly(void) {
    for (uint32_t rate = 500; rate <= 4000; rate *= 2) {
        start(rate);
        uint32_t expected = 1;
        uint32_t rounds = 0;
        for (uint32_t i = 0; i < rate; i++) {
            const spectrum_span_t span = spectrum_step(&spectrum, (int32_t)i);
            if (span.end == 0) {
                continue;
            }
            TEST_ASSERT_EQUAL_UINT32(expected, span.first);
            TEST_ASSERT_TRUE(span.end - span.first <= spectrum.slice_bins);
            expected = span.is_round_end ? 1 : span.end;
            if (span.is_round_end) {
                TEST_ASSERT_EQUAL_UINT32(SPECTRUM_BINS - 1, span.end);
                rounds++;
            }
        }
        TEST_ASSERT_UINT32_WITHIN(1, SPECTRUM_RATE_Hz, rounds);
    }
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(test_tone_across_the_band_at_every_rate);
    RUN_TEST(test_silence_and_small_vibration_are_never_valid);
    RUN_TEST(test_noise_alone_is_not_a_frequency);
    RUN_TEST(test_needs_a_full_window_before_it_is_valid);
    RUN_TEST(test_stronger_third_harmonic_does_not_win);
    RUN_TEST(test_of_unrelated_tones_the_larger_displacement_wins);
    RUN_TEST(test_drift_below_the_band_is_ignored);
    RUN_TEST(test_band_limits_bind);
    RUN_TEST(test_frequency_step_arrives_within_a_window);
    RUN_TEST(test_lost_input_invalidates_at_once_and_until_the_window_is_new);
    RUN_TEST(test_bins_stay_exact);
    RUN_TEST(test_slices_cover_every_round_evenly);
    return UNITY_END();
}
