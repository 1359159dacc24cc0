// Laws that are tables: the words of each kind by hand, what their checks refuse, and what a tick
// makes of them, against arithmetic that is written another way.
#include <stddef.h>
#include <string.h>

#include "crc32.h"
#include "law.h"
#include "state_space.h"
#include "table.h"
#include "unity.h"
#include "view_signal.h"

enum { ACCEL = 0, VELOCITY = 1, STROKE = 3, STROKE_VELOCITY = 4, FORCE = 5 };

extern const law_t law_linear, law_signs, law_friction, law_polynomial;

static law_setup_t setup;
static uint64_t state[LAW_STATE_BYTES / sizeof(uint64_t)];
static view_t view;
static law_demand_t demand;
static uint32_t words[QUIESCE_TABLE_WORDS + 1u];
static uint32_t count;
static uint32_t seed;

void setUp(void) {
    quiesce_params_default(&setup.params);
    setup.table = words;
    memset(state, 0, sizeof state);
    view = (view_t){.valid = ~UINT64_C(0), .is_output_on = true};
    count = 0;
    seed = 7;
}
void tearDown(void) {}

static uint32_t random_word(void) {
    seed = seed * 1664525u + 1013904223u;
    return seed ^ seed >> 15;
}

static int32_t random_within(int32_t limit) {
    return (int32_t)(random_word() % (2u * (uint32_t)limit + 1u)) - limit;
}

// ---- making tables ------------------------------------------------------------------------------

static void begin(uint32_t magic) {
    count = TABLE_HEAD_WORDS;
    words[TABLE_MAGIC] = magic;
}

static void put(int32_t word) {
    words[count++] = (uint32_t)word;
}

static void put_input(uint32_t quantity, uint32_t at, int32_t limit, int32_t shift) {
    put((int32_t)(quantity | at << 8));
    put(limit);
    put(shift);
}

static void seal(void) {
    words[TABLE_WORDS] = count;
    words[TABLE_CRC] = crc32_words(&words[TABLE_WORDS], count - TABLE_WORDS);
}

static quiesce_table_verdict_t verdict_of(const law_t *law) {
    seal();
    return table_check(law->kind, words, count);
}

static void expect_good(const law_t *law) {
    TEST_ASSERT_EQUAL_INT(QUIESCE_TABLE_OK, verdict_of(law));
}

// Unity has no 64 bits on the target.
static void expect_needs(const law_t *law, uint64_t bits) {
    TEST_ASSERT_TRUE(law->kind->needs(words) == bits);
}

static int32_t tick(const law_t *law) {
    TEST_ASSERT_TRUE(law->step(state, &setup, &view, &demand));
    return demand.value[0];
}

// 100 mN a um/s of the damper, at most 5 N; nothing of the past.
static void make_gain(void) {
    begin(0x314E4C51);
    put(1000);
    put(0);
    put(1);
    put(1);
    put_input(STROKE_VELOCITY, 0, 1000000, 9);
    put(0);
    put(9);
    put(5000);
    put(100);
    expect_good(&law_linear);
}

// One state that goes a 2^-shift of the way to its input in a tick.
static void make_lag(int32_t shift) {
    begin(0x314E4C51);
    put(1000);
    put(1);
    put(1);
    put(1);
    put_input(ACCEL, 0, 1000000, 9);
    put(shift);
    put(-1);
    put(1);
    put(0);
    put(9);
    put(VIEW_LIMIT);
    put(1);
    put(0);
    expect_good(&law_linear);
}

// On while body velocity and stroke velocity have the same sign.
static void make_skyhook(void) {
    begin(0x31475351);
    put(1);
    put(2);
    put(2);
    put(150);
    put_input(VELOCITY, 0, 1000000, 9);
    put_input(STROKE_VELOCITY, 0, 1000000, 9);
    put(1000 * 512);
    put(0);
    put(1);
    put(0);
    put(0);
    put(0);
    put(0);
    put(1);
    static const int32_t current_mA[] = {2000, 100, 200, 1900};
    for (uint32_t i = 0; i < 4; i++) {
        put(current_mA[i]);
    }
    expect_good(&law_signs);
}

static void make_friction(uint32_t ways) {
    begin(0x31524651);
    put(1);
    put(5000);
    put(100000);
    put(30000);
    put(200);
    put((int32_t)ways);
    expect_good(&law_friction);
}

