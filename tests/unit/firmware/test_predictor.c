#include "predictor.h"

#include "test_signal.h"
#include "unity.h"

enum { STAGES = 4, AMP = 1000000, BLOCK_ms = 2, NEVER = INT32_MAX };

static predictor_t predictor;
static uint32_t stages;
static uint32_t seed;
static uint32_t now; // ticks since the start

// The vibration that is fed; tick 0 is the one at which the components are loaded.
static predictor_tone_t tone[PREDICTOR_TONES];
static uint32_t tones;
static int32_t constant;
static int32_t sigma;

static void begin(uint32_t new_stages) {
    stages = new_stages;
    seed = 1;
    now = 0;
    tones = 0;
    constant = 0;
    sigma = 0;
    predictor_init(&predictor, stages);
}

void setUp(void) {
    begin(2);
}
void tearDown(void) {}

static uint32_t ticks_of(uint32_t ms) {
    return (ms << stages) / 4u;
}

// Frequency as turns a tick.
static uint32_t step_of(uint32_t freq_mHz) {
    return (uint32_t)((((uint64_t)freq_mHz << 32) / 250000u) >> stages);
}

static void add_tone(int32_t amp_um_s2, uint32_t freq_mHz, uint32_t phase_turn) {
    tone[tones] = (predictor_tone_t){phase_turn, step_of(freq_mHz), amp_um_s2};
    tones++;
}

// Decimated samples have a bandwidth of a 2^stages-th.
static int32_t decimated_sigma(void) {
    return (int32_t)isqrt_u64(((uint64_t)sigma * (uint64_t)sigma) >> stages);
}

static predictor_rest_t rest_now(void) {
    return (predictor_rest_t){
        .mean_um_s2 = constant,
        .is_clear = true,
        .noise_um_s2 = decimated_sigma(),
    };
}

static void load(void) {
    const predictor_rest_t rest = rest_now();
    predictor_load(&predictor, tone, tones, &rest);
}

static int32_t next_sample(void) {
    int32_t sum = constant + (sigma == 0 ? 0 : signal_normal(&seed, sigma));
    now++;
    for (uint32_t i = 0; i < tones; i++) {
        tone[i].phase_turn += tone[i].step_turn;
        sum += signal_cosine(tone[i].amp_um_s2, tone[i].phase_turn);
    }
    return sum;
}

static predictor_verdict_t step(void) {
    return predictor_step(&predictor, next_sample(), true);
}

static void assert_fits_for(uint32_t ticks) {
    for (uint32_t i = 0; i < ticks; i++) {
        TEST_ASSERT_EQUAL(PREDICTOR_FITS, step());
    }
}

// Ticks until a verdict, NEVER where it takes longer than `most`.
static int32_t ticks_until(predictor_verdict_t verdict, uint32_t most) {
    for (uint32_t i = 1; i <= most; i++) {
        const predictor_verdict_t at = step();
        if (at == verdict) {
            return (int32_t)i;
        }
        TEST_ASSERT_EQUAL(PREDICTOR_FITS, at);
    }
    return NEVER;
}

static void test_components_run_on_exactly(void) {
    add_tone(AMP, 7321, 123456789);
    add_tone(AMP / 3, 21963, 987654321);
    add_tone(AMP / 7, 49000, 3141592653u);
    load();
    for (uint32_t i = 0; i < 100000; i++) {
        const int32_t sample = next_sample();
        if (i == 50000) {
            predictor_disarm(&predictor);
        }
        predictor_step(&predictor, sample, i % 7u != 0);
        TEST_ASSERT_INT32_WITHIN(400, sample, predictor.prediction_um_s2);
        for (uint32_t k = 0; k < 3; k++) {
            TEST_ASSERT_EQUAL_UINT32(tone[k].phase_turn, predictor.tone[k].phase_turn);
        }
    }
}

static uint32_t alarms_in(uint32_t ticks) {
    uint32_t alarms = 0;
    for (uint32_t i = 0; i < ticks; i++) {
        if (step() == PREDICTOR_CHANGED) {
            alarms++;
            predictor_disarm(&predictor);
            load();
        }
    }
    return alarms;
}

