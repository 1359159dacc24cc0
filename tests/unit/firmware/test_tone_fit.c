#include "tone_fit.h"

#include "test_signal.h"
#include "unity.h"

#define BIN_TURN(log2) (1u << (32u - (log2))) // a cycle a window
#define MICRO_HERTZ 17                        // at 250 Hz, in turns a sample
#define DEGREE_TURN (UINT32_MAX / 360u)

enum { RING = 512, LARGE = 10000000, MOST_CALLS = 5 };

// A component of the test signal; its phase is that in the middle of the window.
typedef struct {
    uint32_t turn;
    uint32_t phase_turn;
    int32_t amp_um_s2;
} component_t;

static tone_fit_t fit;
static int32_t ring[RING];
static tone_fit_window_t window;
static uint32_t seed;
static uint32_t pairs; // a slice

void setUp(void) {
    seed = 1;
    pairs = 20;
    tone_fit_init(&fit);
}
void tearDown(void) {}

static uint32_t points(void) {
    return 1u << window.points_log2;
}

// Any 32 bits.
static uint32_t any(void) {
    return ((uint32_t)signal_noise(&seed, INT32_MAX) << 16) ^
           (uint32_t)signal_noise(&seed, INT32_MAX);
}

// 0 .. below - 1.
static uint32_t any_below(uint32_t below) {
    return (uint32_t)(((uint64_t)any() * below) >> 32);
}

// A window anywhere in the ring; what lies outside is at full scale.
static void set_window(uint32_t points_log2) {
    window = (tone_fit_window_t){
        .ring = ring,
        .ring_mask = RING - 1,
        .newest = any_below(RING),
        .points_log2 = points_log2,
        .size_um_s2 = 2 * LARGE,
    };
    for (uint32_t i = 0; i < RING; i++) {
        ring[i] = signal_noise(&seed, 500000000);
    }
}

static int32_t *sample(uint32_t n) {
    return &ring[(window.newest - points() + 1u + n) % RING];
}

static int32_t value_at(const component_t *tone, uint32_t n) {
    const int64_t half_steps = 2 * (int64_t)n + 1 - (int64_t)points();
    return signal_cosine(tone->amp_um_s2,
                         tone->phase_turn + (uint32_t)(((int64_t)tone->turn * half_steps) / 2));
}

static void fill(const component_t *tones, uint32_t count, int32_t constant, int32_t sigma) {
    int64_t sum = 0;
    for (uint32_t n = 0; n < points(); n++) {
        int32_t value = constant + (sigma == 0 ? 0 : signal_normal(&seed, sigma));
        for (uint32_t i = 0; i < count; i++) {
            value += value_at(&tones[i], n);
        }
        *sample(n) = value;
        sum += value;
    }
    window.mean_um_s2 = (int32_t)(sum / (int64_t)points());
}

static void finish(void) {
    for (uint32_t i = 0; !tone_fit_step(&fit, pairs); i++) {
        TEST_ASSERT_TRUE(i < 4000);
    }
}

static void gather(void) {
    tone_fit_start(&fit, &window);
    finish();
}

// Fits the gathered window, each call from where the one before it ended.
static void refine(const uint32_t *starts, uint32_t count, bool has_drift, uint32_t calls) {
    uint32_t turns[TONE_FIT_TONES] = {0};
    for (uint32_t i = 0; i < count; i++) {
        turns[i] = starts[i];
    }
    for (uint32_t call = 0; call < calls; call++) {
        tone_fit_set(&fit, turns, count, has_drift);
        finish();
        for (uint32_t i = 0; i < count; i++) {
            turns[i] = fit.tone[i].turn;
        }
    }
}

static void fit_from(const uint32_t *starts, uint32_t count, bool has_drift, uint32_t calls) {
    gather();
    refine(starts, count, has_drift, calls);
}

static int32_t away(uint32_t turn, uint32_t from) {
    return abs_i32((int32_t)(turn - from));
}

static void assert_tone(const component_t *expected, const tone_t *tone, int32_t most_turn,
                        int32_t most_phase_turn, int32_t most_um_s2) {
    TEST_ASSERT_LESS_OR_EQUAL_INT32(most_turn, away(tone->turn, expected->turn));
    TEST_ASSERT_LESS_OR_EQUAL_INT32(most_phase_turn, away(tone->phase_turn, expected->phase_turn));
    TEST_ASSERT_INT32_WITHIN(most_um_s2, expected->amp_um_s2, tone->amp_um_s2);
}