// 1000 mA x |stroke| x velocity^2 + 250.5 mA
static void make_polynomial(void) {
    begin(0x314C5051);
    put(1);
    put(2);
    put(2);
    put_input(STROKE, 0, 1 << 20, 9);
    put(1);
    put_input(STROKE_VELOCITY, 0, 1 << 20, 9);
    put(0);
    put(8 * 1000 * 256); // inputs are half of Q30 at their limits
    put(1 | 2 << 8);
    put(250 * 256 + 128);
    put(0);
    expect_good(&law_polynomial);
}

// ---- linear -------------------------------------------------------------------------------------

static void test_linear_without_states_is_a_gain_with_a_limit(void) {
    make_gain();
    expect_needs(&law_linear, VIEW_STROKE_VELOCITY | VIEW_CURRENT);
    TEST_ASSERT_EQUAL_UINT32(1000, law_linear.kind->rate_Hz(words));
    static const int32_t of[][2] = {{0, 0},     {7, 700},          {-7, -700},        {50, 5000},
                                    {51, 5000}, {-1000000, -5000}, {VIEW_LIMIT, 5000}};
    for (uint32_t i = 0; i < sizeof of / sizeof of[0]; i++) {
        view.damper[0].velocity_um_s = of[i][0];
        TEST_ASSERT_EQUAL_INT32(of[i][1], tick(&law_linear));
    }
}

// What a shift of 20 cuts off adds up: without what is carried on the state would stop 2^20 short.
static void test_linear_slow_lag_arrives(void) {
    make_lag(12);
    view.body[0].accel_um_s2 = 1000;
    int32_t last_mN = -1;
    for (uint32_t i = 0; i < 100000; i++) {
        const int32_t now_mN = tick(&law_linear);
        TEST_ASSERT_GREATER_OR_EQUAL_INT32(last_mN, now_mN);
        last_mN = now_mN;
    }
    TEST_ASSERT_EQUAL_INT32(1000, last_mN);
    view.body[0].accel_um_s2 = 0;
    for (uint32_t i = 0; i < 100000; i++) {
        last_mN = tick(&law_linear);
    }
    TEST_ASSERT_EQUAL_INT32(0, last_mN);
}

// 1 Hz at 1 kHz with 0.1 % of damping, struck once: x1' = -w x2 - 2 d w x1, x2' = w x1, each
// coefficient in 2^-31. 1000 cycles later e^-6.28 of it is left, and it has not drifted.
static void test_linear_lightly_damped_mode_rings(void) {
    begin(0x314E4C51);
    put(1000);
    put(2);
    put(1);
    put(1);
    put_input(ACCEL, 0, 1 << 20, 9);
    put(31);
    // z^-1 = exp(-2 pi j / 1000 - 2 pi / 10^6): cos - 1, -sin, both in units of 2^-31.
    put(-55882);
    put(-13492922);
    put(1 << 20);
    put(31);
    put(13492922);
    put(-55882);
    put(0);
    put(0);
    put(0);
    put(VIEW_LIMIT);
    put(1);
    put(0);
    put(0);
    expect_good(&law_linear);
    view.body[0].accel_um_s2 = 1 << 20;
    for (uint32_t i = 0; i < 100; i++) {
        (void)tick(&law_linear);
    }
    view.body[0].accel_um_s2 = 0;
    int32_t first = 0;
    int32_t last = 0;
    int64_t sum = 0;
    for (uint32_t i = 0; i < 1000000; i++) {
        const int32_t x = tick(&law_linear);
        const int32_t size = x < 0 ? -x : x;
        first = i < 1000 && size > first ? size : first;
        last = i >= 999000 && size > last ? size : last;
        sum += i >= 999000 ? x : 0;
    }
    // e^(-2 pi x .999) of the first cycle's, to 1 % of full scale.
    TEST_ASSERT_INT32_WITHIN(first / 100, (int32_t)(first * 0.001880), last);
    TEST_ASSERT_INT32_WITHIN(first / 1000, 0, (int32_t)(sum / 1000));
}

