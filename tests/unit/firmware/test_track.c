// Forces to currents: the three trackers one by one, then a law that demands a force (the example
// of docs/howto/add-a-law.md takes the place of the others) in the whole controller.
#include <stddef.h>
#include <string.h>

#include "crc32.h"
#include "force_map.h"
#include "law.h"
#include "quiesce.h"
#include "test_signal.h"
#include "track.h"
#include "unity.h"

enum { SECTION = 4, HEADER = 7, RATE_Hz = 1000, UNLOCK_mA = 1100, SAFE_mA = 250 };

extern const law_t law_constant_force;

const law_t *law_find(int32_t index) {
    return index >= 0 && index <= QUIESCE_LAW_PHASE ? &law_constant_force : NULL;
}

static quiesce_t controller;
static quiesce_board_t board;
static quiesce_params_t params;
static quiesce_in_t in;
static quiesce_out_t out;
static uint32_t map[QUIESCE_TABLE_WORDS];
static uint32_t seed;

static void seal(uint32_t count) {
    map[0] = FORCE_MAP_MAGIC;
    map[2] = count;
    map[1] = crc32_words(&map[2], count - 2u);
}

// One section, over stroke velocity.
static uint32_t make_map(const int32_t *velocity, uint32_t n, const int32_t *current, uint32_t m,
                         const int32_t *force) {
    map[3] = 1;
    map[SECTION] = QUIESCE_SENSE_STROKE_VELOCITY;
    map[SECTION + 1] = n;
    map[SECTION + 2] = m;
    memcpy(&map[HEADER], velocity, n * sizeof *velocity);
    memcpy(&map[HEADER + n], current, m * sizeof *current);
    memcpy(&map[HEADER + n + m], force, (size_t)n * m * sizeof *force);
    seal(HEADER + n + m + n * m);
    return map[2];
}

// 10 .. 110 N at 1 mm/s, 30 .. 130 N at 100 mm/s, over 0 .. 2 A.
static uint32_t make_plain_map(void) {
    static const int32_t velocity[] = {-100000, -1000, 1000, 100000};
    static const int32_t current[] = {0, 1000, 2000};
    static const int32_t force[] = {-30000, -80000, -130000, -10000, -60000, -110000,
                                    10000,  60000,  110000,  30000,  80000,  130000};
    return make_map(velocity, 4, current, 3, force);
}

static void make_board(quiesce_sense_t sense) {
    quiesce_board_default(&board);
    board.damper[0].safe_mA = SAFE_mA;
    quiesce_board_sensor_t *sensor = &board.sensor[board.sensors++];
    *sensor = board.sensor[0];
    sensor->sense = (int32_t)sense;
    sensor->scale = 1000;
    sensor->full_scale_counts = 5000000;
    sensor->stuck_us = 0;
}

static void start(void) {
    TEST_ASSERT_TRUE(quiesce_init_board(&controller, &board, &params));
    memset(&in, 0, sizeof in);
}

void setUp(void) {
    seed = 1;
    quiesce_params_default(&params);
    params.tick_rate_Hz = RATE_Hz;
    params.unlock_current_mA = UNLOCK_mA;
    params.slew_mA_s = 100000000;
    make_board(QUIESCE_SENSE_STROKE_VELOCITY);
}
void tearDown(void) {}

// ---- one by one ---------------------------------------------------------------------------------

static int32_t track(int32_t tracker, void *state, int32_t velocity_um_s, int32_t force_mN,
                     int32_t demand_mN) {
    const track_setup_t setup = {&params, map, 0};
    const view_damper_t damper = {.velocity_um_s = velocity_um_s, .force_mN = force_mN};
    return track_find(tracker)->step(state, &setup, &damper, demand_mN);
}

static int32_t inverse(int32_t velocity_um_s, int32_t demand_mN) {
    return track(QUIESCE_TRACKER_INVERSE, NULL, velocity_um_s, 0, demand_mN);
}

