// What vibrates and how, estimated: the wired chain of decimate .. predictor.
#include "estimator.h"
#include "test_signal.h"
#include "unity.h"

static estimator_t estimator;
static uint32_t rate_Hz;
static uint32_t now; // ticks since the start; phases go on from one feed to the next
static estimator_cfg_t cfg;

static void start(uint32_t tick_rate_Hz) {
    rate_Hz = tick_rate_Hz;
    now = 0;
    cfg = (estimator_cfg_t){
        .tick_rate_Hz = rate_Hz,
        .longest_ms = 1024,
        .tracker = {.band_low_mHz = 1000,
                    .band_high_mHz = 50000,
                    .min_accel_um_s2 = 10000,
                    .snr_dB = 15},
    };
    estimator_init(&estimator, &cfg);
}

void setUp(void) {
    start(1000);
}
void tearDown(void) {}

static void step(int32_t accel_um_s2) {
    estimator_step(&estimator, &(estimator_in_t){.accel_um_s2 = accel_um_s2, .is_good = true});
}

static bool is_valid(void) {
    return estimator.known.is_valid;
}

typedef struct {
    int32_t amp_um_s2;
    uint32_t freq_mHz;
} component_t;

static void feed(const component_t *tones, uint32_t count, int32_t noise_um_s2, uint32_t ticks) {
    uint32_t seed = 3;
    for (uint32_t i = 0; i < ticks; i++, now++) {
        int32_t sum = noise_um_s2 == 0 ? 0 : signal_noise(&seed, noise_um_s2);
        for (uint32_t k = 0; k < count; k++) {
            sum += signal_sine(tones[k].amp_um_s2, tones[k].freq_mHz, now, rate_Hz);
        }
        step(sum);
    }
}

static void assert_dominant(uint32_t freq_mHz, int32_t tolerance_uHz) {
    TEST_ASSERT_TRUE(is_valid());
    TEST_ASSERT_INT32_WITHIN(tolerance_uHz, (int32_t)freq_mHz * 1000,
                             estimator.known.tone[0].freq_uHz);
}

static void test_tone_across_the_band_at_every_rate(void) {
    static const uint32_t rates[] = {500, 1000, 2000, 4000};
    static const uint32_t freqs_mHz[] = {2200, 3700, 5000, 7321, 10000, 15000, 20000, 33300, 49000};
    for (uint32_t r = 0; r < 4; r++) {
        for (uint32_t f = 0; f < sizeof freqs_mHz / sizeof freqs_mHz[0]; f++) {
            start(rates[r]);
            feed(&(component_t){300000, freqs_mHz[f]}, 1, 0, 3 * rates[r] / 2);
            assert_dominant(freqs_mHz[f], 100);
            TEST_ASSERT_INT32_WITHIN(600, 300000, estimator.known.tone[0].amp_um_s2);
        }
    }
}

static void test_silence_and_small_vibration_are_never_valid(void) {
    feed(NULL, 0, 0, 3000);
    TEST_ASSERT_FALSE(is_valid());
    start(1000);
    feed(&(component_t){5000, 8000}, 1, 0, 3000);
    TEST_ASSERT_FALSE(is_valid());
    TEST_ASSERT_EQUAL_UINT32(UINT32_MAX, estimator.known.age_ticks);
}

static void test_noise_alone_is_not_a_frequency(void) {
    uint32_t seed = 11;
    for (uint32_t i = 0; i < 60000; i++) {
        step(signal_noise(&seed, 2000000)); // peaks pass min_accel, not the noise floor
        TEST_ASSERT_FALSE(is_valid());
    }
}

static void test_needs_a_full_window_before_it_is_valid(void) {
    feed(&(component_t){300000, 10000}, 1, 5000, 1050);
    TEST_ASSERT_FALSE(is_valid());
    feed(&(component_t){300000, 10000}, 1, 5000, 74);
    TEST_ASSERT_TRUE(is_valid());
    TEST_ASSERT_EQUAL_UINT32(0, estimator.known.age_ticks);
}

// One tick in noise that leaves a component clear in the longest window only.
static void tick_in_noise(uint32_t freq_mHz) {
    static uint32_t seed = 5;
    step(signal_sine(300000, freq_mHz, now, rate_Hz) + signal_normal(&seed, 130000));
    now++;
}