// A tone of from .. to hundredths of a cycle a window, of any phase.
static component_t any_tone(uint32_t from_hundredths, uint32_t to_hundredths, int32_t amp_um_s2) {
    const uint32_t bin = BIN_TURN(window.points_log2);
    return (component_t){
        .turn = bin / 100u * (from_hundredths + any_below(to_hundredths - from_hundredths)) +
                (any_below(bin / 100u) & ~1u), // even: half a step is exact
        .phase_turn = any(),
        .amp_um_s2 = amp_um_s2,
    };
}

static int32_t tenths_of_bin(int32_t tenths) {
    return (int32_t)(BIN_TURN(window.points_log2) / 10u) * tenths;
}

// 52 Hz in hundredths of a cycle a window.
static uint32_t highest_hundredths(void) {
    return (points() * 5200u) / 250u;
}

static void test_one_tone_to_the_microhertz_in_three_calls(void) {
    for (uint32_t i = 0; i < 400; i++) {
        set_window(5u + i % 4u);
        const component_t tone = any_tone(200, highest_hundredths(), LARGE);
        fill(&tone, 1, 0, 0);
        const uint32_t start = tone.turn + (uint32_t)tenths_of_bin(i & 4u ? 3 : -3);
        fit_from(&start, 1, false, 3);
        assert_tone(&tone, &fit.tone[0], 2 * MICRO_HERTZ, DEGREE_TURN / 10000, 8);
        TEST_ASSERT_LESS_OR_EQUAL_INT32(1 << 20, abs_i32(fit.tone[0].shift_q29));
    }
}

// Little more than a cycle: the image at negative frequency is as near as the tone itself.
static void test_image_does_not_bias_a_tone_of_few_cycles(void) {
    for (uint32_t i = 0; i < 200; i++) {
        set_window(5u + i % 4u);
        const component_t tone = any_tone(120, 200, LARGE);
        fill(&tone, 1, 0, 0);
        const uint32_t start = tone.turn + (uint32_t)tenths_of_bin(2);
        fit_from(&start, 1, false, 4);
        assert_tone(&tone, &fit.tone[0], 3 * MICRO_HERTZ, DEGREE_TURN / 10000, 16);
    }
}

static void test_shift_tells_how_far_the_start_was_off(void) {
    set_window(8);
    const component_t tone = any_tone(1000, 1100, LARGE);
    fill(&tone, 1, 0, 0);
    const uint32_t start = tone.turn - (uint32_t)tenths_of_bin(1) / 2u;
    fit_from(&start, 1, false, 1);
    // 0.05 bins are 0.05 pi radians over half a window, in Q29 (and the error of one call).
    TEST_ASSERT_INT32_WITHIN(84331486 / 50, 84331486, fit.tone[0].shift_q29);
    TEST_ASSERT_LESS_OR_EQUAL_INT32(tenths_of_bin(1) / 100, away(fit.tone[0].turn, tone.turn));
}

// Tones of 1 mm/s2 to full scale; a unit of rounding is what limits the small ones.
static void test_every_amplitude(void) {
    for (int32_t amp = 1000; amp <= 500000000; amp = amp < 100000000 ? amp * 7 : 500000000) {
        for (uint32_t i = 0; i < 40; i++) {
            set_window(5u + i % 4u);
            const component_t tone = any_tone(200, highest_hundredths(), amp);
            fill(&tone, 1, 0, 0);
            window.size_um_s2 = (uint32_t)amp;
            const uint32_t start = tone.turn + (uint32_t)tenths_of_bin(1);
            fit_from(&start, 1, false, 3);
            // Half a unit in the worst arrangement, in 32 samples: 1 / (4 amp) of a bin.
            const int32_t most = tenths_of_bin(10) / 4 / amp + 2 * MICRO_HERTZ;
            const int32_t most_phase = (1 << 30) / amp + (int32_t)DEGREE_TURN / 10000;
            assert_tone(&tone, &fit.tone[0], most, most_phase, 2 + amp / 1000000);
            TEST_ASSERT_GREATER_THAN_UINT32(65500, fit.explained_q16);
        }
        if (amp == 500000000) {
            break;
        }
    }
}