static void test_track_inverse_of_a_plain_map(void) {
    TEST_ASSERT_EQUAL_INT(QUIESCE_TABLE_OK, quiesce_table_check(map, make_plain_map()));
    static const struct {
        int32_t velocity, demand, current;
    } cases[] = {
        {1000, 50000, 800},
        {100000, 50000, 400},
        {50500, 50000, 600},
        {50500, 95000, 1500},
        // Nearest: 50,009 mN are 800.18 mA, 50,025 are 800.5.
        {1000, 50009, 800},
        {1000, 50025, 801},
        // Beyond the axis, and slower than its slowest point.
        {VIEW_LIMIT, 80000, 1000},
        {1, 60000, 1000},
        // What it does without current, and more than it can.
        {1000, 10000, 0},
        {1000, 9999, 0},
        {1000, 10050, 1},
        {1000, 110000, 2000},
        {1000, 110001, 2000},
        {1000, INT32_MAX, 2000},
        // It cannot push.
        {1000, -50000, 0},
        {1000, INT32_MIN, 0},
        {1000, 0, 0},
        // At rest it holds either way.
        {0, 60000, 1000},
        {0, 0, 0},
    };
    for (uint32_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        TEST_ASSERT_EQUAL_INT32(cases[i].current, inverse(cases[i].velocity, cases[i].demand));
        const int32_t other = cases[i].demand == INT32_MIN ? INT32_MAX : -cases[i].demand;
        TEST_ASSERT_EQUAL_INT32(cases[i].current, inverse(-cases[i].velocity, other));
    }
}

// Where more current makes no more force, the least one is taken.
static void test_track_inverse_takes_the_least_current_of_a_flat_map(void) {
    static const int32_t velocity[] = {-1000, 0, 1000};
    static const int32_t current[] = {0, 1000, 2000, 3000};
    static const int32_t force[] = {-5, -5, -900, -900, 7, 7, 7, 7, 5, 5, 900, 900};
    TEST_ASSERT_EQUAL_INT(QUIESCE_TABLE_OK,
                          quiesce_table_check(map, make_map(velocity, 3, current, 4, force)));
    TEST_ASSERT_EQUAL_INT32(0, inverse(1000, 5));
    TEST_ASSERT_EQUAL_INT32(1001, inverse(1000, 6));
    TEST_ASSERT_EQUAL_INT32(2000, inverse(1000, 900));
    TEST_ASSERT_EQUAL_INT32(2000, inverse(-1000, -900));
    TEST_ASSERT_EQUAL_INT32(3000, inverse(1000, 901));
    TEST_ASSERT_EQUAL_INT32(0, inverse(0, 7));
    TEST_ASSERT_EQUAL_INT32(3000, inverse(0, 8));
    TEST_ASSERT_EQUAL_INT32(3000, inverse(0, -8));
}

static uint32_t random_below(uint32_t limit) {
    seed = seed * 1664525u + 1013904223u;
    return (uint32_t)(((uint64_t)seed * limit) >> 32);
}

// 1 .. most, of any size.
static int32_t random_step(int32_t most) {
    const int32_t range = most >> random_below(28);
    return 1 + (int32_t)random_below(range > 0 ? (uint32_t)range : 1u);
}

static void make_velocities(int32_t *velocity, uint32_t n, uint32_t below, bool has_zero) {
    const int32_t most = VIEW_LIMIT / (int32_t)n;
    for (uint32_t i = below; i > 0; i--) {
        velocity[i - 1u] = (i == below ? 0 : velocity[i]) - random_step(most);
    }
    for (uint32_t i = below; i < n; i++) {
        velocity[i] =
            i == below ? (has_zero ? 0 : random_step(most)) : velocity[i - 1u] + random_step(most);
    }
}

// A half of the steps are flat.
static void make_forces(int32_t *force, uint32_t m, int32_t way) {
    const int32_t start_mN = random_step(VIEW_LIMIT / 2);
    force[0] = random_below(2) == 0 ? start_mN : -start_mN;
    for (uint32_t j = 1; j < m; j++) {
        const int32_t step_mN = random_below(2) == 0 ? 0 : random_step(VIEW_LIMIT / 2 / (int32_t)m);
        force[j] = force[j - 1u] + way * step_mN;
    }
}

static void make_random_map(void) {
    int32_t velocity[32];
    int32_t current[16];
    int32_t force[32 * 16];
    const uint32_t n = 2u + random_below(31);
    const uint32_t m = 2u + random_below(15);
    const uint32_t below = 1u + random_below(n - 1u);
    make_velocities(velocity, n, below, below + 1u < n && random_below(2) == 0);
    for (uint32_t j = 0; j < m; j++) {
        current[j] =
            j == 0 ? 0 : current[j - 1u] + random_step(QUIESCE_HIGHEST_CURRENT_mA / (int32_t)m);
    }
    for (uint32_t i = 0; i < n; i++) {
        make_forces(&force[i * m], m, (velocity[i] > 0) - (velocity[i] < 0));
    }
    const uint32_t count = make_map(velocity, n, current, m, force);
    TEST_ASSERT_EQUAL_INT(QUIESCE_TABLE_OK, quiesce_table_check(map, count));
}

static int32_t value_of(uint32_t place) {
    return (int32_t)map[HEADER + place];
}

