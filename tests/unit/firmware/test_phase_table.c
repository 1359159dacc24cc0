#include "phase_table.h"

#include <stddef.h>

#include "law.h"
#include "plant_pulses.h"
#include "pulse_words.h"
#include "unity.h"

#define HALF_TURN (UINT64_C(1) << 32) // of the vibration: all of the current's period
#define DEGREE_q16(degrees) ((uint16_t)((degrees)*65536u / 180u))

static const phase_point_t slow_points[] = {
    {.freq_mHz = 4000, .level_mA = 5000, .centre_q16 = 40000, .width_q16 = 30000},
    {.freq_mHz = 5000, .level_mA = 4000, .centre_q16 = 42000, .width_q16 = 20000, .floor_mA = 500},
    {.freq_mHz = 8000, .level_mA = 4600, .centre_q16 = 43000, .width_q16 = 20000, .floor_mA = 900},
};
static const phase_point_t fast_points[] = {
    {.freq_mHz = 3000, .level_mA = 100, .width_q16 = 1, .floor_mA = 100},
    {.freq_mHz = 3001, .level_mA = 65535, .width_q16 = PHASE_WIDTH_ALL, .floor_mA = 65535},
};

static uint32_t words[PHASE_TABLE_MAX_WORDS + 8u];
static uint32_t count;

extern const law_t law_phase;

void setUp(void) {
    count = pulse_words_make(words, slow_points, 3, fast_points, 2);
}
void tearDown(void) {}

static uint32_t random_u32(void) {
    static uint32_t state = 1;
    state = state * 1664525u + 1013904223u;
    return state ^ state >> 15;
}

// In front of the end of memory that is known to belong to them: a word too far is seen by
// AddressSanitizer.
static quiesce_table_verdict_t verdict_of(uint32_t length) {
    static uint32_t memory[PHASE_TABLE_MAX_WORDS + 8u];
    uint32_t *end = memory + sizeof memory / sizeof memory[0];
    memcpy(end - length, words, length * sizeof words[0]);
    return table_check(law_phase.kind, end - length, length);
}

static quiesce_table_verdict_t sealed_verdict(void) {
    pulse_words_seal(words, count);
    return verdict_of(count);
}

static phase_point_t *point(uint32_t index) {
    return (phase_point_t *)(void *)&words[PULSE_WORDS_HEADER + PULSE_WORDS_POINT * index];
}

// --- the check

static void test_phase_table_that_is_good(void) {
    TEST_ASSERT_EQUAL(QUIESCE_TABLE_OK, verdict_of(count));
    const phase_table_t *table = (const phase_table_t *)(const void *)words;
    TEST_ASSERT_EQUAL_UINT32(5000, table->unlock_current_mA);
    TEST_ASSERT_EQUAL_MEMORY(slow_points, phase_table_points(table, 0), sizeof slow_points);
    TEST_ASSERT_EQUAL_MEMORY(fast_points, phase_table_points(table, 1), sizeof fast_points);
}

static void test_phase_table_shipped_is_good_and_small(void) {
    const uint32_t shipped = sizeof plant_pulses_table / sizeof plant_pulses_table[0];
    TEST_ASSERT_EQUAL(QUIESCE_TABLE_OK, table_check(law_phase.kind, plant_pulses_table, shipped));
    TEST_ASSERT_LESS_OR_EQUAL_UINT32(2048, sizeof plant_pulses_table);
}

static void make_steps(uint32_t first_count, uint32_t second_count) {
    phase_point_t points[PHASE_TABLE_MAX_POINTS + 1u];
    for (uint32_t i = 0; i <= PHASE_TABLE_MAX_POINTS; i++) {
        points[i] = (phase_point_t){.freq_mHz = (uint16_t)(1000u + i), .level_mA = 1};
    }
    count = pulse_words_make(words, points, first_count, points, second_count);
}