static void test_wrong_guess_of_the_size_does_no_harm(void) {
    static const uint32_t guesses[] = {0, 1, 300, 1u << 20, 1u << 24, 1u << 29, UINT32_MAX};
    set_window(7);
    const component_t tone = any_tone(500, 600, 1234567);
    fill(&tone, 1, -9876543, 0);
    for (uint32_t i = 0; i < sizeof guesses / sizeof guesses[0]; i++) {
        window.size_um_s2 = guesses[i];
        fit_from(&tone.turn, 1, false, 2);
        assert_tone(&tone, &fit.tone[0], 2 * MICRO_HERTZ, DEGREE_TURN / 10000, 3);
        TEST_ASSERT_INT32_WITHIN(3, -9876543, fit.constant_um_s2);
    }
}

static void test_constant_part_is_found_and_does_no_harm(void) {
    for (uint32_t i = 0; i < 40; i++) {
        set_window(5u + i % 4u);
        const component_t tone = any_tone(150, 400, 30000000);
        const int32_t constant = i & 4u ? 500000000 : -500000000;
        fill(&tone, 1, constant, 0);
        window.mean_um_s2 += signal_noise(&seed, 1000000); // it is known roughly only
        const uint32_t start = tone.turn + (uint32_t)tenths_of_bin(1);
        fit_from(&start, 1, false, 3);
        assert_tone(&tone, &fit.tone[0], 4 * MICRO_HERTZ, DEGREE_TURN / 2000, 100);
        TEST_ASSERT_INT32_WITHIN(100, constant, fit.constant_um_s2);
        TEST_ASSERT_EQUAL_INT32(fit.constant_um_s2, fit.end_um_s2);
        TEST_ASSERT_EQUAL_INT32(0, fit.slope_um_s2);
        TEST_ASSERT_EQUAL_INT32(0, fit.bend_um_s2);
    }
}

// Components as far apart, in hundredths of a cycle a window; amplitudes up to three times
// different.
static void make_tones(component_t *tones, uint32_t count, uint32_t gap_hundredths) {
    const uint32_t hundredth = (BIN_TURN(window.points_log2) / 100u) & ~1u;
    for (uint32_t i = 0; i < count; i++) {
        tones[i] = any_tone(300, 900, LARGE + signal_noise(&seed, LARGE / 2));
        tones[i].turn = tones[0].turn + i * gap_hundredths * hundredth;
    }
}

static void check_several(uint32_t count, uint32_t gap_hundredths, int32_t off, uint32_t calls,
                          int32_t most_turn) {
    component_t tones[TONE_FIT_TONES];
    uint32_t starts[TONE_FIT_TONES];
    make_tones(tones, count, gap_hundredths);
    fill(tones, count, 5000000, 0);
    for (uint32_t i = 0; i < count; i++) {
        starts[i] = tones[i].turn + (uint32_t)(any_below(2) == 0 ? off : -off);
    }
    fit_from(starts, count, false, calls);
    for (uint32_t i = 0; i < count; i++) {
        assert_tone(&tones[i], &fit.tone[i], most_turn, DEGREE_TURN / 2000, 40);
    }
}

static void test_two_and_three_tones_two_bins_apart(void) {
    for (uint32_t i = 0; i < 100; i++) {
        set_window(6u + i % 3u);
        check_several(2, 200, tenths_of_bin(1), 4, 4 * MICRO_HERTZ);
        set_window(7u + i % 2u);
        check_several(3, 200, tenths_of_bin(1), 4, 4 * MICRO_HERTZ);
    }
}

static void test_two_tones_one_bin_apart(void) {
    for (uint32_t i = 0; i < 100; i++) {
        set_window(7u + i % 2u);
        check_several(2, 100, tenths_of_bin(1) / 2, MOST_CALLS, 40 * MICRO_HERTZ);
    }
}