static uint32_t ticks_until_valid(uint32_t freq_mHz, uint32_t most) {
    uint32_t ticks = 0;
    do {
        tick_in_noise(freq_mHz);
        ticks++;
    } while (!is_valid() && ticks < most);
    return ticks;
}

static void go_on(uint32_t freq_mHz, uint32_t ticks) {
    for (; ticks > 0; ticks--) {
        tick_in_noise(freq_mHz);
    }
    TEST_ASSERT_TRUE(is_valid());
}

// The vibration changes; until that is noticed.
static void change(uint32_t freq_mHz) {
    while (is_valid()) {
        tick_in_noise(freq_mHz);
    }
}

static void test_trust_that_does_not_last_is_given_more_slowly(void) {
    TEST_ASSERT_LESS_THAN_UINT32(1250, ticks_until_valid(9000, 5000));
    go_on(9000, 200);
    change(14000);
    TEST_ASSERT_LESS_THAN_UINT32(1250, ticks_until_valid(14000, 5000));
    go_on(14000, 200);
    change(21000);
    const uint32_t third = ticks_until_valid(21000, 5000);
    TEST_ASSERT_GREATER_THAN_UINT32(2000, third);
    TEST_ASSERT_LESS_THAN_UINT32(3000, third);
    // What lasts ends the doubt.
    go_on(21000, 2000);
    change(9000);
    TEST_ASSERT_LESS_THAN_UINT32(1250, ticks_until_valid(9000, 5000));
}

static void test_stronger_third_harmonic_does_not_win(void) {
    feed((component_t[]){{50000, 5000}, {90000, 15000}}, 2, 8000, 2000);
    assert_dominant(5000, 20000);
    TEST_ASSERT_INT32_WITHIN(20000, 15000000, estimator.known.tone[1].freq_uHz);
    TEST_ASSERT_EQUAL_INT32(0, estimator.known.tone[2].freq_uHz);
}

static void test_of_unrelated_tones_alike_the_larger_displacement_wins(void) {
    feed((component_t[]){{400000, 17300}, {400000, 31000}}, 2, 8000, 2000);
    assert_dominant(17300, 10000);
    start(1000);
    feed((component_t[]){{400000, 31000}, {360000, 17300}}, 2, 8000, 2000);
    assert_dominant(17300, 10000);
}

static void test_a_tone_with_most_of_the_energy_wins(void) {
    feed((component_t[]){{100000, 17300}, {400000, 31000}}, 2, 8000, 2000);
    assert_dominant(31000, 10000);
    start(1000);
    feed((component_t[]){{200000, 12200}, {450000, 26000}}, 2, 8000, 2000); // 7 dB
    assert_dominant(26000, 10000);
}

// It has 67 %, 55 %, 45 % and 55 % of the energy in turn.
static void test_the_strongest_stays_dominant_with_half_of_the_energy(void) {
    feed((component_t[]){{283000, 12200}, {400000, 26000}}, 2, 8000, 4000);
    assert_dominant(26000, 10000);
    feed((component_t[]){{362000, 12200}, {400000, 26000}}, 2, 8000, 4000);
    assert_dominant(26000, 10000);
    feed((component_t[]){{442000, 12200}, {400000, 26000}}, 2, 8000, 4000);
    assert_dominant(12200, 10000);
    feed((component_t[]){{362000, 12200}, {400000, 26000}}, 2, 8000, 4000);
    assert_dominant(12200, 10000);
}

static void test_drift_below_the_band_is_ignored(void) {
    feed((component_t[]){{300000, 300}, {200000, 12000}}, 2, 5000, 4000);
    assert_dominant(12000, 10000);
}

static void test_band_limits_bind(void) {
    estimator.known.tracker.cfg.band_low_mHz = 8000;
    estimator.known.tracker.cfg.band_high_mHz = 18000;
    feed((component_t[]){{300000, 5000}, {200000, 12000}}, 2, 5000, 2000);
    assert_dominant(12000, 10000);
    start(1000);
    estimator.known.tracker.cfg.band_low_mHz = 8000;
    estimator.known.tracker.cfg.band_high_mHz = 18000;
    feed((component_t[]){{300000, 5000}, {200000, 25000}}, 2, 5000, 2000);
    TEST_ASSERT_FALSE(is_valid());
}