static void test_phase_table_with_fewest_and_most_points(void) {
    const uint32_t most = PHASE_TABLE_MAX_POINTS;
    const uint32_t few = PHASE_TABLE_MIN_POINTS;
    const uint32_t good[][2] = {{few, few}, {few, most}, {most, few}, {most, most}};
    for (uint32_t i = 0; i < 4u; i++) {
        make_steps(good[i][0], good[i][1]);
        TEST_ASSERT_EQUAL(QUIESCE_TABLE_OK, verdict_of(count));
    }
    TEST_ASSERT_EQUAL_UINT32(PHASE_TABLE_MAX_WORDS, count);
    const uint32_t bad[][2] = {{few, most + 1u}, {most + 1u, few}, {few, few - 1u}, {0, most}};
    for (uint32_t i = 0; i < 4u; i++) {
        make_steps(bad[i][0], bad[i][1]);
        TEST_ASSERT_EQUAL(QUIESCE_TABLE_SHAPE, verdict_of(count));
    }
    make_steps(most, most + 1u); // more words than any table of pulses has
    TEST_ASSERT_EQUAL(QUIESCE_TABLE_SHAPE, verdict_of(count));
}

static void test_phase_table_cut_short_or_too_long(void) {
    for (uint32_t length = 0; length < sizeof words / sizeof words[0]; length++) {
        if (length != count) {
            TEST_ASSERT_EQUAL(QUIESCE_TABLE_SIZE, verdict_of(length));
        }
    }
    TEST_ASSERT_EQUAL(QUIESCE_TABLE_SIZE, table_check(law_phase.kind, NULL, 0));
    words[2]++;
    TEST_ASSERT_EQUAL(QUIESCE_TABLE_SIZE, sealed_verdict());
    words[2] = UINT32_MAX;
    TEST_ASSERT_EQUAL(QUIESCE_TABLE_SIZE, sealed_verdict());
}

static void test_phase_table_of_another_kind(void) {
    words[0] ^= 1u;
    TEST_ASSERT_EQUAL(QUIESCE_TABLE_MAGIC, sealed_verdict());
    words[0] = 0x51504831u; // bytes exchanged
    TEST_ASSERT_EQUAL(QUIESCE_TABLE_MAGIC, sealed_verdict());
}

static void test_phase_table_with_numbers_of_points_that_do_not_fit(void) {
    const uint32_t shapes[] = {
        0, 3, 2u << 16, 0xFFFFFFFFu, 4u | 2u << 16, 3u | 1u << 16, 3u | 3u << 16, 65539u * 2u};
    for (uint32_t i = 0; i < sizeof shapes / sizeof shapes[0]; i++) {
        words[3] = shapes[i];
        TEST_ASSERT_EQUAL(QUIESCE_TABLE_SHAPE, sealed_verdict());
    }
    words[3] = 2u | 3u << 16; // as many in total: now points that do not rise
    TEST_ASSERT_EQUAL(QUIESCE_TABLE_POINT, sealed_verdict());
}

static void test_phase_table_with_bad_points(void) {
    for (uint32_t i = 0; i < 5u; i++) {
        setUp();
        point(i)->floor_mA = (uint16_t)(point(i)->level_mA + 1u); // the last one wraps: 0, good
        TEST_ASSERT_EQUAL(i == 4u ? QUIESCE_TABLE_OK : QUIESCE_TABLE_POINT, sealed_verdict());
    }
    setUp();
    point(4)->level_mA = 65534;
    TEST_ASSERT_EQUAL(QUIESCE_TABLE_POINT, sealed_verdict());
    for (uint32_t i = 0; i < 5u; i++) {
        setUp();
        point(i)->ramp_q16 = 32767;
        TEST_ASSERT_EQUAL(QUIESCE_TABLE_OK, sealed_verdict());
        point(i)->ramp_q16 = 32768;
        TEST_ASSERT_EQUAL(QUIESCE_TABLE_POINT, sealed_verdict());
    }
    const uint32_t later[] = {1, 2, 4};
    for (uint32_t i = 0; i < 3u; i++) {
        setUp();
        point(later[i])->freq_mHz = point(later[i] - 1u)->freq_mHz;
        TEST_ASSERT_EQUAL(QUIESCE_TABLE_POINT, sealed_verdict());
        point(later[i])->freq_mHz--;
        TEST_ASSERT_EQUAL(QUIESCE_TABLE_POINT, sealed_verdict());
    }
}

