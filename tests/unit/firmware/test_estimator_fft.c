// What vibrates and how, by the FFT, through the estimator that the controller has.
#include "estimator.h"
#include "quiesce.h"
#include "test_signal.h"
#include "unity.h"

static estimator_t estimator;
static estimate_t *const known = &estimator.known;
static estimator_cfg_t cfg;
static uint32_t rate_Hz;
static uint32_t now; // ticks since the start; phases go on from one feed to the next
static uint32_t published;
static uint32_t seed;
static const uint32_t rates_Hz[] = {500, 1000, 2000, 4000};

static void start_in(uint32_t tick_rate_Hz, int32_t low_mHz, int32_t high_mHz) {
    rate_Hz = tick_rate_Hz;
    now = 0;
    published = 0;
    seed = 3;
    cfg = (estimator_cfg_t){
        .method = QUIESCE_ESTIMATOR_FFT,
        .tick_rate_Hz = rate_Hz,
        .longest_ms = 1024,
        .tracker = {.band_low_mHz = low_mHz,
                    .band_high_mHz = high_mHz,
                    .min_accel_um_s2 = 10000,
                    .snr_dB = 15},
    };
    estimator_init(&estimator, &cfg);
}

static void start(uint32_t tick_rate_Hz) {
    start_in(tick_rate_Hz, 1000, 50000);
}

void setUp(void) {
    start(1000);
}
void tearDown(void) {}

static void step(int32_t accel_um_s2) {
    estimator_step(&estimator, &(estimator_in_t){.accel_um_s2 = accel_um_s2, .is_good = true});
    published += known->has_published ? 1u : 0u;
    now++;
}

typedef struct {
    int32_t amp_um_s2;
    uint32_t freq_mHz;
} component_t;

static uint32_t turn_of(uint32_t freq_mHz) {
    return (uint32_t)(((uint64_t)now * freq_mHz << 32) / (1000u * rate_Hz));
}

static int32_t sample_of(const component_t *tones, uint32_t count) {
    int64_t sum = 0;
    for (uint32_t k = 0; k < count; k++) {
        sum += signal_cosine(tones[k].amp_um_s2, turn_of(tones[k].freq_mHz));
    }
    return clamp_i32((int32_t)clamp_i64(sum, INT32_MIN, INT32_MAX), -500000000, 500000000);
}

static void feed(const component_t *tones, uint32_t count, int32_t noise_um_s2, uint32_t ticks) {
    for (uint32_t i = 0; i < ticks; i++) {
        step(sample_of(tones, count) + (noise_um_s2 == 0 ? 0 : signal_normal(&seed, noise_um_s2)));
    }
}

// How far the image at negative frequency may move a frequency, and what its steps add.
static int32_t bias_uHz(uint32_t freq_mHz) {
    const double bins = freq_mHz * 1.024e-3;
    return (int32_t)(976562.5 * (bins < 2.5 ? 0.21 : 0.075) / (bins * bins * bins)) + 100;
}

static void assert_dominant(uint32_t freq_mHz, int32_t tolerance_uHz) {
    TEST_ASSERT_TRUE(known->is_valid);
    TEST_ASSERT_INT32_WITHIN(tolerance_uHz, (int32_t)freq_mHz * 1000, known->tone[0].freq_uHz);
}

static void test_tone_across_the_band_at_every_rate(void) {
    for (uint32_t r = 0; r < 4; r++) {
        for (uint32_t freq_mHz = 2200; freq_mHz < 50000; freq_mHz += freq_mHz / 5 + 37) {
            start(rates_Hz[r]);
            feed(&(component_t){300000, freq_mHz}, 1, 0, 5 * rates_Hz[r] / 4);
            assert_dominant(freq_mHz, bias_uHz(freq_mHz));
            TEST_ASSERT_INT32_WITHIN(freq_mHz < 4000 ? 6000 : 700, 300000,
                                     known->tone[0].amp_um_s2);
            TEST_ASSERT_EQUAL_UINT32(1024, known->window_ms);
        }
    }
}

