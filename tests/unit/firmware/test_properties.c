// What must hold for any signal: linear in scale and sign, the same later as now. Two controllers
// run side by side and their telemetry is compared at every tick.
#include "quiesce.h"

#include <stddef.h>
#include <string.h>

#include "test_signal.h"
#include "unity.h"

enum { FULL_SCALE = 8388607, DECIMATED_RATE_Hz = 250 };

static const int32_t rates_Hz[] = {500, 1000, 2000, 4000};

// One of the two: its parameters, and what it makes of the common signal.
typedef struct {
    quiesce_t controller;
    quiesce_params_t params;
    quiesce_out_t out;
    uint32_t tick;
    int32_t gain; // of its input
} side_t;

static side_t plain;
static side_t other;
static uint32_t seed;

void setUp(void) {
    quiesce_params_default(&plain.params);
    quiesce_params_default(&other.params);
    plain.gain = 1;
    other.gain = 1;
    seed = 7;
}
void tearDown(void) {}

static void start(int32_t rate_Hz) {
    side_t *sides[] = {&plain, &other};
    for (uint32_t i = 0; i < 2; i++) {
        sides[i]->params.tick_rate_Hz = rate_Hz;
        sides[i]->tick = 0;
        TEST_ASSERT_TRUE(quiesce_init(&sides[i]->controller, &sides[i]->params));
    }
}

static void step(side_t *side, int32_t counts, bool is_fresh) {
    const quiesce_in_t in = {
        .tick = side->tick,
        .sensor[0].counts = side->gain * counts,
        .sensor[0].is_fresh = is_fresh,
        .enable = side->tick > 0, // its edge arms
    };
    side->tick++;
    quiesce_step(&side->controller, &in, &side->out);
}

static void step_without_sample(side_t *side, uint32_t ticks) {
    for (uint32_t i = 0; i < ticks; i++) {
        step(side, 0, false);
    }
}

// 7 Hz of 1.2 m/s2, 23 Hz of 0.4 m/s2, noise of 3 mg (25 dB under the first), gravity; after two
// seconds the first one moves to 13 Hz.
static int32_t signal_at(uint32_t i, uint32_t rate_Hz) {
    const uint32_t freq_mHz = i < 2u * rate_Hz ? 7000 : 13000;
    return signal_sine(20000, freq_mHz, i, rate_Hz) + signal_sine(7000, 23000, i, rate_Hz) +
           signal_noise(&seed, 880) + 170000;
}

static int32_t difference_mdeg(int32_t one_mdeg, int32_t two_mdeg) {
    const int32_t turn_mdeg = 360000;
    const int32_t rest_mdeg = ((two_mdeg - one_mdeg) % turn_mdeg + turn_mdeg) % turn_mdeg;
    return rest_mdeg > turn_mdeg / 2 ? turn_mdeg - rest_mdeg : rest_mdeg;
}

// Tolerances of two components that should be equal: those of the integer arithmetic.
static void check_component(quiesce_peak_t one, quiesce_peak_t two) {
    TEST_ASSERT_INT32_WITHIN(20, one.freq_uHz, two.freq_uHz);
    TEST_ASSERT_INT32_WITHIN(5 + one.amp_um_s2 / 100000, one.amp_um_s2, two.amp_um_s2);
    TEST_ASSERT_TRUE(difference_mdeg(one.phase_mdeg, two.phase_mdeg) <= 5);
}

static quiesce_peak_t dominant_of(const quiesce_telemetry_t *t) {
    return (quiesce_peak_t){t->freq_uHz, t->freq_amp_um_s2, t->freq_phase_mdeg};
}

// Both see the signal for two frequencies, four seconds; calls check after every tick. Returns in
// how many of them the frequency was valid on both sides.
static uint32_t run_both(uint32_t rate_Hz, void (*check)(void)) {
    uint32_t valid = 0;
    for (uint32_t i = 0; i < 4u * rate_Hz; i++) {
        const int32_t counts = signal_at(i, rate_Hz);
        step(&plain, counts, true);
        step(&other, counts, true);
        check();
        valid += plain.out.telemetry.freq_is_valid & other.out.telemetry.freq_is_valid;
    }
    return valid;
}