static void test_phase_table_with_any_bit_flipped_is_refused(void) {
    for (uint32_t bit = 0; bit < 32u * count; bit++) {
        words[bit / 32u] ^= 1u << bit % 32u;
        const quiesce_table_verdict_t verdict = verdict_of(count);
        const uint32_t word = bit / 32u;
        TEST_ASSERT_EQUAL(word == 0   ? QUIESCE_TABLE_MAGIC
                          : word == 2 ? QUIESCE_TABLE_SIZE
                                      : QUIESCE_TABLE_CRC,
                          verdict);
        words[bit / 32u] ^= 1u << bit % 32u;
    }
    TEST_ASSERT_EQUAL(QUIESCE_TABLE_OK, verdict_of(count));
}

static void flip_some_bits(void) {
    for (uint32_t flips = 1u + random_u32() % 20u; flips > 0; flips--) {
        words[random_u32() % count] ^= 1u << (random_u32() >> 27);
    }
}

static void test_phase_table_with_many_bits_flipped_is_refused(void) {
    for (uint32_t round = 0; round < 1000u; round++) {
        setUp();
        flip_some_bits();
        TEST_ASSERT_EQUAL(memcmp(point(0), slow_points, sizeof slow_points) == 0 &&
                              memcmp(point(3), fast_points, sizeof fast_points) == 0 &&
                              words[0] == PHASE_TABLE_MAGIC && words[2] == count &&
                              words[3] == (3u | 2u << 16) && words[4] == 5000u &&
                              crc32_words(&words[2], count - 2u) == words[1],
                          verdict_of(count) == QUIESCE_TABLE_OK);
    }
}

static bool are_points_good(const phase_point_t *points, uint32_t length) {
    bool is_good = true;
    for (uint32_t i = 0; i < length; i++) {
        is_good = is_good && points[i].level_mA >= points[i].floor_mA;
        is_good = is_good && points[i].ramp_q16 < 32768u;
        is_good = is_good && (i == 0 || points[i].freq_mHz > points[i - 1u].freq_mHz);
    }
    return is_good;
}

// With a CRC that fits, what passes is a table, and can be used.
static void test_phase_table_of_any_content_is_judged_right(void) {
    uint32_t passed = 0;
    for (uint32_t round = 0; round < 2000u; round++) {
        setUp();
        flip_some_bits();
        words[0] = PHASE_TABLE_MAGIC;
        words[2] = count;
        words[3] = random_u32() % 4u == 0 ? words[3] : 3u | 2u << 16;
        const quiesce_table_verdict_t verdict = sealed_verdict();
        const phase_table_t *table = (const phase_table_t *)(const void *)words;
        const bool has_shape = table->points[0] + table->points[1] == 5 && table->points[0] >= 2 &&
                               table->points[1] >= 2;
        const bool is_good = has_shape && are_points_good(point(0), table->points[0]) &&
                             are_points_good(point(table->points[0]), table->points[1]);
        const quiesce_table_verdict_t expected = !has_shape ? QUIESCE_TABLE_SHAPE
                                                 : is_good  ? QUIESCE_TABLE_OK
                                                            : QUIESCE_TABLE_POINT;
        TEST_ASSERT_EQUAL(expected, verdict);
        passed += is_good ? 1u : 0u;
    }
    TEST_ASSERT_GREATER_THAN_UINT32(50, passed);
    TEST_ASSERT_LESS_THAN_UINT32(1900, passed);
}

// --- between points