// The map read as its header says it, in floating point and without any search: force at one of its
// currents.
static double forward_at(uint32_t j, int32_t velocity_um_s, int32_t side) {
    const uint32_t n = map[SECTION + 1];
    const uint32_t m = map[SECTION + 2];
    uint32_t i = 0;
    while (i + 2u < n && value_of(i + 1u) <= velocity_um_s) {
        i++;
    }
    const double low = value_of(i);
    const double high = value_of(i + 1u);
    double part = (velocity_um_s - low) / (high - low);
    if (low < 0.0 && high > 0.0) {
        part = side > 0 ? 1.0 : 0.0;
    }
    part = part < 0.0 ? 0.0 : part > 1.0 ? 1.0 : part;
    return (1.0 - part) * value_of(n + m + i * m + j) + part * value_of(n + m + (i + 1u) * m + j);
}

static double between(double low, double high, double value) {
    return value < low ? low : value > high ? high : value;
}

// Half a milliampere of the steepest part beside it, and what two roundings of a force leave.
static void assert_best(int32_t velocity_um_s, int32_t demand_mN, int32_t current_mA) {
    const int32_t side = demand_mN > 0 ? 1 : -1;
    const uint32_t n = map[SECTION + 1];
    const uint32_t last = map[SECTION + 2] - 1u;
    double force = side * forward_at(last, velocity_um_s, side);
    const double most = force;
    double slope = 0.0;
    for (uint32_t j = 0; j < last; j++) {
        const double at = side * forward_at(j, velocity_um_s, side);
        const double next = side * forward_at(j + 1u, velocity_um_s, side);
        const double from_mA = value_of(n + j);
        const double to_mA = value_of(n + j + 1u);
        const double rise = (next - at) / (to_mA - from_mA);
        if (current_mA >= from_mA && current_mA <= to_mA) {
            force = at + rise * (current_mA - from_mA);
            slope = rise > slope ? rise : slope;
        }
    }
    const double wanted =
        between(side * forward_at(0, velocity_um_s, side), most, (double)side * demand_mN);
    TEST_ASSERT_TRUE(current_mA >= 0 && current_mA <= value_of(n + last));
    TEST_ASSERT_TRUE(force - wanted <= 0.5 * slope + 4.0);
    TEST_ASSERT_TRUE(wanted - force <= 0.5 * slope + 4.0);
}

static int32_t random_signed(int32_t most) {
    const int32_t value = random_step(most);
    return random_below(2) == 0 ? value : -value;
}

static void test_track_inverse_gives_the_force_of_any_map(void) {
    for (uint32_t t = 0; t < 300u; t++) {
        make_random_map();
        for (uint32_t k = 0; k < 20u; k++) {
            const int32_t velocity = k == 0   ? 0
                                     : k < 4u ? value_of(random_below(map[SECTION + 1]))
                                              : random_signed(VIEW_LIMIT);
            const int32_t demand =
                random_below(8) == 0 ? random_signed(INT32_MAX) : random_signed(VIEW_LIMIT);
            const int32_t current = inverse(velocity, demand);
            if (velocity != 0 && (velocity > 0) != (demand > 0)) {
                TEST_ASSERT_EQUAL_INT32(0, current);
            } else {
                assert_best(velocity, demand, current);
                const int32_t more = demand > 0 ? demand + (INT32_MAX - demand) / 16
                                                : demand - (INT32_MAX + demand) / 16;
                TEST_ASSERT_TRUE(inverse(velocity, more) >= current);
            }
        }
    }
}

// Another section, of a spring: 1 N at 100 um without current, 2 N with 1 A, in proportion.
static uint32_t add_spring(void) {
    static const int32_t section[] = {QUIESCE_SENSE_STROKE,
                                      4,
                                      2,
                                      -100000,
                                      -10000,
                                      10000,
                                      100000,
                                      0,
                                      1000,
                                      -1000,
                                      -2000,
                                      -100,
                                      -200,
                                      100,
                                      200,
                                      1000,
                                      2000};
    const uint32_t count = map[2];
    memcpy(&map[count], section, sizeof section);
    map[3]++;
    seal(count + sizeof section / sizeof *section);
    TEST_ASSERT_EQUAL_INT(QUIESCE_TABLE_OK, quiesce_table_check(map, map[2]));
    return map[2];
}

static int32_t of_damper(uint32_t damper, const view_damper_t *seen, int32_t demand_mN) {
    const track_setup_t setup = {&params, map, damper};
    return track_find(QUIESCE_TRACKER_INVERSE)->step(NULL, &setup, seen, demand_mN);
}