// Nothing but noise, at every rate: half a million ticks, 280,000 blocks of 2 ms a level.
static void test_white_noise_raises_hardly_an_alarm(void) {
    static const int32_t sigmas[] = {1000, 200000, 20000000};
    for (uint32_t i = 0; i < sizeof sigmas / sizeof sigmas[0]; i++) {
        uint32_t alarms = 0;
        for (uint32_t s = 1; s <= STAGES; s++) {
            begin(s);
            sigma = sigmas[i];
            load();
            alarms += alarms_in(150000);
        }
        TEST_ASSERT_LESS_OR_EQUAL_UINT32(280000 / 15000, alarms);
    }
}

static void test_noise_beside_a_vibration_raises_no_alarm(void) {
    for (uint32_t s = 1; s <= STAGES; s++) {
        begin(s);
        sigma = AMP / 50;
        constant = 9806650;
        add_tone(AMP, 9000, 0);
        add_tone(AMP / 2, 17000, 0);
        load();
        assert_fits_for(200000);
    }
}

// At sixteen phases of a 10 Hz tone in 1 % of noise.
static void steady_at_phase(uint32_t s, uint32_t eighths) {
    begin(s);
    seed = 7u * eighths + 1u;
    sigma = AMP / 100;
    add_tone(AMP, 10000, 0);
    load();
    assert_fits_for(ticks_of(500) + ticks_of(100) * eighths / 16u);
}

static void assert_change_is_seen(uint32_t most_ms) {
    TEST_ASSERT_LESS_OR_EQUAL_INT32(ticks_of(most_ms),
                                    ticks_until(PREDICTOR_CHANGED, ticks_of(500)));
    TEST_ASSERT_TRUE(predictor.is_suspicious);
}

static void test_changes_are_seen_soon(void) {
    for (uint32_t s = 1; s <= STAGES; s++) {
        for (uint32_t phase = 0; phase < 16; phase++) {
            steady_at_phase(s, phase);
            tones = 0; // the end of it
            assert_change_is_seen(24);
            steady_at_phase(s, phase);
            tone[0].step_turn *= 2u;
            assert_change_is_seen(30);
            steady_at_phase(s, phase);
            tone[0].step_turn /= 2u;
            assert_change_is_seen(40);
            steady_at_phase(s, phase);
            tone[0].amp_um_s2 *= 2;
            assert_change_is_seen(24);
            steady_at_phase(s, phase);
            tone[0].phase_turn += 1u << 30;
            assert_change_is_seen(24);
            steady_at_phase(s, phase);
            constant = AMP;
            assert_change_is_seen(8);
            steady_at_phase(s, phase);
            tones++;
            tone[1] = (predictor_tone_t){0, step_of(23000), AMP};
            assert_change_is_seen(16);
        }
    }
}

// A step as large as the noise's deviation: the longer blocks find most of them before the slow
// part has taken them over.
static void test_longer_blocks_see_what_noise_hides(void) {
    uint32_t seen = 0;
    for (uint32_t i = 0; i < 40; i++) {
        begin(2);
        seed = i + 1u;
        sigma = AMP;
        load();
        assert_fits_for(1000 + i);
        constant = AMP;
        seen += ticks_until(PREDICTOR_CHANGED, 200) != NEVER ? 1u : 0u;
    }
    TEST_ASSERT_GREATER_OR_EQUAL_UINT32(32, seen);
}

static void test_error_within_the_tolerance_raises_no_alarm(void) {
    add_tone(AMP, 10000, 0);
    load();
    tone[0].amp_um_s2 += AMP / 50;
    assert_fits_for(20000);
    begin(2);
    add_tone(AMP, 10000, 0);
    load();
    tone[0].phase_turn += UINT32_C(13671303); // 0.02 radians
    assert_fits_for(20000);
    tone[0].phase_turn += UINT32_C(13671303) * 10u;
    TEST_ASSERT_LESS_THAN_INT32(500, ticks_until(PREDICTOR_CHANGED, 1000));
}

