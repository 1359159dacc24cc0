#include "half_cycles.h"

#include "test_signal.h"
#include "unity.h"

enum { AMP_um_s = 10000, DEGREE_TURN = 11930465 };

static half_cycles_t half_cycles;
static half_cycles_tone_t tone;
static uint32_t rate_Hz;
static uint32_t phase; // of the acceleration
static uint32_t step;
static int32_t amp, third, offset, noise;
static uint32_t seed;

static void start(uint32_t rate, uint32_t freq_mHz) {
    half_cycles = (half_cycles_t){0};
    half_cycles_reset(&half_cycles);
    rate_Hz = rate;
    phase = 1000000000u;
    step = (uint32_t)(((uint64_t)freq_mHz << 32) / (1000u * rate));
    amp = AMP_um_s;
    third = 0;
    offset = 0;
    noise = 0;
    seed = 1;
}

void setUp(void) {
    start(1000, 10000);
}
void tearDown(void) {}

// The velocity of an acceleration a cos(phase) is proportional to sin(phase).
static bool tick(void) {
    phase += step;
    const int32_t velocity = signal_cosine(amp, phase - 90u * DEGREE_TURN) +
                             signal_cosine(third, 3u * phase) + offset +
                             signal_normal(&seed, noise);
    return half_cycles_step(&half_cycles, velocity, &tone);
}

static uint32_t half_ticks(uint32_t count) {
    return (uint32_t)(((uint64_t)count << 31) / step);
}

static uint32_t count_found(uint32_t ticks) {
    uint32_t found = 0;
    for (; ticks > 0; ticks--) {
        found += tick() ? 1u : 0u;
    }
    return found;
}

static void assert_tones(uint32_t halves, uint32_t degrees, uint32_t per_mille) {
    uint32_t found = 0;
    for (uint32_t i = 0; i < half_ticks(halves); i++) {
        if (tick()) {
            found++;
            const int32_t off =
                (int32_t)(half_cycles_phase_turn(&tone, half_cycles_step_turn(&tone)) - phase);
            TEST_ASSERT_INT32_WITHIN(degrees * DEGREE_TURN, 0, off);
            TEST_ASSERT_UINT32_WITHIN(step / 1000u * per_mille, step, half_cycles_step_turn(&tone));
        }
    }
    TEST_ASSERT_UINT32_WITHIN(1, halves, found);
}

static void test_half_cycles_of_a_sine_at_every_rate(void) {
    const uint32_t rates_Hz[] = {500, 1000, 2000, 4000};
    const uint32_t freqs_mHz[] = {1000, 4000, 7300, 10000, 22000, 50000};
    for (uint32_t r = 0; r < 4u; r++) {
        for (uint32_t f = 0; f < 6u; f++) {
            start(rates_Hz[r], freqs_mHz[f]);
            count_found(half_ticks(5));
            assert_tones(20, 3, 20);
        }
    }
}

// The first half begins anywhere and does not count; the next three do.
static void test_half_cycles_are_found_within_two_cycles(void) {
    for (uint32_t part = 0; part < 12u; part++) {
        setUp();
        phase = part * 30u * DEGREE_TURN;
        TEST_ASSERT_EQUAL_UINT32(0, count_found(half_ticks(2) - 1u));
        TEST_ASSERT_GREATER_THAN_UINT32(0, count_found(half_ticks(2) + 2u));
    }
}

static void test_half_cycles_after_a_step_of_frequency(void) {
    for (uint32_t part = 0; part < 12u; part++) {
        setUp();
        count_found(half_ticks(10) + part * 8u);
        step *= 2u;
        count_found(half_ticks(5));
        assert_tones(10, 3, 20);
    }
}

// Halves of 98 and 82 degrees less: 30 % of offset makes them 215 and 145 degrees long.
static void test_half_cycles_period_with_an_offset(void) {
    for (int32_t sign = -1; sign <= 1; sign += 2) {
        setUp();
        offset = sign * AMP_um_s / 10 * 3;
        count_found(half_ticks(6));
        assert_tones(20, 20, 20);
    }
}