// Each damper by its own section; one section stands for all.
static void test_track_inverse_has_a_section_for_each_damper(void) {
    const view_damper_t seen = {.velocity_um_s = 1000, .stroke_nm = -50000};
    (void)make_plain_map();
    for (uint32_t i = 0; i < 4u; i++) {
        TEST_ASSERT_EQUAL_INT32(800, of_damper(i, &seen, 50000));
    }
    (void)add_spring();
    TEST_ASSERT_EQUAL_INT32(800, of_damper(0, &seen, 50000));
    TEST_ASSERT_EQUAL_INT32(0, of_damper(1, &seen, 750)); // its stroke is the other way
    TEST_ASSERT_EQUAL_INT32(500, of_damper(1, &seen, -750));
    TEST_ASSERT_EQUAL_INT32(0, of_damper(2, &seen, -750)); // none for it
    TEST_ASSERT_EQUAL_INT32(0, of_damper(2, &seen, 750));
}

// A spring is judged by its stroke: it resists that also while it comes back.
static void test_track_inverse_of_a_spring(void) {
    (void)make_plain_map();
    (void)add_spring();
    static const struct {
        int32_t stroke, demand, current;
    } cases[] = {
        {50000, 500, 0},     {50000, 501, 2},  {50000, 750, 500},       {50000, 1000, 1000},
        {50000, 1001, 1000}, {50000, -750, 0}, {50000, 0, 0},           {5000, 150, 500},
        {1, 150, 500},       {0, 150, 500},    {VIEW_LIMIT, 1500, 500}, {1, INT32_MAX, 1000},
    };
    for (uint32_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        for (int32_t way = -1; way <= 1; way++) {
            const view_damper_t up = {.velocity_um_s = way * 1000, .stroke_nm = cases[i].stroke};
            const view_damper_t down = {.velocity_um_s = way * 1000, .stroke_nm = -cases[i].stroke};
            TEST_ASSERT_EQUAL_INT32(cases[i].current, of_damper(1, &up, cases[i].demand));
            TEST_ASSERT_EQUAL_INT32(cases[i].current, of_damper(1, &down, -cases[i].demand));
        }
    }
}

static void test_track_a_map_that_is_cut_or_longer_is_refused(void) {
    (void)make_plain_map();
    const uint32_t first = map[2];
    const uint32_t count = add_spring();
    for (uint32_t words = first + 1u; words < count; words++) {
        seal(words);
        TEST_ASSERT_EQUAL_INT(QUIESCE_TABLE_SHAPE, quiesce_table_check(map, words));
    }
    map[count] = 0;
    seal(count + 1u);
    TEST_ASSERT_EQUAL_INT(QUIESCE_TABLE_SHAPE, quiesce_table_check(map, count + 1u));
    seal(count);
    map[first] = QUIESCE_SENSE_TEMPERATURE;
    seal(count);
    TEST_ASSERT_EQUAL_INT(QUIESCE_TABLE_POINT, quiesce_table_check(map, count));
}

static void assert_refused(quiesce_table_verdict_t verdict, uint32_t place, int32_t value) {
    const uint32_t count = make_plain_map();
    map[place] = (uint32_t)value;
    map[1] = crc32_words(&map[2], count - 2u);
    TEST_ASSERT_EQUAL_INT(verdict, quiesce_table_check(map, count));
}