// A jump at any tick of a block and at every rate: suspect_ticks leads back to the end of the block
// in which it happened.
static void test_alarm_tells_when_the_change_began(void) {
    for (uint32_t s = 1; s <= STAGES; s++) {
        for (uint32_t wait = 0; wait < 40; wait++) {
            begin(s);
            add_tone(AMP, 10000, 0);
            load();
            assert_fits_for(ticks_of(500) + wait);
            const uint32_t change = now;
            constant = AMP / 2;
            TEST_ASSERT_LESS_THAN_INT32(NEVER, ticks_until(PREDICTOR_CHANGED, ticks_of(500)));
            const int32_t after = (int32_t)(now - predictor.suspect_ticks - change);
            TEST_ASSERT_GREATER_THAN_INT32(0, after);
            TEST_ASSERT_LESS_OR_EQUAL_INT32(ticks_of(BLOCK_ms), after);
        }
    }
}

// A change that only adds up over many blocks, of whichever length.
static void test_alarm_tells_when_a_faint_change_began(void) {
    for (uint32_t wait = 0; wait < 40; wait++) {
        setUp();
        add_tone(AMP, 10000, 0);
        load();
        assert_fits_for(1000 + wait);
        const uint32_t change = now;
        constant = AMP / 12;
        TEST_ASSERT_LESS_THAN_INT32(NEVER, ticks_until(PREDICTOR_CHANGED, 500));
        const int32_t after = (int32_t)(now - predictor.suspect_ticks - change);
        TEST_ASSERT_GREATER_THAN_INT32(0, after);
        TEST_ASSERT_LESS_OR_EQUAL_INT32(ticks_of(32) + 1, after);
    }
}

static void test_slow_drift_is_taken_out(void) {
    constant = -5000000;
    add_tone(AMP, 10000, 0);
    load();
    for (uint32_t i = 0; i < 60000; i++) {
        constant += AMP / 10000; // 0.1 of the amplitude a second
        TEST_ASSERT_EQUAL(PREDICTOR_FITS, step());
    }
    // What is 0.25 s behind.
    const int32_t learnt = (int32_t)(predictor.offset_q12 >> 12);
    TEST_ASSERT_INT32_WITHIN(AMP / 25, constant, learnt);
    // Slow waves of a twentieth of the amplitude, 0.1 Hz.
    tones = 2;
    tone[1] = (predictor_tone_t){0xC0000000u, step_of(100), AMP / 20};
    assert_fits_for(40000);
}

static void test_announced_drift_is_followed(void) {
    add_tone(AMP, 10000, 0);
    const predictor_rest_t rest = {
        .mean_um_s2 = 3000000,
        .drift_um_s2_q8 = 256 * 2000, // twice the amplitude a second
        .bend_um_s2 = 1000,
        .is_clear = true,
    };
    predictor_load(&predictor, tone, tones, &rest);
    constant = 3000000;
    for (uint32_t i = 0; i < 5000; i++) {
        constant += 2000;
        const int32_t sample = next_sample();
        TEST_ASSERT_EQUAL(PREDICTOR_FITS, predictor_step(&predictor, sample, true));
        TEST_ASSERT_INT32_WITHIN(5000, sample, predictor.prediction_um_s2);
    }
}

static int32_t prediction_after_load(int32_t mean_um_s2, int32_t bend_um_s2) {
    const predictor_rest_t rest = {
        .mean_um_s2 = mean_um_s2, .bend_um_s2 = bend_um_s2, .is_clear = true};
    predictor_load(&predictor, tone, 0, &rest);
    predictor_step(&predictor, 0, false);
    return predictor.prediction_um_s2;
}

static void test_constant_is_taken_over_when_disarmed_or_drifting(void) {
    TEST_ASSERT_EQUAL_INT32(5000000, prediction_after_load(5000000, 0));
    TEST_ASSERT_EQUAL_INT32(5000000, prediction_after_load(4000000, 0));
    TEST_ASSERT_EQUAL_INT32(3000000, prediction_after_load(3000000, 1000));
    predictor_disarm(&predictor);
    TEST_ASSERT_EQUAL_INT32(-2000000, prediction_after_load(-2000000, 0));
}