// Doubled input: acceleration, velocity, RMS and amplitudes double, but for rounding; frequency and
// phase stay. (Validity may come some ticks earlier or later: smallest amplitudes do not scale.)
static void check_doubled(void) {
    const quiesce_telemetry_t *once = &plain.out.telemetry;
    const quiesce_telemetry_t *twice = &other.out.telemetry;
    TEST_ASSERT_INT32_WITHIN(2, 2 * once->accel_um_s2, twice->accel_um_s2);
    TEST_ASSERT_INT32_WITHIN(2, 2 * once->velocity_um_s, twice->velocity_um_s);
    TEST_ASSERT_INT32_WITHIN(16, 2 * once->rms_um_s2, twice->rms_um_s2);
    if ((once->freq_is_valid & twice->freq_is_valid) != 0) {
        quiesce_peak_t doubled = dominant_of(once);
        doubled.amp_um_s2 *= 2;
        check_component(doubled, dominant_of(twice));
        TEST_ASSERT_INT32_WITHIN(40, 2 * once->displacement_nm, twice->displacement_nm);
        TEST_ASSERT_INT32_WITHIN(40, 2 * once->displacement_amp_nm, twice->displacement_amp_nm);
        TEST_ASSERT_INT32_WITHIN(40, 2 * once->velocity_rms_um_s, twice->velocity_rms_um_s);
    }
}

static void test_doubled_input_doubles_amplitudes_and_leaves_frequencies(void) {
    for (uint32_t k = 0; k < 4; k++) {
        other.gain = 2;
        start(rates_Hz[k]);
        TEST_ASSERT_TRUE(run_both((uint32_t)rates_Hz[k], check_doubled) > (uint32_t)rates_Hz[k]);
    }
}

// Negated input: everything that has a sign turns round, but for rounding; phases turn by half a
// turn; the rest stays.
static void check_negated(void) {
    const quiesce_telemetry_t *t = &plain.out.telemetry;
    const quiesce_telemetry_t *negated = &other.out.telemetry;
    TEST_ASSERT_INT32_WITHIN(1, -t->accel_um_s2, negated->accel_um_s2);
    TEST_ASSERT_INT32_WITHIN(2, -t->velocity_um_s, negated->velocity_um_s);
    TEST_ASSERT_INT32_WITHIN(6, t->rms_um_s2, negated->rms_um_s2);
    TEST_ASSERT_INT32_WITHIN(20, -t->displacement_nm, negated->displacement_nm);
    TEST_ASSERT_EQUAL_UINT32(t->freq_is_valid, negated->freq_is_valid);
    if (t->freq_is_valid != 0) {
        quiesce_peak_t turned = dominant_of(t);
        turned.phase_mdeg += 180000;
        check_component(turned, dominant_of(negated));
    }
}

static void test_negated_input_turns_phases_and_signs_only(void) {
    for (uint32_t k = 0; k < 4; k++) {
        other.gain = -1;
        start(rates_Hz[k]);
        TEST_ASSERT_TRUE(run_both((uint32_t)rates_Hz[k], check_negated) > (uint32_t)rates_Hz[k]);
    }
}

static void check_equal(void) {
    TEST_ASSERT_EQUAL_MEMORY(&plain.out, &other.out, sizeof plain.out);
}

static void test_polarity_undoes_a_negated_input_exactly(void) {
    other.gain = -1;
    other.params.accel_polarity = -1;
    start(1000);
    TEST_ASSERT_TRUE(run_both(1000, check_equal) > 1000u);
}

// What counts since the start differs by the delay; everything else is the same.
static void forget_the_past(quiesce_telemetry_t *t) {
    t->tick = 0;
    t->bad_sample_count = 0;
    t->freq_age_ticks = t->freq_is_valid != 0 ? t->freq_age_ticks : 0;
}