static void test_track_malformed_maps_are_refused(void) {
    const uint32_t count = make_plain_map();
    TEST_ASSERT_EQUAL_INT(QUIESCE_TABLE_SIZE, quiesce_table_check(map, HEADER - 1u));
    TEST_ASSERT_EQUAL_INT(QUIESCE_TABLE_SIZE, quiesce_table_check(map, count - 1u));
    TEST_ASSERT_EQUAL_INT(QUIESCE_TABLE_SIZE, quiesce_table_check(map, count + 1u));
    TEST_ASSERT_EQUAL_INT(QUIESCE_TABLE_SIZE, quiesce_table_check(map, QUIESCE_TABLE_WORDS + 1u));
    map[count - 1u] ^= 1u;
    TEST_ASSERT_EQUAL_INT(QUIESCE_TABLE_CRC, quiesce_table_check(map, count));
    enum {
        PLACES = SECTION + 1,
        CURRENTS,
        VELOCITY = HEADER,
        CURRENT = HEADER + 4,
        FORCE = HEADER + 7
    };
    const quiesce_table_verdict_t shape = QUIESCE_TABLE_SHAPE;
    const quiesce_table_verdict_t point = QUIESCE_TABLE_POINT;
    const struct {
        quiesce_table_verdict_t verdict;
        uint32_t place;
        int32_t value;
    } cases[] = {
        {QUIESCE_TABLE_MAGIC, 0, FORCE_MAP_MAGIC + 1},
        {QUIESCE_TABLE_MAGIC, 0, 0x31464D51}, // a map of the first version
        {shape, 3, 0},                        // sections
        {shape, 3, 2},
        {shape, 3, 5},
        {shape, 3, -1},
        {shape, PLACES, 1},
        {shape, PLACES, 33},
        {shape, PLACES, 5},
        {shape, PLACES, INT32_MIN},
        {shape, CURRENTS, 1},
        {shape, CURRENTS, 17},
        {shape, CURRENTS, -1},
        {point, SECTION, QUIESCE_SENSE_FORCE}, // no axis
        {point, SECTION, -1},
        {point, VELOCITY, -1000},              // does not rise
        {point, VELOCITY, -VIEW_LIMIT - 1},    // too fast
        {point, VELOCITY + 3, VIEW_LIMIT + 1}, // likewise
        {point, VELOCITY + 3, 1000},           // does not rise
        {point, VELOCITY + 2, 0},              // forces at rest that follow the current
        {point, CURRENT, 1},                   // does not begin at 0
        {point, CURRENT, -1},                  // likewise
        {point, CURRENT + 1, 2000},            // does not rise
        {point, CURRENT + 2, QUIESCE_HIGHEST_CURRENT_mA + 1},
        {point, FORCE, -80001}, // falls where it should rise, and the other way
        {point, FORCE + 1, -29999},
        {point, FORCE + 2, -VIEW_LIMIT - 1},
        {point, FORCE + 9, 80001},
        {point, FORCE + 10, 29999},
        {point, FORCE + 11, VIEW_LIMIT + 1},
        {point, FORCE + 11, INT32_MIN},
    };
    for (uint32_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        assert_refused(cases[i].verdict, cases[i].place, cases[i].value);
    }
    // One direction only.
    static const int32_t one_way[] = {1, 2};
    static const int32_t current[] = {0, 1000};
    static const int32_t force[] = {1, 2, 1, 2};
    TEST_ASSERT_EQUAL_INT(point, quiesce_table_check(map, make_map(one_way, 2, current, 2, force)));
    // The ends of every range.
    assert_refused(QUIESCE_TABLE_OK, VELOCITY, -VIEW_LIMIT);
    assert_refused(QUIESCE_TABLE_OK, CURRENT + 2, QUIESCE_HIGHEST_CURRENT_mA);
    assert_refused(QUIESCE_TABLE_OK, FORCE + 11, VIEW_LIMIT);
}

static void test_track_compare_is_on_while_the_force_falls_short(void) {
    static const struct {
        int32_t demand, force;
        bool is_on[2]; ///< was off, was on
    } cases[] = {
        {1000, 0, {true, true}},
        {1000, 989, {true, true}},
        {1000, 990, {false, true}}, // 1 %: as it was
        {1000, 1000, {false, true}},
        {1000, 1010, {false, true}},
        {1000, 1011, {false, false}},
        {1000, -1, {false, false}}, // it pulls the other way
        {0, 0, {false, false}},
        {0, 500, {false, false}},
        {50, 50, {false, true}},
        {50, 49, {true, true}},
        {INT32_MAX, VIEW_LIMIT, {true, true}},
        {INT32_MAX, -VIEW_LIMIT, {false, false}},
    };
    for (uint32_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        for (uint32_t k = 0; k < 4u; k++) {
            const int32_t sign = k < 2u ? 1 : -1;
            uint64_t state = 0;
            if (k % 2u == 1u) {
                (void)track(QUIESCE_TRACKER_COMPARE, &state, 0, 0, 1000);
            }
            const int32_t current = track(QUIESCE_TRACKER_COMPARE, &state, 0, sign * cases[i].force,
                                          sign * cases[i].demand);
            TEST_ASSERT_EQUAL_INT32(cases[i].is_on[k % 2u] ? params.max_current_mA : 0, current);
        }
    }
}

static void test_track_proportional_follows_what_is_missing(void) {
    params.tracker_gain_mA_kN = 100000; // 0.1 mA each mN
    static const struct {
        int32_t demand, force, current;
    } cases[] = {
        {1000, 0, 100},        {1000, 990, 1},    {1000, 996, 0},       {1000, 995, 1}, // 0.5
        {1000, 1000, 0},       {1000, 2000, 0},   {1000, -1, 0},        {0, 0, 0},
        {100000, 50001, 5000}, {100000, 0, 5000}, {INT32_MAX, 0, 5000},
    };
    for (uint32_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        for (int32_t sign = -1; sign <= 1; sign += 2) {
            TEST_ASSERT_EQUAL_INT32(cases[i].current,
                                    track(QUIESCE_TRACKER_PROPORTIONAL, NULL, 0,
                                          sign * cases[i].force, sign * cases[i].demand));
        }
    }
    params.tracker_gain_mA_kN = 100000000;
    TEST_ASSERT_EQUAL_INT32(5000, track(QUIESCE_TRACKER_PROPORTIONAL, NULL, 0, 0, INT32_MIN));
    params.tracker_gain_mA_kN = 1;
    TEST_ASSERT_EQUAL_INT32(2147, track(QUIESCE_TRACKER_PROPORTIONAL, NULL, 0, 0, INT32_MIN));
}