static void assert_place(uint32_t freq_mHz, uint32_t index, uint32_t part_q16) {
    for (uint32_t last = 0; last < 2u; last++) {
        const phase_place_t place = phase_place(slow_points, 3, freq_mHz, last);
        TEST_ASSERT_EQUAL_UINT32(index, place.index);
        TEST_ASSERT_EQUAL_UINT32(part_q16, place.part_q16);
    }
}

static void test_phase_place_at_points_and_a_milli_hertz_beside(void) {
    assert_place(4000, 0, 0);
    assert_place(4001, 0, 65);
    assert_place(4500, 0, 32768);
    assert_place(4999, 0, 65470);
    assert_place(5000, 1, 0);
    assert_place(5001, 1, 21);
    assert_place(7999, 1, 65514);
    assert_place(8000, 1, 65536);
}

static void test_phase_place_beyond_the_ends(void) {
    assert_place(0, 0, 0);
    assert_place(3999, 0, 0);
    assert_place(8001, 1, 65536);
    assert_place(65536u + 5000u, 1, 65536);
    assert_place(UINT32_MAX, 1, 65536);
}

static void test_phase_place_among_any_number_of_points(void) {
    phase_point_t points[PHASE_TABLE_MAX_POINTS] = {{0}};
    for (uint32_t length = 2; length <= PHASE_TABLE_MAX_POINTS; length++) {
        uint32_t freq_mHz = 0;
        for (uint32_t i = 0; i < length; i++) {
            points[i].freq_mHz = (uint16_t)freq_mHz;
            freq_mHz += 1u + random_u32() % 1000u;
        }
        points[length - 1u].freq_mHz = 65535;
        for (uint32_t i = 0; i + 1u < length; i++) {
            const uint32_t span = points[i + 1u].freq_mHz - points[i].freq_mHz;
            const uint32_t beyond = random_u32() % span;
            const phase_place_t place = phase_place(points, length, points[i].freq_mHz + beyond,
                                                    random_u32() % (length - 1u));
            TEST_ASSERT_EQUAL_UINT32(i, place.index);
            TEST_ASSERT_EQUAL_UINT32(beyond * 65536u / span, place.part_q16);
        }
    }
}

static phase_pulse_t pulse_at(uint32_t freq_mHz) {
    return phase_pulse_at(slow_points, phase_place(slow_points, 3, freq_mHz, 0));
}

static void test_phase_pulse_at_points_and_between(void) {
    for (uint32_t i = 0; i < 3u; i++) {
        const phase_pulse_t pulse = pulse_at(slow_points[i].freq_mHz);
        TEST_ASSERT_EQUAL_UINT32(slow_points[i].width_q16, pulse.width_q16);
        TEST_ASSERT_EQUAL_UINT32(slow_points[i].centre_q16 - slow_points[i].width_q16 / 2u,
                                 pulse.on_q16);
        TEST_ASSERT_EQUAL_INT32(slow_points[i].level_mA, pulse.level_mA);
        TEST_ASSERT_EQUAL_INT32(slow_points[i].floor_mA, pulse.floor_mA);
    }
    const phase_pulse_t half = pulse_at(4500);
    TEST_ASSERT_EQUAL_UINT32(25000, half.width_q16);
    TEST_ASSERT_EQUAL_UINT32(41000u - 12500u, half.on_q16);
    TEST_ASSERT_EQUAL_INT32(4500, half.level_mA);
    TEST_ASSERT_EQUAL_INT32(250, half.floor_mA);
    const phase_pulse_t third = pulse_at(6000); // a third of the way, rounded down
    TEST_ASSERT_EQUAL_INT32(4199, third.level_mA);
    TEST_ASSERT_EQUAL_INT32(633, third.floor_mA);
}

static phase_pulse_t halfway(phase_point_t from, phase_point_t to) {
    const phase_point_t points[] = {from, to};
    return phase_pulse_at(points, (phase_place_t){0, 32768});
}