static void check_equal_later(void) {
    quiesce_telemetry_t early = plain.out.telemetry;
    quiesce_telemetry_t late = other.out.telemetry;
    forget_the_past(&early);
    forget_the_past(&late);
    TEST_ASSERT_EQUAL_MEMORY(&early, &late, sizeof early);
}

// Other delays meet other entries of the trigonometric tables: their rounding, and nothing else.
static void check_alike_later(void) {
    const quiesce_telemetry_t *early = &plain.out.telemetry;
    const quiesce_telemetry_t *late = &other.out.telemetry;
    TEST_ASSERT_EQUAL_UINT32(early->state, late->state);
    TEST_ASSERT_EQUAL_INT32(early->accel_um_s2, late->accel_um_s2);
    TEST_ASSERT_EQUAL_INT32(early->velocity_um_s, late->velocity_um_s);
    TEST_ASSERT_EQUAL_INT32(early->rms_um_s2, late->rms_um_s2);
    TEST_ASSERT_EQUAL_UINT32(early->freq_is_valid, late->freq_is_valid);
    TEST_ASSERT_EQUAL_UINT32(early->freq_window_ms, late->freq_window_ms);
    TEST_ASSERT_INT32_WITHIN(2, early->current_cmd_mA, late->current_cmd_mA);
    TEST_ASSERT_INT32_WITHIN(20, early->displacement_nm, late->displacement_nm);
    check_component(dominant_of(early), dominant_of(late));
    for (uint32_t i = 0; i < QUIESCE_PEAKS; i++) {
        check_component(early->peaks[i], late->peaks[i]);
    }
}

// Delayed by so many periods of the decimated rate, no sample before.
static void run_delayed(uint32_t periods, uint32_t rate_Hz, void (*check)(void)) {
    start((int32_t)rate_Hz);
    step_without_sample(&plain, rate_Hz);
    step_without_sample(&other, rate_Hz + periods * rate_Hz / DECIMATED_RATE_Hz);
    TEST_ASSERT_TRUE(run_both(rate_Hz, check) > rate_Hz);
}

static void test_delayed_input_gives_the_same_output_later(void) {
    for (uint32_t k = 0; k < 4; k++) {
        run_delayed(1, (uint32_t)rates_Hz[k], check_alike_later);
        run_delayed(256, (uint32_t)rates_Hz[k], check_equal_later); // the ring of the windows
    }
    run_delayed(50, 1000, check_alike_later);
    run_delayed(512, 1000, check_equal_later);
}

// The largest acceleration there is, for longer than the longest window, at the highest rate.
static void test_full_scale_overflows_nothing(void) {
    plain.params.accel_scale_nm_s2 = 59604; // full scale is 500 m/s2, the most there is
    plain.params.rms_window_ms = 4000;
    plain.params.velocity_cutoff_mHz = 50;
    plain.params.sensor_stuck_ticks = 0;
    start(4000);
    for (uint32_t i = 0; i < 9u * 4000u; i++) {
        const bool is_high = i / 400u % 2u != 0; // 5 Hz
        step(&plain, is_high ? FULL_SCALE - 1 : 1 - FULL_SCALE, true);
        TEST_ASSERT_TRUE(plain.out.telemetry.rms_um_s2 <= 500000000);
    }
    const quiesce_telemetry_t *t = &plain.out.telemetry;
    TEST_ASSERT_INT32_WITHIN(5000000, 490000000, t->rms_um_s2);
    TEST_ASSERT_EQUAL_UINT32(1, t->freq_is_valid);
    TEST_ASSERT_INT32_WITHIN(10000, 5000000, t->freq_uHz);
    // The fundamental of a square wave: 4/pi of it.
    TEST_ASSERT_INT32_WITHIN(10000000, 636619772, t->freq_amp_um_s2);
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(test_doubled_input_doubles_amplitudes_and_leaves_frequencies);
    RUN_TEST(test_negated_input_turns_phases_and_signs_only);
    RUN_TEST(test_polarity_undoes_a_negated_input_exactly);
    RUN_TEST(test_delayed_input_gives_the_same_output_later);
    RUN_TEST(test_full_scale_overflows_nothing);
    return UNITY_END();
}