static void test_track_no_other_tracker_is_known(void) {
    TEST_ASSERT_NULL(track_find(-1));
    TEST_ASSERT_NULL(track_find(QUIESCE_TRACKER_BANK + 1));
    const char *const *labels =
        quiesce_param_info(offsetof(quiesce_params_t, tracker) / sizeof(int32_t))->labels;
    for (int32_t i = 0; i <= QUIESCE_TRACKER_BANK; i++) {
        TEST_ASSERT_EQUAL_STRING(labels[i], track_find(i)->name);
    }
}

// ---- in the controller --------------------------------------------------------------------------

// The second sensor says counts.
static void run(uint32_t ticks, int32_t counts) {
    for (; ticks > 0; ticks--) {
        in.tick++;
        in.enable = in.tick > 1; // its edge arms
        in.sensor[0] = (quiesce_sample_t){.counts = signal_sine(17316, 5000, in.tick, RATE_Hz) +
                                                    signal_noise(&seed, 20),
                                          .is_fresh = true};
        in.sensor[1] = (quiesce_sample_t){.counts = counts, .is_fresh = true};
        quiesce_step(&controller, &in, &out);
    }
}

static void use_plain_map(void) {
    const uint32_t count = make_plain_map();
    TEST_ASSERT_EQUAL_INT(QUIESCE_TABLE_OK, quiesce_table_use(&controller, map, count));
}

static void assert_current(int32_t counts, int32_t current_mA) {
    run(1, counts);
    TEST_ASSERT_EQUAL_UINT32(QUIESCE_STATE_RUN, out.telemetry.state);
    TEST_ASSERT_EQUAL_INT32(current_mA, out.telemetry.current_law_mA);
    TEST_ASSERT_EQUAL_INT32(current_mA, out.damper[0].current_cmd_mA);
}

static void test_track_a_force_becomes_a_current(void) {
    start();
    use_plain_map();
    run(1000, 1000);
    assert_current(1000, 800);
    assert_current(100000, 400);
    assert_current(-100000, 400);
    assert_current(-50500, 600);
    assert_current(0, 0);
}

// Not running without one, as without a signal; blind where it is taken away.
static void test_track_without_a_map_the_law_is_blind(void) {
    start();
    run(1000, 1000);
    TEST_ASSERT_EQUAL_UINT32(QUIESCE_STATE_SELF_TEST, out.telemetry.state);
    TEST_ASSERT_EQUAL_INT32(SAFE_mA, out.damper[0].current_cmd_mA);
    use_plain_map();
    run(1000, 1000);
    assert_current(1000, 800);
    TEST_ASSERT_TRUE(quiesce_table_drop(&controller, QUIESCE_OF_TRACKER));
    for (uint32_t t = 0; t < 100u; t++) {
        assert_current(1000, UNLOCK_mA);
    }
    run(1, 1000);
    TEST_ASSERT_EQUAL_UINT32(QUIESCE_STATE_SAFE, out.telemetry.state);
    TEST_ASSERT_EQUAL_UINT32(QUIESCE_FAULT_LAW_BLIND, out.telemetry.fault);
    TEST_ASSERT_EQUAL_INT32(SAFE_mA, out.damper[0].current_cmd_mA);
    run(1000, 1000);
    TEST_ASSERT_EQUAL_UINT32(1, out.telemetry.fault_count);
    TEST_ASSERT_EQUAL_INT32(SAFE_mA, out.damper[0].current_cmd_mA);
    use_plain_map();
    run(1000, 1000);
    assert_current(1000, 800);
}

// The law's own table: {magic, crc, words, mN}.
static uint32_t law_table[4];

static void make_law_table(uint32_t force_mN) {
    memcpy(law_table, law_constant_force.kind->shipped, sizeof law_table);
    law_table[3] = force_mN;
    law_table[1] = crc32_words(&law_table[2], 2);
}

