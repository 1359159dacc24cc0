#include "harmonics.h"

#include "test_signal.h"
#include "unity.h"

#define TICKS 1000u
#define DEGREE UINT32_C(11930465) // a turn / 360

typedef struct {
    int32_t first, third, constant; // um/s2
    uint32_t first_turn, third_turn;
} tone_t;

void setUp(void) {}
void tearDown(void) {}

static int32_t value_of(const tone_t *tone, uint32_t phase) {
    return tone->constant + signal_cosine(tone->first, phase + tone->first_turn) +
           signal_cosine(tone->third, 3u * phase + tone->third_turn);
}

static void take_at(harmonic_sums_t *sums, int32_t accel, uint32_t phase) {
    harmonic_sums_take(sums, accel, harmonic_wave(phase), harmonic_wave(3u * phase));
}

// Seven whole cycles.
static harmonic_sums_t sums_of(const tone_t *tone) {
    harmonic_sums_t sums = {0};
    for (uint32_t i = 0; i < TICKS; i++) {
        const uint32_t phase = (uint32_t)((UINT64_C(7) << 32) * i / TICKS);
        take_at(&sums, value_of(tone, phase), phase);
    }
    return sums;
}

// amp x cos(phase + lead) is amp cos(lead) cos(phase) - amp sin(lead) sin(phase).
static void assert_parts(const tone_t *tone, int32_t tolerance) {
    const harmonic_sums_t sums = sums_of(tone);
    const int32_t expected[HARMONIC_PRODUCTS] = {
        signal_cosine(tone->first, tone->first_turn),
        signal_cosine(tone->first, tone->first_turn + 90u * DEGREE),
        signal_cosine(tone->third, tone->third_turn),
        signal_cosine(tone->third, tone->third_turn + 90u * DEGREE),
    };
    for (uint32_t i = 0; i < HARMONIC_PRODUCTS; i++) {
        TEST_ASSERT_INT32_WITHIN(tolerance, expected[i], harmonic_part_um_s2(&sums, i));
    }
    TEST_ASSERT_INT32_WITHIN(tolerance, tone->constant, harmonic_mean_um_s2(&sums));
}

static void test_harmonic_wave_at_quarters_of_a_turn(void) {
    const int32_t cosine[] = {32768, 0, -32768, 0};
    for (uint32_t i = 0; i < 4u; i++) {
        const harmonic_wave_t wave = harmonic_wave(i << 30);
        TEST_ASSERT_INT32_WITHIN(1, cosine[i], wave.cos);
        TEST_ASSERT_INT32_WITHIN(1, cosine[(i + 3u) % 4u], wave.sin);
    }
}

static void test_harmonic_parts_of_known_tones(void) {
    for (uint32_t degrees = 0; degrees < 360u; degrees += 45u) {
        assert_parts(&(tone_t){1000000, 0, 0, degrees * DEGREE, 0}, 200);
        assert_parts(&(tone_t){0, 1000000, 0, 0, degrees * DEGREE}, 200);
        assert_parts(&(tone_t){1000000, 300000, -50000, degrees * DEGREE, 77u * DEGREE}, 200);
    }
}

// Where the fundamental alone peaks, and how high.
static void test_harmonic_amplitude_and_peak(void) {
    TEST_ASSERT_EQUAL_UINT32(0, harmonic_amp_um_s2(0, 0));
    TEST_ASSERT_EQUAL_UINT32(5, harmonic_amp_um_s2(3, -4));
    TEST_ASSERT_UINT32_WITHIN(16000, 500000000, harmonic_amp_um_s2(-300000000, 400000000));
    TEST_ASSERT_LESS_OR_EQUAL_UINT32(500000000, harmonic_amp_um_s2(-300000000, 400000000));
    for (uint32_t degrees = 0; degrees < 360u; degrees += 30u) {
        const harmonic_sums_t sums = sums_of(&(tone_t){800000, 0, 0, degrees * DEGREE, 0});
        const int32_t cos = harmonic_part_um_s2(&sums, HARMONIC_COS1);
        const int32_t sin = harmonic_part_um_s2(&sums, HARMONIC_SIN1);
        TEST_ASSERT_UINT32_WITHIN(160, 800000, harmonic_amp_um_s2(cos, sin));
        // cos(phase + lead) is largest at -lead.
        const int32_t off = (int32_t)(harmonic_peak_turn(cos, sin) + degrees * DEGREE);
        TEST_ASSERT_INT32_WITHIN(DEGREE / 50u, 0, off);
    }
}