static void test_phase_pulse_centre_goes_the_shorter_way_round(void) {
    const struct {
        uint16_t from, to, middle;
    } rows[] = {
        {65000, 536, 0},       {536, 65000, 0},
        {65535, 1, 0},         {1, 65535, 0},
        {10000, 20000, 15000}, {DEGREE_q16(170), DEGREE_q16(30), 3640},
        {0, 32767, 16383},     {DEGREE_q16(5), DEGREE_q16(175), 0},
    };
    for (uint32_t i = 0; i < sizeof rows / sizeof rows[0]; i++) {
        const phase_pulse_t pulse = halfway((phase_point_t){.centre_q16 = rows[i].from},
                                            (phase_point_t){.centre_q16 = rows[i].to});
        const int32_t off = (int16_t)(uint16_t)(pulse.on_q16 - rows[i].middle);
        TEST_ASSERT_INT32_WITHIN(1, 0, off);
        TEST_ASSERT_LESS_THAN_UINT32(65536, pulse.on_q16);
    }
}

static void test_phase_pulse_goal_and_ramp_between_points(void) {
    const phase_pulse_t pulse =
        halfway((phase_point_t){.accel_weight_q8 = 65535, .accel_shape_q14 = 100, .ramp_q16 = 3000},
                (phase_point_t){.accel_weight_q8 = 1, .accel_shape_q14 = 65500, .ramp_q16 = 1000});
    TEST_ASSERT_EQUAL_UINT32(2000, pulse.ramp_q16);
    TEST_ASSERT_EQUAL_UINT32(32768, pulse.accel_weight_q8);
    TEST_ASSERT_EQUAL_UINT32(32800, pulse.accel_shape_q14);
}

static phase_point_t any_point(void) {
    const uint16_t level_mA = (uint16_t)random_u32();
    return (phase_point_t){
        .level_mA = level_mA,
        .centre_q16 = (uint16_t)random_u32(),
        .width_q16 = (uint16_t)random_u32(),
        .floor_mA = (uint16_t)(random_u32() % (level_mA + 1u)),
    };
}

static void assert_between(uint32_t from, uint32_t to, uint32_t value) {
    TEST_ASSERT_GREATER_OR_EQUAL_UINT32(from < to ? from : to, value);
    TEST_ASSERT_LESS_OR_EQUAL_UINT32(from < to ? to : from, value);
}

static void test_phase_pulse_lies_between_its_points(void) {
    for (uint32_t round = 0; round < 2000u; round++) {
        const phase_point_t points[] = {any_point(), any_point()};
        const phase_pulse_t pulse =
            phase_pulse_at(points, (phase_place_t){0, random_u32() % 65537u});
        assert_between(points[0].level_mA, points[1].level_mA, (uint32_t)pulse.level_mA);
        assert_between(points[0].floor_mA, points[1].floor_mA, (uint32_t)pulse.floor_mA);
        assert_between(points[0].width_q16, points[1].width_q16, pulse.width_q16);
        TEST_ASSERT_GREATER_OR_EQUAL_INT32(pulse.floor_mA, pulse.level_mA);
    }
}

// --- current

static uint64_t overlap(uint64_t from, uint64_t to, uint64_t on, uint64_t off) {
    const uint64_t low = from > on ? from : on;
    const uint64_t high = to < off ? to : off;
    return high > low ? high - low : 0;
}

// How much of a tick lies in the pulse before, this one and the two after.
static uint64_t on_part(const phase_pulse_t *pulse, uint32_t start, uint32_t length) {
    uint64_t sum = 0;
    for (uint64_t k = 0; k < 4u; k++) {
        const uint64_t on = ((uint64_t)pulse->on_q16 << 16) + k * HALF_TURN;
        const uint64_t from = start + HALF_TURN;
        sum += overlap(from, from + length, on, on + ((uint64_t)pulse->width_q16 << 16));
    }
    return sum;
}