static void test_third_harmonic_and_fundamental(void) {
    for (uint32_t i = 0; i < 60; i++) {
        set_window(8);
        component_t tones[2] = {any_tone(150, 1300, 500000), any_tone(200, 300, 900000)};
        tones[1].turn = 3u * tones[0].turn;
        fill(tones, 2, 0, 0);
        const uint32_t starts[2] = {tones[0].turn + (uint32_t)tenths_of_bin(1),
                                    tones[1].turn - (uint32_t)tenths_of_bin(1)};
        fit_from(starts, 2, false, 3);
        for (uint32_t k = 0; k < 2; k++) {
            assert_tone(&tones[k], &fit.tone[k], 4 * MICRO_HERTZ, DEGREE_TURN / 2000, 4);
        }
    }
}

// Half a cycle a window, the very shape of the slot: cos and sin about the middle, 20 and 10 m/s2,
// on a constant of 3 m/s2. At the window's end the cosine is 0 and falls by pi / 2 of it in half a
// window, the sine is at its top.
static void test_drift_slot_takes_a_drift(void) {
    for (uint32_t i = 0; i < 60; i++) {
        set_window(6u + i % 3u);
        const component_t tones[3] = {
            any_tone(300, 400, LARGE),
            {BIN_TURN(window.points_log2) / 2u, 0, 2 * LARGE},
            {BIN_TURN(window.points_log2) / 2u, UINT32_C(3) << 30, LARGE},
        };
        fill(tones, 3, 3000000, 0);
        window.size_um_s2 = 5 * LARGE;
        const uint32_t start = tones[0].turn + (uint32_t)tenths_of_bin(1);
        fit_from(&start, 1, true, 3);
        assert_tone(&tones[0], &fit.tone[0], 40 * MICRO_HERTZ, DEGREE_TURN / 100, 1000);
        TEST_ASSERT_INT32_WITHIN(LARGE / 100, 3000000, fit.constant_um_s2);
        TEST_ASSERT_INT32_WITHIN(LARGE / 500, 3000000 + LARGE, fit.end_um_s2);
        TEST_ASSERT_INT32_WITHIN(LARGE / 100, -31415927, fit.slope_um_s2);
        // Without the slot the drift spoils the tone.
        refine(&start, 1, false, 1);
        TEST_ASSERT_GREATER_THAN_INT32(LARGE / 10, fit.residual_um_s2);
    }
}

// A ramp of 4 m/s2 a window and a tone ten times smaller.
static void test_drift_slot_follows_a_ramp(void) {
    set_window(8);
    const component_t tone = any_tone(500, 600, 400000);
    fill(&tone, 1, 0, 0);
    for (uint32_t n = 0; n < points(); n++) {
        *sample(n) += (int32_t)(2u * n + 1u - points()) * (4000000 / 512);
    }
    const uint32_t start = tone.turn + (uint32_t)tenths_of_bin(1);
    fit_from(&start, 1, true, 3);
    TEST_ASSERT_LESS_OR_EQUAL_INT32(tenths_of_bin(1) / 10, away(fit.tone[0].turn, tone.turn));
    TEST_ASSERT_INT32_WITHIN(20000, 400000, fit.tone[0].amp_um_s2);
    TEST_ASSERT_INT32_WITHIN(100000, 2000000, fit.end_um_s2);
    TEST_ASSERT_INT32_WITHIN(400000, 2000000, fit.slope_um_s2);
    TEST_ASSERT_GREATER_THAN_INT32(0, fit.bend_um_s2);
    TEST_ASSERT_LESS_THAN_INT32(500000, fit.bend_um_s2);
}

// White noise of known deviation in 400 windows: the residual, the share that is explained, and
// the spread of the frequency beside the one that the fit expects.
static void test_residual_and_sigma_of_white_noise(void) {
    enum { TRIALS = 400, SIGMA = 500000, AMP = 5000000 };
    for (uint32_t log2 = 6; log2 <= 8; log2 += 2) {
        int64_t residuals = 0;
        int64_t sigmas = 0;
        int64_t squares = 0;
        int64_t shares = 0;
        for (uint32_t i = 0; i < TRIALS; i++) {
            set_window(log2);
            const component_t tone = any_tone(300, 1200, AMP);
            fill(&tone, 1, 0, SIGMA);
            fit_from(&tone.turn, 1, false, 2);
            const int64_t off = away(fit.tone[0].turn, tone.turn);
            squares += off * off;
            sigmas += fit.tone[0].sigma_turn;
            residuals += fit.residual_um_s2;
            shares += fit.explained_q16;
        }
        const int32_t sigma_turn = (int32_t)(sigmas / TRIALS);
        TEST_ASSERT_INT32_WITHIN(SIGMA / 50, SIGMA, (int32_t)(residuals / TRIALS));
        TEST_ASSERT_INT32_WITHIN(sigma_turn / 10, sigma_turn,
                                 (int32_t)isqrt_u64((uint64_t)(squares / TRIALS)));
        // sigma / amp sqrt(24 / N^3) / 2 pi, in turns Q32.
        const int32_t bound = log2 == 6 ? 654050 : 81757;
        TEST_ASSERT_INT32_WITHIN(bound / 10, bound, sigma_turn);
        // The tone's energy is fifty times the noise's, of which the fit takes some.
        TEST_ASSERT_INT32_WITHIN(200, 65536 / 51 * 50, (int32_t)(shares / TRIALS));
    }
}