static void test_without_a_load_nothing_is_watched(void) {
    constant = 400000000;
    for (uint32_t i = 0; i < 1000; i++) {
        constant = -constant;
        TEST_ASSERT_EQUAL(PREDICTOR_FITS, step());
    }
    TEST_ASSERT_FALSE(predictor.is_armed);
    load();
    TEST_ASSERT_TRUE(predictor.is_armed);
    predictor_disarm(&predictor);
    constant = -constant;
    assert_fits_for(1000);
}

// Held samples may be anything; the vibration goes on meanwhile.
static void test_held_samples_are_not_looked_at(void) {
    sigma = AMP / 100;
    add_tone(AMP, 10000, 0);
    load();
    for (uint32_t i = 0; i < 20000; i++) {
        const int32_t sample = next_sample();
        const bool is_good = i % 60u < 30u;
        const int32_t shown = is_good ? sample : 500000000;
        TEST_ASSERT_EQUAL(PREDICTOR_FITS, predictor_step(&predictor, shown, is_good));
        TEST_ASSERT_INT32_WITHIN(AMP / 10, sample, predictor.prediction_um_s2);
    }
    // An alarm waits for good samples.
    constant = AMP;
    for (uint32_t i = 0; i < 1000; i++) {
        TEST_ASSERT_EQUAL(PREDICTOR_FITS, predictor_step(&predictor, next_sample(), false));
    }
    TEST_ASSERT_LESS_OR_EQUAL_INT32(ticks_of(8), ticks_until(PREDICTOR_CHANGED, 1000));
}

// The longest window (1.024 s) of the tone has 512 x amp^2 / 2 in squares of 2 ms.
static void burst(uint32_t ms, int32_t size) {
    constant += size;
    for (uint32_t i = 0; i < ticks_of(ms); i++) {
        TEST_ASSERT_NOT_EQUAL(PREDICTOR_BACK, step());
    }
    constant -= size;
}

static void start_for_burst(uint32_t s, uint32_t wait) {
    begin(s);
    sigma = AMP / 1000;
    add_tone(AMP, 10000, 0);
    load();
    assert_fits_for(ticks_of(500) + wait);
}

static void test_small_burst_is_forgiven(void) {
    for (uint32_t s = 1; s <= STAGES; s++) {
        for (uint32_t wait = 0; wait < 20; wait++) {
            start_for_burst(s, wait);
            burst(4, AMP / 2); // 0.2 % of the energy
            TEST_ASSERT_TRUE(predictor.is_suspicious || step() == PREDICTOR_CHANGED);
            load(); // which does not end the suspicion
            TEST_ASSERT_TRUE(predictor.is_suspicious);
            const int32_t back = ticks_until(PREDICTOR_BACK, ticks_of(200));
            TEST_ASSERT_FALSE(predictor.is_suspicious);
            // 40 ms in blocks of 8, of which the first may hold the end of the burst.
            TEST_ASSERT_GREATER_OR_EQUAL_INT32(ticks_of(38), back);
            TEST_ASSERT_LESS_OR_EQUAL_INT32(ticks_of(50), back);
            assert_fits_for(ticks_of(1000));
        }
    }
}

static void test_large_burst_is_not_forgiven(void) {
    for (uint32_t s = 1; s <= STAGES; s++) {
        start_for_burst(s, 3);
        burst(16, 4 * AMP / 3); // 5 % of the energy
        TEST_ASSERT_TRUE(predictor.is_suspicious);
        assert_fits_for(ticks_of(1000));
        TEST_ASSERT_TRUE(predictor.is_suspicious);
        predictor_disarm(&predictor);
        TEST_ASSERT_FALSE(predictor.is_suspicious);
    }
}