// A tick's mean current to 1 mA and the 16 bits in which its length is counted; a ramp that is
// longer than the tick is the mean over the ramp's length about the tick's middle. Two ramps never
// overlap: they are no longer than the pulse or the gap.
static void assert_current(const phase_pulse_t *pulse, uint32_t start, uint32_t length) {
    const uint32_t gap_q16 = PHASE_WIDTH_ALL - pulse->width_q16;
    const uint32_t room_q16 = gap_q16 < pulse->width_q16 ? gap_q16 : pulse->width_q16;
    const uint32_t ramp = (pulse->ramp_q16 < room_q16 ? pulse->ramp_q16 : room_q16) << 16;
    const uint32_t longer = ramp > length ? (ramp - length) / 2u : 0;
    const uint32_t window = length + 2u * longer;
    const int64_t height = pulse->level_mA - pulse->floor_mA;
    const int64_t exact = pulse->floor_mA + height *
                                                (int64_t)on_part(pulse, start - longer, window) /
                                                (int64_t)window;
    const int32_t tolerance = (int32_t)(2 + height * 65536 / window);
    const int32_t current = phase_pulse_current_mA(pulse, start, length);
    TEST_ASSERT_INT32_WITHIN(tolerance, (int32_t)exact, current);
    TEST_ASSERT_GREATER_OR_EQUAL_INT32(pulse->floor_mA, current);
    TEST_ASSERT_LESS_OR_EQUAL_INT32(pulse->level_mA, current);
}

static void test_phase_current_of_ticks_at_the_edges(void) {
    const phase_pulse_t pulse = {
        .on_q16 = 16384, .width_q16 = 32768, .level_mA = 5000, .floor_mA = 1000};
    const uint32_t tick = UINT32_C(1) << 26; // a 64th
    const uint32_t on = UINT32_C(1) << 30;
    const uint32_t off = UINT32_C(3) << 30;
    TEST_ASSERT_EQUAL_INT32(1000, phase_pulse_current_mA(&pulse, on - tick, tick));
    TEST_ASSERT_INT32_WITHIN(5, 2000, phase_pulse_current_mA(&pulse, on - tick / 4u * 3u, tick));
    TEST_ASSERT_INT32_WITHIN(5, 3000, phase_pulse_current_mA(&pulse, on - tick / 2u, tick));
    TEST_ASSERT_EQUAL_INT32(5000, phase_pulse_current_mA(&pulse, on, tick));
    TEST_ASSERT_EQUAL_INT32(5000, phase_pulse_current_mA(&pulse, off - tick, tick));
    TEST_ASSERT_INT32_WITHIN(5, 4000, phase_pulse_current_mA(&pulse, off - tick / 4u * 3u, tick));
    TEST_ASSERT_EQUAL_INT32(1000, phase_pulse_current_mA(&pulse, off, tick));
    TEST_ASSERT_EQUAL_INT32(1000, phase_pulse_current_mA(&pulse, UINT32_MAX, tick)); // wraps
}

static void test_phase_current_of_a_pulse_across_the_wrap(void) {
    const phase_pulse_t pulse = {.on_q16 = 60000, .width_q16 = 11072, .level_mA = 3000};
    const uint32_t tick = UINT32_C(1) << 26;
    TEST_ASSERT_EQUAL_INT32(3000, phase_pulse_current_mA(&pulse, 0u - tick / 2u, tick));
    TEST_ASSERT_EQUAL_INT32(3000, phase_pulse_current_mA(&pulse, 0, tick));
    TEST_ASSERT_EQUAL_INT32(0, phase_pulse_current_mA(&pulse, UINT32_C(5536) << 16, tick));
    assert_current(&pulse, UINT32_C(5500) << 16, tick);
}