// Below two bins the mean that is taken out is part of the tone.
static void test_below_two_bins_is_not_valid(void) {
    for (uint32_t freq_mHz = 1100; freq_mHz < 1950; freq_mHz += 160) {
        start(1000);
        for (uint32_t i = 0; i < 3000; i++) {
            step(signal_cosine(300000, turn_of(freq_mHz)));
            TEST_ASSERT_FALSE(known->is_valid);
        }
    }
}

static void test_every_hop_publishes_at_every_rate(void) {
    for (uint32_t r = 0; r < 4; r++) {
        start(rates_Hz[r]);
        feed((component_t[]){{300000, 7000}, {300000, 13000}, {300000, 31000}}, 3, 3000,
             rates_Hz[r] * 1124 / 1000);
        const uint32_t before = published;
        feed((component_t[]){{300000, 7000}, {300000, 13000}, {300000, 31000}}, 3, 3000,
             2 * rates_Hz[r]);
        TEST_ASSERT_EQUAL_UINT32(40, published - before);
        TEST_ASSERT_INT32_WITHIN(20000, 7000000, known->tone[0].freq_uHz);
        TEST_ASSERT_NOT_EQUAL(0, known->tone[2].freq_uHz);
    }
}

static void test_longer_hop_spaces_the_estimates(void) {
    cfg.hop_ms = 200;
    estimator_init(&estimator, &cfg);
    feed(&(component_t){300000, 9000}, 1, 0, 4000);
    TEST_ASSERT_UINT32_WITHIN(1, 15, published);
}

static void test_silence_small_vibration_and_noise_are_never_valid(void) {
    feed(NULL, 0, 0, 3000);
    TEST_ASSERT_FALSE(known->is_valid);
    start(1000);
    feed(&(component_t){5000, 8000}, 1, 0, 3000);
    TEST_ASSERT_FALSE(known->is_valid);
    TEST_ASSERT_EQUAL_UINT32(UINT32_MAX, known->age_ticks);
    start(1000);
    for (uint32_t i = 0; i < 60000; i++) {
        step(signal_noise(&seed, 2000000)); // peaks pass min_accel, not the noise floor
        TEST_ASSERT_FALSE(known->is_valid);
    }
}

static void test_needs_a_full_window_before_it_is_valid(void) {
    feed(&(component_t){300000, 10000}, 1, 5000, 1050);
    TEST_ASSERT_FALSE(known->is_valid);
    feed(&(component_t){300000, 10000}, 1, 5000, 74);
    TEST_ASSERT_TRUE(known->is_valid);
    TEST_ASSERT_EQUAL_UINT32(0, known->age_ticks);
}

static void test_frequency_in_noise_is_within_its_expected_deviation(void) {
    int64_t squares = 0;
    int64_t sigma_uHz = 0;
    for (uint32_t trial = 0; trial < 40; trial++) {
        const uint32_t noise = trial * 977u + 1u;
        start(1000);
        seed = noise;
        feed(&(component_t){300000, 9000 + 131 * trial}, 1, 100000, 1100);
        const int64_t off = (int64_t)known->tone[0].freq_uHz - 1000 * (9000 + 131 * (int64_t)trial);
        squares += off * off / 40;
        sigma_uHz += known->sigma_uHz / 40;
    }
    // Expected to be twice the bound of a sine in noise, which no estimate can beat.
    TEST_ASSERT_TRUE(squares < sigma_uHz * sigma_uHz);
    TEST_ASSERT_TRUE(16 * squares > sigma_uHz * sigma_uHz);
}

static void test_stronger_third_harmonic_does_not_win(void) {
    feed((component_t[]){{50000, 5000}, {90000, 15000}}, 2, 8000, 2000);
    assert_dominant(5000, 30000);
    TEST_ASSERT_INT32_WITHIN(20000, 15000000, known->tone[1].freq_uHz);
    TEST_ASSERT_EQUAL_INT32(0, known->tone[2].freq_uHz);
}

static void test_of_two_tones_the_larger_displacement_wins(void) {
    feed((component_t[]){{400000, 17300}, {400000, 31000}}, 2, 8000, 2000);
    assert_dominant(17300, 20000);
    start(1000);
    feed((component_t[]){{100000, 17300}, {400000, 31000}}, 2, 8000, 2000);
    assert_dominant(31000, 20000);
}