static void test_half_cycles_in_noise_cross_once(void) {
    start(4000, 10000); // 157 um/s a tick at a crossing, noise of 250
    noise = AMP_um_s / 40;
    count_found(half_ticks(6));
    assert_tones(60, 8, 60);
}

static void test_half_cycles_with_a_third_harmonic(void) {
    third = AMP_um_s / 10;
    count_found(half_ticks(6));
    assert_tones(20, 8, 20);
}

// From half to half as 3 to 5: nothing is alike.
static void test_half_cycles_that_differ_say_nothing(void) {
    uint32_t found = 0;
    for (uint32_t half = 0; half < 40u; half++) {
        const uint32_t ticks = half % 4u < 2u ? 30u : 50u;
        for (uint32_t i = 0; i < ticks; i++) {
            const int32_t size =
                signal_cosine(AMP_um_s, i * (UINT32_C(1) << 31) / ticks - 90u * DEGREE_TURN) + 1;
            found += half_cycles_step(&half_cycles, half % 2u == 0 ? size : -size, &tone) ? 1u : 0u;
        }
    }
    TEST_ASSERT_EQUAL_UINT32(0, found);
}

static void test_half_cycles_of_silence_and_of_a_constant(void) {
    amp = 0;
    TEST_ASSERT_EQUAL_UINT32(0, count_found(30000));
    offset = -500;
    TEST_ASSERT_EQUAL_UINT32(0, count_found(30000));
    offset = 500;
    TEST_ASSERT_EQUAL_UINT32(0, count_found(30000));
}

static void test_half_cycles_reset_forgets(void) {
    count_found(half_ticks(8) + 3u);
    half_cycles_reset(&half_cycles);
    TEST_ASSERT_EQUAL_UINT32(0, count_found(half_ticks(2)));
    count_found(half_ticks(4));
    assert_tones(10, 3, 20);
}

static void test_half_cycles_survive_extreme_velocities(void) {
    for (uint32_t i = 0; i < 5000u; i++) {
        const uint32_t kind = (uint32_t)abs_i32(signal_noise(&seed, 5));
        const int32_t any[] = {INT32_MAX, INT32_MIN, 0, 1, -1, signal_noise(&seed, INT32_MAX)};
        if (half_cycles_step(&half_cycles, any[kind], &tone)) {
            TEST_ASSERT_NOT_EQUAL(0, half_cycles_step_turn(&tone));
        }
    }
}

static void test_half_cycles_last_on_through_lost_ticks(void) {
    uint32_t found = 0;
    for (uint32_t i = 0; i < 3000; i++) {
        if (i % 97 == 50) {
            phase += step;
            half_cycles_skip(&half_cycles, 1);
        }
        found += tick() ? 1u : 0u;
    }
    // 20 a second, less those that have no two before them.
    TEST_ASSERT_UINT32_WITHIN(4, 60, found);
    TEST_ASSERT_UINT32_WITHIN(step / 50u, step, half_cycles_step_turn(&tone));
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(test_half_cycles_of_a_sine_at_every_rate);
    RUN_TEST(test_half_cycles_are_found_within_two_cycles);
    RUN_TEST(test_half_cycles_after_a_step_of_frequency);
    RUN_TEST(test_half_cycles_period_with_an_offset);
    RUN_TEST(test_half_cycles_in_noise_cross_once);
    RUN_TEST(test_half_cycles_with_a_third_harmonic);
    RUN_TEST(test_half_cycles_that_differ_say_nothing);
    RUN_TEST(test_half_cycles_of_silence_and_of_a_constant);
    RUN_TEST(test_half_cycles_reset_forgets);
    RUN_TEST(test_half_cycles_survive_extreme_velocities);
    RUN_TEST(test_half_cycles_last_on_through_lost_ticks);
    return UNITY_END();
}