static void test_phase_current_of_no_width_and_of_all(void) {
    phase_pulse_t pulse = {.on_q16 = 1234, .level_mA = 5000, .floor_mA = 700};
    for (uint32_t start = 0; start < 64u; start++) {
        pulse.width_q16 = 0;
        TEST_ASSERT_EQUAL_INT32(700, phase_pulse_current_mA(&pulse, start << 26, 1u << 27));
        pulse.width_q16 = PHASE_WIDTH_ALL;
        TEST_ASSERT_EQUAL_INT32(5000, phase_pulse_current_mA(&pulse, start << 26, 1u << 27));
        pulse.width_q16 = PHASE_WIDTH_ALL - 1u; // a gap of one 2^-16: 65536 / 2^27 of 4300
        assert_current(&pulse, start << 26, 1u << 27);
    }
}

// The whole gap, or the whole pulse, inside a tick.
static void test_phase_current_of_a_gap_or_a_pulse_inside_a_tick(void) {
    const uint32_t tick = UINT32_C(1) << 30;
    const phase_pulse_t gap = {.on_q16 = 20000, .width_q16 = 65536u - 4096u, .level_mA = 4000};
    TEST_ASSERT_INT32_WITHIN(2, 3000, phase_pulse_current_mA(&gap, UINT32_C(15000) << 16, tick));
    const phase_pulse_t narrow = {.on_q16 = 20000, .width_q16 = 4096, .level_mA = 4000};
    TEST_ASSERT_INT32_WITHIN(2, 1000, phase_pulse_current_mA(&narrow, UINT32_C(15000) << 16, tick));
}

static void test_phase_current_of_any_tick_is_the_mean_over_it(void) {
    for (uint32_t round = 0; round < 20000u; round++) {
        const uint32_t floor_mA = random_u32() % 3000u;
        const phase_pulse_t pulse = {
            .on_q16 = (uint16_t)(random_u32() >> 16),
            .width_q16 = (random_u32() >> 16) % PHASE_WIDTH_ALL,
            .level_mA = (int32_t)(floor_mA + random_u32() % 20000u),
            .floor_mA = (int32_t)floor_mA,
            .ramp_q16 = round % 2u == 0 ? 0 : (uint16_t)(random_u32() >> 17 >> random_u32() % 8u),
        };
        // From 1 Hz at 4 kHz to just below half of it all; one beside an edge now and then.
        const uint32_t length = (random_u32() >> 1 >> random_u32() % 10u) | 1u << 21;
        const uint32_t edge = (pulse.on_q16 + (random_u32() % 2u == 0 ? 0 : pulse.width_q16)) << 16;
        assert_current(&pulse, random_u32() % 4u == 0 ? edge - random_u32() % 3u : random_u32(),
                       length);
    }
}

// Rises from floor to level about its first edge, falls likewise about its last.
static void test_phase_current_of_a_ramp(void) {
    const phase_pulse_t pulse = {
        .on_q16 = 60000, .width_q16 = 30000, .level_mA = 5000, .floor_mA = 1000, .ramp_q16 = 8192};
    const struct {
        int32_t after_edge_q16, current_mA;
    } rows[] = {{-4200, 1000}, {-2048, 2000}, {0, 3000}, {2048, 4000}, {4200, 5000}};
    const uint32_t tick = 1u << 20; // 16 of 65536
    for (uint32_t i = 0; i < 5u; i++) {
        const uint32_t on = (uint32_t)(60000 + rows[i].after_edge_q16) << 16;
        const uint32_t off = (uint32_t)(60000 + 30000 - rows[i].after_edge_q16) << 16;
        TEST_ASSERT_INT32_WITHIN(10, rows[i].current_mA,
                                 phase_pulse_current_mA(&pulse, on - tick / 2u, tick));
        TEST_ASSERT_INT32_WITHIN(10, rows[i].current_mA,
                                 phase_pulse_current_mA(&pulse, off - tick / 2u, tick));
    }
}