// The squares are kept in units of 2^12: up to 64 um/s2 are lost, as a root of the mean square.
static void test_harmonic_rms_of_known_tones(void) {
    const harmonic_sums_t both = sums_of(&(tone_t){300000, 400000, 0, 0, 50u * DEGREE});
    TEST_ASSERT_UINT32_WITHIN(30, 353553, harmonic_rms_um_s2(&both)); // 500000 / sqrt(2)
    const harmonic_sums_t constant = sums_of(&(tone_t){0, 0, -123456, 0, 0});
    TEST_ASSERT_UINT32_WITHIN(5, 123456, harmonic_rms_um_s2(&constant));
    TEST_ASSERT_LESS_OR_EQUAL_UINT32(123456, harmonic_rms_um_s2(&constant));
    for (int32_t small = 0; small < 300; small += 7) {
        const harmonic_sums_t sums = sums_of(&(tone_t){0, 0, small, 0, 0});
        const int32_t rms = (int32_t)harmonic_rms_um_s2(&sums);
        TEST_ASSERT_LESS_OR_EQUAL_INT32(small, rms);
        TEST_ASSERT_GREATER_THAN_INT32(small * small - 4096 - 2 * small, rms * rms);
    }
}

static void test_harmonic_sums_of_one_tick(void) {
    harmonic_sums_t sums = {0};
    take_at(&sums, -7000, 0);
    TEST_ASSERT_EQUAL_UINT32(1, sums.ticks);
    TEST_ASSERT_EQUAL_INT32(-14000, harmonic_part_um_s2(&sums, HARMONIC_COS1));
    TEST_ASSERT_EQUAL_INT32(0, harmonic_part_um_s2(&sums, HARMONIC_SIN1));
    TEST_ASSERT_EQUAL_INT32(-7000, harmonic_mean_um_s2(&sums));
}

static void test_harmonic_sums_added_are_those_of_all_ticks(void) {
    harmonic_sums_t all = {0};
    harmonic_sums_t parts[3] = {{0}};
    uint32_t seed = 5;
    for (uint32_t i = 0; i < TICKS; i++) {
        const int32_t accel = signal_noise(&seed, HARMONICS_LARGEST_um_s2);
        const uint32_t phase = i * 40000003u;
        take_at(&all, accel, phase);
        take_at(&parts[i % 7u == 0 ? 0 : 1], accel, phase);
    }
    harmonic_sums_add(&parts[2], &parts[0]);
    harmonic_sums_add(&parts[2], &parts[1]);
    TEST_ASSERT_EQUAL_UINT32(all.ticks, parts[2].ticks);
    TEST_ASSERT_TRUE(all.sum == parts[2].sum);
    TEST_ASSERT_TRUE(all.square == parts[2].square);
    TEST_ASSERT_EQUAL_MEMORY(all.product, parts[2].product, sizeof all.product);
}

// 2^12 ticks of the largest acceleration, constant and as a square wave that follows the phase: its
// fundamental, 4 / pi of it, is beyond the range.
static void test_harmonic_sums_hold_the_largest_acceleration(void) {
    const int32_t largest = HARMONICS_LARGEST_um_s2;
    for (int32_t sign = -1; sign <= 1; sign += 2) {
        harmonic_sums_t constant = {0};
        harmonic_sums_t square = {0};
        for (uint32_t i = 0; i < 4096u; i++) {
            const uint32_t phase = i << 22;
            const int32_t side = signal_cosine(1000, phase + 1u) >= 0 ? sign : -sign;
            take_at(&constant, sign * largest, phase);
            take_at(&square, side * largest, phase);
        }
        TEST_ASSERT_EQUAL_INT32(sign * largest, harmonic_mean_um_s2(&constant));
        TEST_ASSERT_UINT32_WITHIN(20000, largest, harmonic_rms_um_s2(&constant));
        TEST_ASSERT_UINT32_WITHIN(20000, largest, harmonic_rms_um_s2(&square));
        TEST_ASSERT_EQUAL_INT32(sign * largest, harmonic_part_um_s2(&square, HARMONIC_COS1));
        TEST_ASSERT_INT32_WITHIN(largest / 500, -sign * 227854334, // - 4 / (3 pi) of it
                                 harmonic_part_um_s2(&square, HARMONIC_COS3));
    }
}

static void test_harmonic_at_is_the_tone_again(void) {
    const tone_t tone = {500000, 200000, 0, 20u * DEGREE, 200u * DEGREE};
    const harmonic_sums_t sums = sums_of(&tone);
    harmonic_parts_t parts;
    for (uint32_t i = 0; i < HARMONIC_PRODUCTS; i++) {
        parts.um_s2[i] = harmonic_part_um_s2(&sums, i);
    }
    for (uint32_t phase = 0; phase < 360u; phase += 11u) {
        const uint32_t turn = phase * DEGREE;
        TEST_ASSERT_INT32_WITHIN(
            250, value_of(&tone, turn),
            harmonic_at_um_s2(&parts, harmonic_wave(turn), harmonic_wave(3u * turn)));
    }
}