static void test_track_dropping_one_table_leaves_the_other(void) {
    start();
    make_law_table(60000);
    TEST_ASSERT_EQUAL_INT(QUIESCE_TABLE_OK, quiesce_table_use(&controller, law_table, 4));
    use_plain_map();
    run(1000, 1000);
    assert_current(1000, 1000);
    TEST_ASSERT_TRUE(quiesce_table_drop(&controller, QUIESCE_OF_TRACKER));
    TEST_ASSERT_NULL(quiesce_table_in_use(&controller, QUIESCE_OF_TRACKER));
    run(200, 1000);
    TEST_ASSERT_EQUAL_UINT32(QUIESCE_FAULT_LAW_BLIND, out.telemetry.fault);
    use_plain_map();
    run(1000, 1000);
    assert_current(1000, 1000); // the law's own table was there all the time
    TEST_ASSERT_TRUE(quiesce_table_drop(&controller, QUIESCE_OF_LAW));
    assert_current(1000, 800);
    TEST_ASSERT_TRUE(quiesce_table_drop(&controller, QUIESCE_OF_LAW)); // what ships, again
    assert_current(1000, 800);
    TEST_ASSERT_EQUAL_PTR(law_constant_force.kind->shipped,
                          quiesce_table_in_use(&controller, QUIESCE_OF_LAW));
    TEST_ASSERT_EQUAL_PTR(map, quiesce_table_in_use(&controller, QUIESCE_OF_TRACKER));
}

static void test_track_tables_of_law_and_tracker_go_to_their_own(void) {
    start();
    use_plain_map();
    run(1000, 1000);
    make_law_table(60000);
    TEST_ASSERT_EQUAL_INT(QUIESCE_TABLE_OK, quiesce_table_use(&controller, law_table, 4));
    assert_current(1000, 1000);
    make_law_table(UINT32_C(1) << 30);
    TEST_ASSERT_EQUAL_INT(QUIESCE_TABLE_POINT, quiesce_table_use(&controller, law_table, 4));
    law_table[1]++;
    TEST_ASSERT_EQUAL_INT(QUIESCE_TABLE_CRC, quiesce_table_use(&controller, law_table, 4));
    TEST_ASSERT_EQUAL_INT(QUIESCE_TABLE_SIZE, quiesce_table_use(&controller, law_table, 3));
    law_table[0]++;
    TEST_ASSERT_EQUAL_INT(QUIESCE_TABLE_MAGIC, quiesce_table_use(&controller, law_table, 4));
    static uint32_t damaged[QUIESCE_TABLE_WORDS];
    memcpy(damaged, map, sizeof damaged);
    damaged[10]++;
    TEST_ASSERT_EQUAL_INT(QUIESCE_TABLE_CRC, quiesce_table_use(&controller, damaged, map[2]));
    TEST_ASSERT_EQUAL_INT(QUIESCE_TABLE_SIZE, quiesce_table_use(&controller, map, 1));
    make_law_table(60000);
    assert_current(1000, 1000);
    // Nothing else takes a map.
    params.tracker = QUIESCE_TRACKER_COMPARE;
    make_board(QUIESCE_SENSE_FORCE);
    start();
    TEST_ASSERT_EQUAL_INT(QUIESCE_TABLE_MAGIC, quiesce_table_use(&controller, map, map[2]));
    TEST_ASSERT_FALSE(quiesce_table_drop(&controller, QUIESCE_OF_TRACKER));
}

static void test_track_force_is_compared(void) {
    params.tracker = QUIESCE_TRACKER_COMPARE;
    make_board(QUIESCE_SENSE_FORCE);
    start();
    run(5000, 0);
    // The velocity comes from the accelerometer: the demand changes its sign with it.
    uint32_t on = 0;
    for (uint32_t t = 0; t < 1000u; t++) {
        run(1, 30000);
        const bool is_on = out.damper[0].current_cmd_mA == params.max_current_mA;
        TEST_ASSERT_TRUE(is_on || out.damper[0].current_cmd_mA == 0);
        TEST_ASSERT_EQUAL_INT(out.telemetry.velocity_um_s > 0,
                              is_on || out.telemetry.velocity_um_s == 0);
        on += is_on ? 1u : 0;
    }
    TEST_ASSERT_UINT32_WITHIN(20, 500, on);
    run(1000, 51000); // as much as is wanted: never on
    TEST_ASSERT_EQUAL_INT32(0, out.damper[0].current_cmd_mA);
    params.tracker = QUIESCE_TRACKER_PROPORTIONAL;
    params.tracker_gain_mA_kN = 10000;
    start();
    run(1000, 30000);
    do {
        run(1, 30000);
    } while (out.telemetry.velocity_um_s <= 0);
    assert_current(30000, 200);
}