static void test_frequency_step_is_seen_at_once_and_arrives_soon(void) {
    feed(&(component_t){600000, 10000}, 1, 5000, 2000);
    assert_dominant(10000, 5000);
    feed(&(component_t){230000, 20000}, 1, 5000, 30);
    TEST_ASSERT_FALSE(is_valid());
    feed(&(component_t){230000, 20000}, 1, 5000, 170);
    TEST_ASSERT_TRUE(is_valid()); // from a short window
    TEST_ASSERT_EQUAL_UINT32(128, estimator.known.window_ms);
    feed(&(component_t){230000, 20000}, 1, 5000, 1200);
    assert_dominant(20000, 20000);
}

static void test_end_of_the_vibration_is_seen_at_once(void) {
    feed(&(component_t){600000, 10000}, 1, 5000, 2000);
    feed(NULL, 0, 5000, 20);
    TEST_ASSERT_FALSE(is_valid());
    feed(NULL, 0, 5000, 3000);
    TEST_ASSERT_FALSE(is_valid());
}

static void test_lost_input_invalidates_at_once_and_until_a_window_is_new(void) {
    const component_t tones[] = {{300000, 10000}, {200000, 17000}};
    feed(tones, 2, 5000, 2000);
    TEST_ASSERT_TRUE(is_valid());
    estimator_step(&estimator, &(estimator_in_t){.is_lost = true});
    TEST_ASSERT_FALSE(is_valid());
    TEST_ASSERT_EQUAL_UINT32(1, estimator.known.age_ticks);
    feed(tones, 2, 5000, 1050);
    TEST_ASSERT_FALSE(is_valid());
    feed(tones, 2, 5000, 100);
    TEST_ASSERT_TRUE(is_valid());
}

// One or two ticks of every 97 go by without a call.
static void test_few_lost_ticks_are_bridged(void) {
    for (uint32_t most = 1; most <= ESTIMATOR_MOST_BRIDGED; most++) {
        start(1000);
        for (uint32_t i = 0; i < 4000; i++) {
            const uint32_t lost = i % 97 == 50 ? most : 0;
            i += lost;
            estimator_step(&estimator,
                           &(estimator_in_t){.accel_um_s2 = signal_sine(300000, 12340, i, 1000),
                                             .is_good = true,
                                             .lost_ticks = lost});
            if (i >= 1300) {
                TEST_ASSERT_TRUE(is_valid());
                TEST_ASSERT_INT32_WITHIN(10000, 12340000, estimator.known.tone[0].freq_uHz);
                const uint32_t turn =
                    (uint32_t)(((uint64_t)i * 12340u << 32) / 1000000u) - (1u << 30);
                const int32_t off = (int32_t)(estimate_phase_turn(&estimator.known, 0) - turn);
                TEST_ASSERT_INT32_WITHIN(4 * 11930465, 0, off); // 4 degrees
            }
        }
    }
}

// Phase of the dominant component: sin has it at -90 degrees when the sine is 0 and rising.
static void test_phase_follows_at_every_tick(void) {
    for (uint32_t i = 0; i < 3000; i++) {
        step(signal_sine(300000, 12340, i, 1000));
        if (i < 1200) {
            continue;
        }
        const uint32_t turn = (uint32_t)(((uint64_t)i * 12340u << 32) / 1000000u) - (1u << 30);
        const int32_t off = (int32_t)(estimate_phase_turn(&estimator.known, 0) - turn);
        TEST_ASSERT_INT32_WITHIN(1200000, 0, off); // 0.1 degrees
    }
}

static void test_missing_samples_are_bridged(void) {
    for (uint32_t i = 0; i < 4000; i++) {
        const bool is_good = i < 2000 || i % 50 >= 8; // 8 ms of every 50 are missing
        estimator_step(&estimator,
                       &(estimator_in_t){
                           .accel_um_s2 = is_good ? signal_sine(300000, 9000, i, 1000) : 0,
                           .is_good = is_good,
                       });
        if (i > 1500) {
            TEST_ASSERT_TRUE(is_valid());
            TEST_ASSERT_INT32_WITHIN(2000, 9000000, estimator.known.tone[0].freq_uHz);
        }
    }
}

static void test_hop_spaces_the_estimates(void) {
    cfg.hop_ms = 200;
    estimator_init(&estimator, &cfg);
    uint32_t published = 0;
    for (uint32_t i = 0; i < 4000; i++) {
        step(signal_sine(300000, 9000, i, 1000));
        published += estimator.known.has_published ? 1u : 0u;
    }
    TEST_ASSERT_UINT32_WITHIN(2, 15, published);
}