static void test_lasting_change_is_not_taken_for_a_burst(void) {
    start_for_burst(2, 0);
    tone[0].step_turn += tone[0].step_turn / 8u;
    TEST_ASSERT_LESS_THAN_INT32(NEVER, ticks_until(PREDICTOR_CHANGED, ticks_of(500)));
    assert_fits_for(ticks_of(2000));
    TEST_ASSERT_TRUE(predictor.is_suspicious);
}

// What was suspected before a burst was forgiven does not count into the next alarm.
static void test_alarm_right_after_a_forgiven_burst_tells_when_it_began(void) {
    for (uint32_t wait = 0; wait < 20; wait++) {
        start_for_burst(2, wait);
        burst(8, AMP / 5);
        TEST_ASSERT_TRUE(predictor.is_suspicious);
        TEST_ASSERT_LESS_THAN_INT32(NEVER, ticks_until(PREDICTOR_BACK, ticks_of(200)));
        const uint32_t change = now;
        constant = AMP / 5;
        TEST_ASSERT_LESS_THAN_INT32(NEVER, ticks_until(PREDICTOR_CHANGED, ticks_of(100)));
        const int32_t after = (int32_t)(now - predictor.suspect_ticks - change);
        TEST_ASSERT_GREATER_THAN_INT32(0, after);
        TEST_ASSERT_LESS_OR_EQUAL_INT32(ticks_of(8) + 1, after);
    }
}

// The largest figures that fit their words, with everything against the prediction, for seconds.
static void test_full_scale_does_not_overflow(void) {
    for (uint32_t s = 1; s <= STAGES; s++) {
        for (uint32_t bend = 0; bend < 2; bend++) {
            begin(s);
            for (uint32_t k = 0; k < PREDICTOR_TONES; k++) {
                add_tone(INT32_MAX, 10000 + 7000 * k, k << 30);
            }
            const predictor_rest_t rest = {
                .mean_um_s2 = INT32_MIN,
                .drift_um_s2_q8 = bend ? INT32_MAX : 0,
                .bend_um_s2 = bend ? INT32_MAX : 0,
                .is_clear = bend,
                .noise_um_s2 = s & 1u ? INT32_MAX : 0,
            };
            predictor_load(&predictor, tone, tones, &rest);
            for (uint32_t i = 0; i < ticks_of(3000); i++) {
                const int32_t sample = i >> 8 & 1u ? INT32_MAX : INT32_MIN;
                (void)predictor_step(&predictor, sample, true);
                for (uint32_t k = 0; k < PREDICTOR_SCALES; k++) {
                    TEST_ASSERT_TRUE(predictor.watch[k].sum >= 0);
                    TEST_ASSERT_TRUE(predictor.watch[k].noise >= 0);
                }
                TEST_ASSERT_TRUE(predictor.burst >= 0);
            }
        }
    }
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(test_components_run_on_exactly);
    RUN_TEST(test_white_noise_raises_hardly_an_alarm);
    RUN_TEST(test_noise_beside_a_vibration_raises_no_alarm);
    RUN_TEST(test_changes_are_seen_soon);
    RUN_TEST(test_longer_blocks_see_what_noise_hides);
    RUN_TEST(test_error_within_the_tolerance_raises_no_alarm);
    RUN_TEST(test_alarm_tells_when_the_change_began);
    RUN_TEST(test_alarm_tells_when_a_faint_change_began);
    RUN_TEST(test_slow_drift_is_taken_out);
    RUN_TEST(test_announced_drift_is_followed);
    RUN_TEST(test_constant_is_taken_over_when_disarmed_or_drifting);
    RUN_TEST(test_without_a_load_nothing_is_watched);
    RUN_TEST(test_held_samples_are_not_looked_at);
    RUN_TEST(test_small_burst_is_forgiven);
    RUN_TEST(test_large_burst_is_not_forgiven);
    RUN_TEST(test_lasting_change_is_not_taken_for_a_burst);
    RUN_TEST(test_alarm_right_after_a_forgiven_burst_tells_when_it_began);
    RUN_TEST(test_full_scale_does_not_overflow);
    return UNITY_END();
}