static void test_track_a_force_against_its_damper_is_a_fault(void) {
    params.tracker = QUIESCE_TRACKER_COMPARE;
    make_board(QUIESCE_SENSE_FORCE);
    start();
    run(1000, 0);
    for (uint32_t t = 0; t < 10000u; t++) {
        run(1, out.telemetry.velocity_um_s > 0 ? 20000 : -20000);
        TEST_ASSERT_EQUAL_UINT32(QUIESCE_FAULT_NONE, out.telemetry.fault);
    }
    for (uint32_t t = 0; t < 10000u; t++) {
        run(1, out.telemetry.velocity_um_s > 0 ? -20000 : 20000);
    }
    TEST_ASSERT_EQUAL_UINT32(QUIESCE_FAULT_SENSOR_POLARITY, out.telemetry.fault);
    TEST_ASSERT_FALSE(out.damper[0].driver_enable);
}

// A map of the sections that the board's dampers and strokes allow.
static void test_track_a_map_is_of_the_boards_dampers(void) {
    start();
    (void)make_plain_map();
    (void)add_spring(); // of a second damper
    TEST_ASSERT_EQUAL_INT(QUIESCE_TABLE_FIT, quiesce_table_use(&controller, map, map[2]));
    (void)make_plain_map();
    map[SECTION] = QUIESCE_SENSE_STROKE;
    seal(map[2]);
    // The damper stands on the ground: its stroke is the accelerometer's displacement.
    TEST_ASSERT_EQUAL_INT(QUIESCE_TABLE_OK, quiesce_table_use(&controller, map, map[2]));
    // A damper of which only the velocity is known.
    board.bodies = 2;
    board.damper[0].end_a = 1;
    board.damper[0].end_b = 0;
    start();
    TEST_ASSERT_EQUAL_INT(QUIESCE_TABLE_FIT, quiesce_table_use(&controller, map, map[2]));
    use_plain_map();
}

static void assert_missing(const char *name, int32_t at) {
    quiesce_signal_t missing = {NULL, 0};
    TEST_ASSERT_TRUE(quiesce_missing(&board, &params, &missing));
    TEST_ASSERT_EQUAL_STRING(name, missing.name);
    TEST_ASSERT_EQUAL_INT32(at, missing.at);
    TEST_ASSERT_FALSE(quiesce_init_board(&controller, &board, &params));
    memset(&in, 0, sizeof in);
    run(1, 0);
    TEST_ASSERT_EQUAL_UINT32(QUIESCE_FAULT_PARAMETER, out.telemetry.fault);
    TEST_ASSERT_EQUAL_INT32(SAFE_mA, out.damper[0].current_cmd_mA);
}

static void test_track_what_a_tracker_needs_and_is_not_there_is_named(void) {
    quiesce_signal_t missing;
    TEST_ASSERT_FALSE(quiesce_missing(&board, &params, &missing));
    params.tracker = QUIESCE_TRACKER_COMPARE;
    assert_missing("force", 0);
    params.tracker = QUIESCE_TRACKER_PROPORTIONAL;
    assert_missing("force", 0);
    make_board(QUIESCE_SENSE_FORCE);
    TEST_ASSERT_FALSE(quiesce_missing(&board, &params, &missing));
    board.dampers = 2;
    board.damper[1] = board.damper[0];
    assert_missing("force", 1);
    // A damper up to a body of which nothing is known.
    params.tracker = QUIESCE_TRACKER_INVERSE;
    board.bodies = 2;
    board.damper[1].end_a = 1;
    board.damper[1].end_b = 0;
    assert_missing("stroke velocity", 1);
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(test_track_inverse_of_a_plain_map);
    RUN_TEST(test_track_inverse_takes_the_least_current_of_a_flat_map);
    RUN_TEST(test_track_inverse_gives_the_force_of_any_map);
    RUN_TEST(test_track_inverse_has_a_section_for_each_damper);
    RUN_TEST(test_track_inverse_of_a_spring);
    RUN_TEST(test_track_a_map_that_is_cut_or_longer_is_refused);
    RUN_TEST(test_track_a_map_is_of_the_boards_dampers);
    RUN_TEST(test_track_malformed_maps_are_refused);
    RUN_TEST(test_track_compare_is_on_while_the_force_falls_short);
    RUN_TEST(test_track_proportional_follows_what_is_missing);
    RUN_TEST(test_track_no_other_tracker_is_known);
    RUN_TEST(test_track_a_force_becomes_a_current);
    RUN_TEST(test_track_without_a_map_the_law_is_blind);
    RUN_TEST(test_track_dropping_one_table_leaves_the_other);
    RUN_TEST(test_track_tables_of_law_and_tracker_go_to_their_own);
    RUN_TEST(test_track_force_is_compared);
    RUN_TEST(test_track_a_force_against_its_damper_is_a_fault);
    RUN_TEST(test_track_what_a_tracker_needs_and_is_not_there_is_named);
    return UNITY_END();
}