// The share counts from the samples' own mean, however roughly that was known.
static void test_share_does_not_depend_on_the_guess_of_the_mean(void) {
    set_window(8);
    const component_t tone = any_tone(500, 600, 1000000);
    fill(&tone, 1, 3000000, 1000000);
    fit_from(&tone.turn, 1, false, 1);
    const uint32_t share_q16 = fit.explained_q16;
    const int32_t residual_um_s2 = fit.residual_um_s2;
    TEST_ASSERT_UINT32_WITHIN(6554, 65536 / 3, share_q16); // half of A^2 over sigma^2
    window.mean_um_s2 -= 4000000;
    fit_from(&tone.turn, 1, false, 1);
    TEST_ASSERT_UINT32_WITHIN(20, share_q16, fit.explained_q16);
    TEST_ASSERT_INT32_WITHIN(1000, residual_um_s2, fit.residual_um_s2);
}

// Of a signal without noise the residual is no larger than the system's own accuracy.
static void test_exact_tone_leaves_next_to_nothing(void) {
    for (uint32_t i = 0; i < 100; i++) {
        set_window(5u + i % 4u);
        const component_t tone = any_tone(200, highest_hundredths(), LARGE);
        fill(&tone, 1, 0, 0);
        fit_from(&tone.turn, 1, false, 2);
        TEST_ASSERT_LESS_OR_EQUAL_INT32(LARGE / 2000, fit.residual_um_s2);
        TEST_ASSERT_GREATER_OR_EQUAL_UINT32(65520, fit.explained_q16);
    }
}

static void test_slices_of_any_size_give_the_same_bits(void) {
    static const uint32_t sizes[] = {1, 2, 7, 33, 1000};
    for (uint32_t log2 = 5; log2 <= 8; log2++) {
        set_window(log2);
        component_t tones[3];
        uint32_t starts[3];
        make_tones(tones, 3, 200);
        fill(tones, 3, 777, 100000);
        for (uint32_t k = 0; k < 3; k++) {
            starts[k] = tones[k].turn;
        }
        pairs = 20;
        fit_from(starts, 3, true, 2);
        const tone_fit_t first = fit;
        for (uint32_t i = 0; i < sizeof sizes / sizeof sizes[0]; i++) {
            pairs = sizes[i];
            tone_fit_init(&fit);
            fit_from(starts, 3, true, 2);
            TEST_ASSERT_EQUAL_MEMORY(first.tone, fit.tone, sizeof fit.tone);
            TEST_ASSERT_EQUAL_INT32(first.residual_um_s2, fit.residual_um_s2);
            TEST_ASSERT_EQUAL_INT32(first.constant_um_s2, fit.constant_um_s2);
            TEST_ASSERT_EQUAL_INT32(first.end_um_s2, fit.end_um_s2);
            TEST_ASSERT_EQUAL_INT32(first.slope_um_s2, fit.slope_um_s2);
            TEST_ASSERT_EQUAL_UINT32(first.explained_q16, fit.explained_q16);
        }
    }
}