// Shorter pulse or gap than ramp: level and floor are still reached.
static void test_phase_current_of_ramps_without_room(void) {
    const uint32_t tick = 1u << 20;
    phase_pulse_t pulse = {.on_q16 = 10000, .width_q16 = 4000, .level_mA = 3000, .ramp_q16 = 30000};
    TEST_ASSERT_INT32_WITHIN(20, 3000, phase_pulse_current_mA(&pulse, UINT32_C(12000) << 16, tick));
    TEST_ASSERT_EQUAL_INT32(0, phase_pulse_current_mA(&pulse, UINT32_C(40000) << 16, tick));
    pulse.width_q16 = 61536;
    TEST_ASSERT_INT32_WITHIN(20, 0, phase_pulse_current_mA(&pulse, UINT32_C(8000) << 16, tick));
    TEST_ASSERT_EQUAL_INT32(3000, phase_pulse_current_mA(&pulse, UINT32_C(40000) << 16, tick));
}

// Over whole periods the ticks add up to the pulse's area, wherever the grid lies.
static void test_phase_current_adds_up_to_the_pulse(void) {
    phase_pulse_t pulse = {.on_q16 = 50000, .width_q16 = 30001, .level_mA = 5000, .floor_mA = 1000};
    const int32_t mean_mA = 1000 + 4000 * 30001 / 65536;
    const uint32_t ticks_a_period[] = {3, 7, 25, 64, 100, 333, 2000};
    for (uint32_t i = 0; i < sizeof ticks_a_period / sizeof ticks_a_period[0]; i++) {
        const uint32_t ticks = ticks_a_period[i];
        const uint32_t length = (uint32_t)(HALF_TURN / ticks);
        for (uint32_t offset = 0; offset < 5u; offset++) {
            int64_t sum_mA = 0;
            pulse.ramp_q16 = (uint16_t)(offset * 2000u);
            for (uint32_t k = 0; k < ticks; k++) {
                sum_mA += phase_pulse_current_mA(&pulse, offset * 777777777u + k * length, length);
            }
            // Each of the two edges is low by a 2^-16 of all, at most, and a milliampere's rest.
            TEST_ASSERT_INT32_WITHIN(pulse.ramp_q16 == 0 ? 2 : 6, mean_mA,
                                     (int32_t)(sum_mA / ticks));
        }
    }
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(test_phase_table_that_is_good);
    RUN_TEST(test_phase_table_shipped_is_good_and_small);
    RUN_TEST(test_phase_table_with_fewest_and_most_points);
    RUN_TEST(test_phase_table_cut_short_or_too_long);
    RUN_TEST(test_phase_table_of_another_kind);
    RUN_TEST(test_phase_table_with_numbers_of_points_that_do_not_fit);
    RUN_TEST(test_phase_table_with_bad_points);
    RUN_TEST(test_phase_table_with_any_bit_flipped_is_refused);
    RUN_TEST(test_phase_table_with_many_bits_flipped_is_refused);
    RUN_TEST(test_phase_table_of_any_content_is_judged_right);
    RUN_TEST(test_phase_place_at_points_and_a_milli_hertz_beside);
    RUN_TEST(test_phase_place_beyond_the_ends);
    RUN_TEST(test_phase_place_among_any_number_of_points);
    RUN_TEST(test_phase_pulse_at_points_and_between);
    RUN_TEST(test_phase_pulse_centre_goes_the_shorter_way_round);
    RUN_TEST(test_phase_pulse_goal_and_ramp_between_points);
    RUN_TEST(test_phase_pulse_lies_between_its_points);
    RUN_TEST(test_phase_current_of_ticks_at_the_edges);
    RUN_TEST(test_phase_current_of_a_pulse_across_the_wrap);
    RUN_TEST(test_phase_current_of_no_width_and_of_all);
    RUN_TEST(test_phase_current_of_a_gap_or_a_pulse_inside_a_tick);
    RUN_TEST(test_phase_current_of_any_tick_is_the_mean_over_it);
    RUN_TEST(test_phase_current_of_a_ramp);
    RUN_TEST(test_phase_current_of_ramps_without_room);
    RUN_TEST(test_phase_current_adds_up_to_the_pulse);
    return UNITY_END();
}