static void test_harmonic_at_saturates(void) {
    const int32_t large = HARMONICS_LARGEST_um_s2;
    const harmonic_wave_t one = harmonic_wave(0);
    const harmonic_parts_t up = {.um_s2 = {large, large, large, large}};
    const harmonic_parts_t down = {.um_s2 = {-large, -large, -large, -large}};
    TEST_ASSERT_EQUAL_INT32(large, harmonic_at_um_s2(&up, one, one));
    TEST_ASSERT_EQUAL_INT32(-large, harmonic_at_um_s2(&down, one, one));
}

static int32_t found_span(int32_t first, int32_t third, uint32_t third_turn) {
    harmonic_span_t span;
    harmonic_span_start(&span, first, third, third_turn);
    for (uint32_t i = 1; i < HARMONIC_SPAN_POINTS / 2u; i++) {
        TEST_ASSERT_FALSE(harmonic_span_step(&span));
    }
    TEST_ASSERT_TRUE(harmonic_span_step(&span));
    const int32_t largest = span.largest;
    TEST_ASSERT_FALSE(harmonic_span_step(&span)); // finished before
    TEST_ASSERT_EQUAL_INT32(largest, span.largest);
    return largest;
}

static int32_t finest_span(int32_t first, int32_t third, uint32_t third_turn) {
    int32_t largest = 0;
    for (uint32_t i = 0; i < 1024u; i++) {
        const uint32_t turn = i << 22;
        const int32_t value =
            signal_cosine(first, turn) + signal_cosine(third, 3u * turn + third_turn);
        largest = abs_i32(value) > largest ? abs_i32(value) : largest;
    }
    return largest;
}

static void test_harmonic_span_of_known_sums(void) {
    TEST_ASSERT_EQUAL_INT32(0, found_span(0, 0, 0));
    TEST_ASSERT_INT32_WITHIN(1, 1000000, found_span(1000000, 0, 123456789u));
    TEST_ASSERT_INT32_WITHIN(1, 1200000, found_span(1000000, 200000, 0)); // both at 0
    // cos p - cos(3 p) / 9 rises to 0.8889 at 0 and turns there: 1 - 1/9.
    TEST_ASSERT_INT32_WITHIN(20, 888889, found_span(1000000, 111111, 180u * DEGREE));
}

static void test_harmonic_span_is_that_of_a_fine_search(void) {
    uint32_t seed = 9;
    for (uint32_t i = 0; i < 60u; i++) {
        const int32_t first = abs_i32(signal_noise(&seed, 1000000));
        const int32_t third = i % 3u == 0 ? abs_i32(signal_noise(&seed, 1000000)) : first / 9;
        const uint32_t third_turn = (uint32_t)signal_noise(&seed, 1000000) * 1000u;
        const int32_t exact = finest_span(first, third, third_turn);
        const int32_t found = found_span(first, third, third_turn);
        TEST_ASSERT_GREATER_OR_EQUAL_INT32(exact - first / 200 - third / 90 - 100, found);
        TEST_ASSERT_LESS_OR_EQUAL_INT32(exact + (first + third) / 5000 + 1, found);
    }
}

static void test_harmonic_span_saturates(void) {
    TEST_ASSERT_EQUAL_INT32(INT32_MAX, found_span(INT32_MAX, INT32_MAX, 0));
    const harmonic_span_t span = {.first = INT32_MAX, .third = INT32_MAX};
    TEST_ASSERT_EQUAL_INT32(-INT32_MAX, harmonic_span_at(&span, UINT32_C(1) << 31));
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(test_harmonic_wave_at_quarters_of_a_turn);
    RUN_TEST(test_harmonic_parts_of_known_tones);
    RUN_TEST(test_harmonic_amplitude_and_peak);
    RUN_TEST(test_harmonic_rms_of_known_tones);
    RUN_TEST(test_harmonic_sums_of_one_tick);
    RUN_TEST(test_harmonic_sums_added_are_those_of_all_ticks);
    RUN_TEST(test_harmonic_sums_hold_the_largest_acceleration);
    RUN_TEST(test_harmonic_at_is_the_tone_again);
    RUN_TEST(test_harmonic_at_saturates);
    RUN_TEST(test_harmonic_span_of_known_sums);
    RUN_TEST(test_harmonic_span_is_that_of_a_fine_search);
    RUN_TEST(test_harmonic_span_saturates);
    return UNITY_END();
}