static void test_band_limits_bind(void) {
    start_in(1000, 8000, 18000);
    feed((component_t[]){{300000, 5000}, {200000, 12000}}, 2, 5000, 2000);
    assert_dominant(12000, 20000);
    start_in(1000, 8000, 18000);
    feed((component_t[]){{300000, 5000}, {200000, 25000}}, 2, 5000, 2000);
    TEST_ASSERT_FALSE(known->is_valid);
    TEST_ASSERT_EQUAL_INT32(0, known->tone[0].freq_uHz);
    // Right at the edge: not beyond it.
    start_in(1000, 8000, 18000);
    for (uint32_t i = 0; i < 5000; i++) {
        step(signal_cosine(300000, turn_of(18002)) + signal_normal(&seed, 9000));
        TEST_ASSERT_TRUE(known->tone[0].freq_uHz <= 18000000);
    }
}

// Nothing that its windows still hold is valid after a step, and what is new is by itself.
static void test_frequency_step_is_seen_at_once_and_valid_with_a_new_window(void) {
    for (uint32_t r = 0; r < 4; r++) {
        start(rates_Hz[r]);
        feed(&(component_t){600000, 10000}, 1, 5000, 2 * rate_Hz);
        assert_dominant(10000, 20000);
        feed(&(component_t){230000, 20000}, 1, 5000, 30 * rate_Hz / 1000);
        TEST_ASSERT_FALSE(known->is_valid);
        feed(&(component_t){230000, 20000}, 1, 5000, 870 * rate_Hz / 1000);
        TEST_ASSERT_FALSE(known->is_valid);
        TEST_ASSERT_INT32_WITHIN(100000, 20000000, known->tone[0].freq_uHz); // known before
        feed(&(component_t){230000, 20000}, 1, 5000, 280 * rate_Hz / 1000);
        assert_dominant(20000, 20000);
        TEST_ASSERT_INT32_WITHIN(3000, 230000, known->tone[0].amp_um_s2);
    }
}

static void test_end_of_the_vibration_is_seen_at_once(void) {
    feed(&(component_t){600000, 10000}, 1, 5000, 2000);
    feed(NULL, 0, 5000, 20);
    for (uint32_t i = 0; i < 3000; i++) {
        TEST_ASSERT_FALSE(known->is_valid);
        feed(NULL, 0, 5000, 1);
    }
}

static void test_trust_that_does_not_last_is_given_more_slowly(void) {
    static const uint32_t freqs_mHz[] = {9000, 14000};
    for (uint32_t i = 0; i < 2; i++) {
        feed(&(component_t){300000, freqs_mHz[i]}, 1, 0, 1500);
        TEST_ASSERT_TRUE(known->is_valid);
    }
    feed(&(component_t){300000, 21000}, 1, 0, 1500);
    TEST_ASSERT_FALSE(known->is_valid);
    feed(&(component_t){300000, 21000}, 1, 0, 1500);
    TEST_ASSERT_TRUE(known->is_valid);
}

static void test_lost_input_invalidates_at_once_and_until_a_window_is_new(void) {
    const component_t tones[] = {{300000, 10000}, {200000, 17000}};
    feed(tones, 2, 5000, 2000);
    TEST_ASSERT_TRUE(known->is_valid);
    estimator_step(&estimator, &(estimator_in_t){.is_lost = true});
    now++;
    TEST_ASSERT_FALSE(known->is_valid);
    TEST_ASSERT_EQUAL_UINT32(1, known->age_ticks);
    feed(tones, 2, 5000, 1050);
    TEST_ASSERT_FALSE(known->is_valid);
    feed(tones, 2, 5000, 100);
    TEST_ASSERT_TRUE(known->is_valid);
}