static void test_same_amplitudes_whatever_the_polarity_and_the_order(void) {
    set_window(8);
    component_t tones[2];
    make_tones(tones, 2, 300);
    fill(tones, 2, 0, 0);
    fit_from((uint32_t[]){tones[0].turn, tones[1].turn}, 2, false, 2);
    const tone_t first[2] = {fit.tone[0], fit.tone[1]};
    fit_from((uint32_t[]){tones[1].turn, tones[0].turn}, 2, false, 2);
    for (uint32_t n = 0; n < points(); n++) {
        *sample(n) = -*sample(n);
    }
    window.mean_um_s2 = -window.mean_um_s2;
    gather();
    refine((uint32_t[]){tones[1].turn, tones[0].turn}, 2, false, 2);
    for (uint32_t k = 0; k < 2; k++) {
        const component_t expected = {first[k].turn, first[k].phase_turn + (1u << 31),
                                      first[k].amp_um_s2};
        assert_tone(&expected, &fit.tone[1u - k], MICRO_HERTZ, DEGREE_TURN / 10000, 8);
    }
}

static void test_silence_has_no_amplitude(void) {
    for (uint32_t log2 = 5; log2 <= 8; log2++) {
        set_window(log2);
        fill(NULL, 0, 123456789, 0);
        const uint32_t start = 3u * BIN_TURN(log2);
        fit_from(&start, 1, log2 & 1u, 2);
        TEST_ASSERT_EQUAL_INT32(0, fit.tone[0].amp_um_s2);
        TEST_ASSERT_EQUAL_INT32(0, fit.residual_um_s2);
        TEST_ASSERT_EQUAL_INT32(123456789, fit.constant_um_s2);
        TEST_ASSERT_EQUAL_UINT32(UINT32_MAX, fit.tone[0].sigma_turn);
    }
}

// Whatever is fed, from wherever it starts: it ends, and its figures are in their ranges.
static void test_any_samples_end_within_range(void) {
    for (uint32_t i = 0; i < 300; i++) {
        set_window(5u + i % 4u);
        const int32_t span = 536870911 >> (i % 30u);
        for (uint32_t n = 0; n < points(); n++) {
            *sample(n) = i % 3u == 0 ? (any() & 1u ? span : -span) : signal_noise(&seed, span);
        }
        window.mean_um_s2 = signal_noise(&seed, span);
        window.size_um_s2 = any();
        const uint32_t count = 1u + i % 3u;
        uint32_t starts[TONE_FIT_TONES];
        for (uint32_t k = 0; k < count; k++) {
            starts[k] = (uint32_t)tenths_of_bin(3) + any_below(1u << 30);
        }
        starts[count - 1u] = i % 5u == 0 ? starts[0] : starts[count - 1u];
        fit_from(starts, count, i & 8u, 3);
        for (uint32_t k = 0; k < count; k++) {
            TEST_ASSERT_GREATER_OR_EQUAL_INT32(0, fit.tone[k].amp_um_s2);
            TEST_ASSERT_LESS_OR_EQUAL_INT32(843314856, abs_i32(fit.tone[k].shift_q29));
        }
        TEST_ASSERT_GREATER_OR_EQUAL_INT32(0, fit.residual_um_s2);
        TEST_ASSERT_GREATER_OR_EQUAL_INT32(0, fit.bend_um_s2);
        TEST_ASSERT_LESS_OR_EQUAL_UINT32(65536, fit.explained_q16);
    }
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(test_one_tone_to_the_microhertz_in_three_calls);
    RUN_TEST(test_image_does_not_bias_a_tone_of_few_cycles);
    RUN_TEST(test_shift_tells_how_far_the_start_was_off);
    RUN_TEST(test_every_amplitude);
    RUN_TEST(test_wrong_guess_of_the_size_does_no_harm);
    RUN_TEST(test_constant_part_is_found_and_does_no_harm);
    RUN_TEST(test_two_and_three_tones_two_bins_apart);
    RUN_TEST(test_two_tones_one_bin_apart);
    RUN_TEST(test_third_harmonic_and_fundamental);
    RUN_TEST(test_drift_slot_takes_a_drift);
    RUN_TEST(test_drift_slot_follows_a_ramp);
    RUN_TEST(test_residual_and_sigma_of_white_noise);
    RUN_TEST(test_share_does_not_depend_on_the_guess_of_the_mean);
    RUN_TEST(test_exact_tone_leaves_next_to_nothing);
    RUN_TEST(test_slices_of_any_size_give_the_same_bits);
    RUN_TEST(test_same_amplitudes_whatever_the_polarity_and_the_order);
    RUN_TEST(test_silence_has_no_amplitude);
    RUN_TEST(test_any_samples_end_within_range);
    return UNITY_END();
}