// An integrator that runs away: one tick without a demand, then from rest.
static void test_linear_overflow_is_no_demand_and_starts_anew(void) {
    begin(0x314E4C51);
    put(1000);
    put(1);
    put(1);
    put(1);
    put_input(ACCEL, 0, 1 << 20, 9);
    put(0);
    put(0);
    put(1);
    put(0);
    put(0);
    put(VIEW_LIMIT);
    put(1);
    put(0);
    expect_good(&law_linear);
    view.body[0].accel_um_s2 = 1 << 19;
    for (int32_t i = 0; i < 3; i++) {
        TEST_ASSERT_EQUAL_INT32(i << 28, tick(&law_linear));
    }
    TEST_ASSERT_FALSE(law_linear.step(state, &setup, &view, &demand));
    TEST_ASSERT_EQUAL_INT32(0, tick(&law_linear));
    int32_t word[QUIESCE_REPORT_WORDS];
    law_linear.report(state, &setup, word);
    TEST_ASSERT_EQUAL_INT32(1, word[0]);
    TEST_ASSERT_EQUAL_INT32(256, word[1]);
}

// The largest numbers that the check lets in: no sum overflows (the sanitizers watch).
static void test_linear_at_the_ends_of_its_ranges(void) {
    begin(0x314E4C51);
    put(1000);
    put(12);
    put(12);
    put(2);
    for (uint32_t i = 0; i < 12; i++) {
        put_input(FORCE, 0, VIEW_LIMIT, 0);
    }
    for (uint32_t i = 0; i < 12; i++) {
        put(46);
        for (uint32_t k = 0; k < 24; k++) {
            put(k % 2u == 0 ? STATE_SPACE_COEFFICIENT_LIMIT - 1
                            : 1 - STATE_SPACE_COEFFICIENT_LIMIT);
        }
    }
    for (uint32_t i = 0; i < 2; i++) {
        put(0);
        put(i == 0 ? 0 : 62);
        put(VIEW_LIMIT);
        for (uint32_t k = 0; k < 24; k++) {
            put(STATE_SPACE_COEFFICIENT_LIMIT - 1);
        }
    }
    expect_good(&law_linear);
    for (uint32_t i = 0; i < 2000; i++) {
        view.damper[0].force_mN = random_word() % 2u == 0 ? VIEW_LIMIT : -VIEW_LIMIT;
        (void)law_linear.step(state, &setup, &view, &demand);
        TEST_ASSERT_INT32_WITHIN(VIEW_LIMIT, 0, demand.value[0]);
    }
}

// ---- signs --------------------------------------------------------------------------------------

static int32_t sign_current_mA(int32_t body_um_s, int32_t stroke_um_s) {
    view.body[0].velocity_um_s = body_um_s;
    view.damper[0].velocity_um_s = stroke_um_s;
    return tick(&law_signs);
}

static void test_signs_take_the_current_of_their_pattern(void) {
    make_skyhook();
    expect_needs(&law_signs, VIEW_VELOCITY | VIEW_STROKE_VELOCITY | VIEW_CURRENT);
    TEST_ASSERT_EQUAL_INT32(150, sign_current_mA(0, 0));
    TEST_ASSERT_EQUAL_INT32(150, sign_current_mA(1000, 5)); // within its band
    TEST_ASSERT_EQUAL_INT32(1900, sign_current_mA(1001, 5));
    TEST_ASSERT_EQUAL_INT32(100, sign_current_mA(5000, -1));
    TEST_ASSERT_EQUAL_INT32(100, sign_current_mA(-1000, -1)); // still on
    TEST_ASSERT_EQUAL_INT32(2000, sign_current_mA(-1001, -1));
    TEST_ASSERT_EQUAL_INT32(200, sign_current_mA(-1001, 1));
    TEST_ASSERT_EQUAL_INT32(200, sign_current_mA(0, 0));
    view.is_at_rest = true;
    TEST_ASSERT_EQUAL_INT32(150, sign_current_mA(-1001, 1));
}

// ---- friction -----------------------------------------------------------------------------------

static int32_t friction_mN(int32_t stroke_nm, int32_t velocity_um_s) {
    view.damper[0].stroke_nm = stroke_nm;
    view.damper[0].velocity_um_s = velocity_um_s;
    return tick(&law_friction);
}