// Beats of eight components that no window tells apart, 3.9 to 6 Hz, and nothing above.
static int32_t narrow_band(uint32_t i) {
    static const uint32_t freqs_mHz[] = {3900, 4230, 4510, 4790, 5110, 5430, 5720, 6010};
    int32_t sum = 0;
    for (uint32_t k = 0; k < sizeof freqs_mHz / sizeof freqs_mHz[0]; k++) {
        sum += signal_sine(60000, freqs_mHz[k], i + 977u * k * k, rate_Hz);
    }
    return sum;
}

static bool becomes_narrow(uint32_t ticks) {
    for (uint32_t i = 0; i < ticks; i++, now++) {
        step(narrow_band(now));
        if (estimator.known.spread.is_narrow) {
            return true;
        }
    }
    return false;
}

static void start_with_bands(uint32_t tick_rate_Hz, int32_t high_mHz) {
    start(tick_rate_Hz);
    cfg.spread = (spread_cfg_t){3200, high_mHz, 20000};
    estimator_init(&estimator, &cfg);
}

static void test_a_narrow_band_is_told_at_every_rate(void) {
    static const uint32_t rates[] = {500, 1000, 2000, 4000};
    for (uint32_t r = 0; r < 4; r++) {
        start_with_bands(rates[r], 6750);
        TEST_ASSERT_FALSE(becomes_narrow(2u * rates[r]));
        TEST_ASSERT_TRUE(becomes_narrow(18u * rates[r]));
    }
    start_with_bands(1000, 0);
    TEST_ASSERT_FALSE(becomes_narrow(20000));
}

static void test_a_component_that_lasts_ends_what_was_narrow(void) {
    start_with_bands(1000, 6750);
    TEST_ASSERT_TRUE(becomes_narrow(20000));
    feed(&(component_t){300000, 5000}, 1, 0, 9000);
    TEST_ASSERT_TRUE(is_valid());
    TEST_ASSERT_FALSE(estimator.known.spread.is_narrow);
    start_with_bands(1000, 6750); // and alone makes nothing so
    feed(&(component_t){300000, 5000}, 1, 0, 20000);
    TEST_ASSERT_FALSE(estimator.known.spread.is_narrow);
}

static void test_a_lost_input_ends_what_was_narrow(void) {
    start_with_bands(1000, 6750);
    TEST_ASSERT_TRUE(becomes_narrow(20000));
    estimator_step(&estimator, &(estimator_in_t){.accel_um_s2 = 0, .is_lost = true});
    TEST_ASSERT_FALSE(estimator.known.spread.is_narrow);
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(test_tone_across_the_band_at_every_rate);
    RUN_TEST(test_silence_and_small_vibration_are_never_valid);
    RUN_TEST(test_noise_alone_is_not_a_frequency);
    RUN_TEST(test_needs_a_full_window_before_it_is_valid);
    RUN_TEST(test_trust_that_does_not_last_is_given_more_slowly);
    RUN_TEST(test_stronger_third_harmonic_does_not_win);
    RUN_TEST(test_of_unrelated_tones_alike_the_larger_displacement_wins);
    RUN_TEST(test_a_tone_with_most_of_the_energy_wins);
    RUN_TEST(test_the_strongest_stays_dominant_with_half_of_the_energy);
    RUN_TEST(test_drift_below_the_band_is_ignored);
    RUN_TEST(test_band_limits_bind);
    RUN_TEST(test_frequency_step_is_seen_at_once_and_arrives_soon);
    RUN_TEST(test_end_of_the_vibration_is_seen_at_once);
    RUN_TEST(test_lost_input_invalidates_at_once_and_until_a_window_is_new);
    RUN_TEST(test_few_lost_ticks_are_bridged);
    RUN_TEST(test_phase_follows_at_every_tick);
    RUN_TEST(test_missing_samples_are_bridged);
    RUN_TEST(test_hop_spaces_the_estimates);
    RUN_TEST(test_a_narrow_band_is_told_at_every_rate);
    RUN_TEST(test_a_component_that_lasts_ends_what_was_narrow);
    RUN_TEST(test_a_lost_input_ends_what_was_narrow);
    return UNITY_END();
}