// One or two ticks of every 97 go by without a call.
static void test_few_lost_ticks_are_bridged(void) {
    for (uint32_t most = 1; most <= ESTIMATOR_MOST_BRIDGED; most++) {
        start(1000);
        for (uint32_t i = 0; i < 4000; i++) {
            const uint32_t lost = i % 97 == 50 ? most : 0;
            i += lost;
            now = i;
            estimator_step(&estimator, &(estimator_in_t){.accel_um_s2 = sample_of(
                                                             &(component_t){300000, 12340}, 1),
                                                         .is_good = true,
                                                         .lost_ticks = lost});
            if (i >= 1300) {
                TEST_ASSERT_TRUE(known->is_valid);
                TEST_ASSERT_INT32_WITHIN(30000, 12340000, known->tone[0].freq_uHz);
                const uint32_t turn = turn_of(12340);
                const int32_t off = (int32_t)(estimate_phase_turn(known, 0) - turn);
                TEST_ASSERT_INT32_WITHIN(4 * 11930465, 0, off); // 4 degrees
            }
        }
    }
}

static void test_phase_follows_at_every_tick_and_rate(void) {
    for (uint32_t r = 0; r < 4; r++) {
        start(rates_Hz[r]);
        for (uint32_t i = 0; i < 3 * rate_Hz; i++) {
            const uint32_t turn = turn_of(12340);
            step(signal_cosine(300000, turn));
            const int32_t off = (int32_t)(estimate_phase_turn(known, 0) - turn);
            if (i > 5 * rate_Hz / 4) {
                TEST_ASSERT_INT32_WITHIN(2400000, 0, off); // 0.2 degrees
            }
        }
    }
}

static void test_missing_samples_are_bridged(void) {
    for (uint32_t i = 0; i < 4000; i++) {
        const bool is_good = i < 2000 || i % 50 >= 8; // 8 ms of every 50 are missing
        estimator_step(&estimator,
                       &(estimator_in_t){
                           .accel_um_s2 = is_good ? signal_cosine(300000, turn_of(9000)) : 0,
                           .is_good = is_good,
                       });
        now++;
        if (i > 1500) {
            TEST_ASSERT_TRUE(known->is_valid);
            TEST_ASSERT_INT32_WITHIN(2000, 9000000, known->tone[0].freq_uHz);
        }
    }
}

// At the largest acceleration that a sensor has, clipped: a square wave, and its third harmonic.
static void test_saturated_input_is_followed(void) {
    feed(&(component_t){INT32_MAX, 6000}, 1, 0, 2000);
    assert_dominant(6000, 20000);
    TEST_ASSERT_TRUE(known->tone[0].amp_um_s2 > 500000000);
    TEST_ASSERT_INT32_WITHIN(20000, 18000000, known->tone[1].freq_uHz);
}

static void test_velocity_is_that_of_the_tone(void) {
    feed(&(component_t){300000, 20000}, 1, 0, 2000);
    // 0.3 / (2 pi 20) / sqrt(2) m/s, some per mille high (sense/velocity.h).
    TEST_ASSERT_INT32_WITHIN(10, 1692, known->velocity.rms_um_s);
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(test_tone_across_the_band_at_every_rate);
    RUN_TEST(test_below_two_bins_is_not_valid);
    RUN_TEST(test_every_hop_publishes_at_every_rate);
    RUN_TEST(test_longer_hop_spaces_the_estimates);
    RUN_TEST(test_silence_small_vibration_and_noise_are_never_valid);
    RUN_TEST(test_needs_a_full_window_before_it_is_valid);
    RUN_TEST(test_frequency_in_noise_is_within_its_expected_deviation);
    RUN_TEST(test_stronger_third_harmonic_does_not_win);
    RUN_TEST(test_of_two_tones_the_larger_displacement_wins);
    RUN_TEST(test_band_limits_bind);
    RUN_TEST(test_frequency_step_is_seen_at_once_and_valid_with_a_new_window);
    RUN_TEST(test_end_of_the_vibration_is_seen_at_once);
    RUN_TEST(test_trust_that_does_not_last_is_given_more_slowly);
    RUN_TEST(test_lost_input_invalidates_at_once_and_until_a_window_is_new);
    RUN_TEST(test_few_lost_ticks_are_bridged);
    RUN_TEST(test_phase_follows_at_every_tick_and_rate);
    RUN_TEST(test_missing_samples_are_bridged);
    RUN_TEST(test_saturated_input_is_followed);
    RUN_TEST(test_velocity_is_that_of_the_tone);
    return UNITY_END();
}