static void test_friction_follows_the_last_peak(void) {
    make_friction(3);
    expect_needs(&law_friction, VIEW_STROKE | VIEW_STROKE_VELOCITY | VIEW_CURRENT);
    TEST_ASSERT_EQUAL_INT32(0, friction_mN(50000, 0));
    TEST_ASSERT_EQUAL_INT32(0, friction_mN(50000, 300)); // 50 um: less than the least
    TEST_ASSERT_EQUAL_INT32(0, friction_mN(2000000, 300));
    TEST_ASSERT_EQUAL_INT32(0,
                            friction_mN(3000000, -200)); // its extreme; no new way within the band
    TEST_ASSERT_EQUAL_INT32(-15000, friction_mN(2900000, -201)); // 5 N/mm x 3 mm
    TEST_ASSERT_EQUAL_INT32(-15000, friction_mN(-1000000, -9000));
    TEST_ASSERT_EQUAL_INT32(5000, friction_mN(-900000, 201)); // 1 mm the other way
    TEST_ASSERT_EQUAL_INT32(5000, friction_mN(9000000, 201));
    TEST_ASSERT_EQUAL_INT32(-30000, friction_mN(9000000, -201)); // its limit
}

static void test_friction_acts_on_the_ways_that_it_is_told(void) {
    static const int32_t expected_mN[][2] = {{-15000, 0}, {0, -15000}, {-15000, -15000}};
    for (uint32_t ways = 1; ways <= 3u; ways++) {
        memset(state, 0, sizeof state);
        make_friction(ways);
        (void)friction_mN(3000000, 300);
        TEST_ASSERT_EQUAL_INT32(expected_mN[ways - 1u][1], friction_mN(1000000, -300));
        TEST_ASSERT_EQUAL_INT32(expected_mN[ways - 1u][0], friction_mN(-1000000, -300));
    }
}

// ---- polynomial ---------------------------------------------------------------------------------

static void test_polynomial_of_a_magnitude_and_a_square(void) {
    make_polynomial();
    static const int32_t at[][3] = {
        // stroke, velocity in 2^-20 of their limits; mA, floor
        {0, 1 << 19, 250},        {1 << 19, 1 << 19, 375},         {-(1 << 19), -(1 << 19), 375},
        {1 << 20, 1 << 20, 1250}, {VIEW_LIMIT, -VIEW_LIMIT, 1250},
    };
    for (uint32_t i = 0; i < sizeof at / sizeof at[0]; i++) {
        view.damper[0].stroke_nm = at[i][0];
        view.damper[0].velocity_um_s = at[i][1];
        TEST_ASSERT_INT32_WITHIN(1, at[i][2], tick(&law_polynomial));
    }
    expect_needs(&law_polynomial, VIEW_STROKE | VIEW_STROKE_VELOCITY | VIEW_CURRENT);
}

static void test_polynomial_stays_within_currents(void) {
    make_polynomial();
    words[TABLE_HEAD_WORDS + 11u] = (uint32_t)VIEW_LIMIT;
    expect_good(&law_polynomial);
    view.damper[0].stroke_nm = VIEW_LIMIT;
    view.damper[0].velocity_um_s = VIEW_LIMIT;
    TEST_ASSERT_EQUAL_INT32(QUIESCE_HIGHEST_CURRENT_mA, tick(&law_polynomial));
    words[TABLE_HEAD_WORDS + 11u] = (uint32_t)-VIEW_LIMIT;
    expect_good(&law_polynomial);
    TEST_ASSERT_EQUAL_INT32(0, tick(&law_polynomial));
}

// ---- what is refused ----------------------------------------------------------------------------

typedef struct {
    const law_t *law;
    void (*make)(void);
} kind_t;

static void make_any_friction(void) {
    make_friction(3);
}

static void make_short_lag(void) {
    make_lag(12);
}

static const kind_t kinds[] = {
    {&law_linear, make_gain},           {&law_linear, make_short_lag},
    {&law_signs, make_skyhook},         {&law_friction, make_any_friction},
    {&law_polynomial, make_polynomial},
};

#define KINDS (sizeof kinds / sizeof kinds[0])

static void test_head_is_checked(void) {
    for (uint32_t i = 0; i < KINDS; i++) {
        const table_kind_t *kind = kinds[i].law->kind;
        kinds[i].make();
        TEST_ASSERT_EQUAL_HEX32(kind->magic, words[TABLE_MAGIC]);
        TEST_ASSERT_EQUAL_INT(QUIESCE_TABLE_SIZE, table_check(kind, words, 2));
        TEST_ASSERT_EQUAL_INT(QUIESCE_TABLE_SIZE, table_check(kind, words, count - 1u));
        TEST_ASSERT_EQUAL_INT(QUIESCE_TABLE_SIZE,
                              table_check(kind, words, QUIESCE_TABLE_WORDS + 1u));
        words[count - 1u] ^= 1u;
        TEST_ASSERT_EQUAL_INT(QUIESCE_TABLE_CRC, table_check(kind, words, count));
        words[TABLE_MAGIC] ^= 1u;
        TEST_ASSERT_EQUAL_INT(QUIESCE_TABLE_MAGIC, table_check(kind, words, count));
        // Longer, and shorter, than its parts say.
        kinds[i].make();
        put(0);
        TEST_ASSERT_EQUAL_INT(QUIESCE_TABLE_SHAPE, verdict_of(kinds[i].law));
        kinds[i].make();
        count--;
        TEST_ASSERT_EQUAL_INT(QUIESCE_TABLE_SHAPE, verdict_of(kinds[i].law));
    }
}

// A controller refuses a table whose bodies or dampers it does not have.
static bool is_of_first_places(uint64_t needs) {
    const uint64_t first = VIEW_ACCEL | VIEW_VELOCITY | VIEW_DISPLACEMENT | VIEW_SUPPLY |
                           VIEW_STROKE | VIEW_STROKE_VELOCITY | VIEW_FORCE | VIEW_CURRENT |
                           VIEW_VOLTAGE | VIEW_TEMPERATURE;
    return (needs & ~first) == 0;
}

// One word after the other, at the ends of what 32 bits hold: refused, or harmless.
static void test_any_word_may_be_anything(void) {
    static const uint32_t ends[] = {0,          1,          4,          5,          13,
                                    63,         0x00000104, 0x01000000, 0x3FFFFFFF, 0x40000000,
                                    0x7FFFFFFF, 0x80000000, 0xFEFFFFFF, 0xFFFFFFFF};
    uint32_t refused = 0;
    uint32_t ran = 0;
    for (uint32_t i = 0; i < KINDS; i++) {
        kinds[i].make();
        const uint32_t last = count;
        for (uint32_t k = TABLE_HEAD_WORDS; k < last; k++) {
            for (uint32_t e = 0; e < sizeof ends / sizeof ends[0]; e++) {
                kinds[i].make();
                words[k] = ends[e];
                if (verdict_of(kinds[i].law) != QUIESCE_TABLE_OK) {
                    refused++;
                } else if (is_of_first_places(kinds[i].law->kind->needs(words))) {
                    ran++;
                    memset(state, 0, sizeof state);
                    for (uint32_t t = 0; t < 20; t++) {
                        view.body[0].velocity_um_s = random_within(VIEW_LIMIT);
                        view.damper[0].velocity_um_s = random_within(VIEW_LIMIT);
                        view.damper[0].stroke_nm = random_within(VIEW_LIMIT);
                        (void)kinds[i].law->step(state, &setup, &view, &demand);
                    }
                }
            }
        }
    }
    TEST_ASSERT_GREATER_THAN_UINT32(300, refused);
    TEST_ASSERT_GREATER_THAN_UINT32(100, ran);
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(test_linear_without_states_is_a_gain_with_a_limit);
    RUN_TEST(test_linear_slow_lag_arrives);
    RUN_TEST(test_linear_lightly_damped_mode_rings);
    RUN_TEST(test_linear_overflow_is_no_demand_and_starts_anew);
    RUN_TEST(test_linear_at_the_ends_of_its_ranges);
    RUN_TEST(test_signs_take_the_current_of_their_pattern);
    RUN_TEST(test_friction_follows_the_last_peak);
    RUN_TEST(test_friction_acts_on_the_ways_that_it_is_told);
    RUN_TEST(test_polynomial_of_a_magnitude_and_a_square);
    RUN_TEST(test_polynomial_stays_within_currents);
    RUN_TEST(test_head_is_checked);
    RUN_TEST(test_any_word_may_be_anything);
    return UNITY_END();
}
