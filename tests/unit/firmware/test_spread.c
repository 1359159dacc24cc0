#include "spread.h"
#include "unity.h"

enum { POWERS = 64, END = 52, LEAST_um_s2 = 20000, ENOUGH = 16, FORGOTTEN = 400 };

static spread_t spread;
static uint64_t power[POWERS];

// 3.2 to 6.75 Hz, read up to 50 Hz; a bin is 0.977 Hz.
void setUp(void) {
    spread_init(&spread, &(spread_cfg_t){3200, 6750, LEAST_um_s2});
    for (uint32_t k = 0; k < POWERS; k++) {
        power[k] = 0;
    }
}
void tearDown(void) {}

// A tone of this RMS in the middle of bin k, as the Hann window shows it.
static void put(uint32_t k, uint64_t rms_um_s2) {
    const uint64_t square = 2u * rms_um_s2 * rms_um_s2;
    power[k] += square;
    power[k - 1u] += square / 4u;
    power[k + 1u] += square / 4u;
}

static void read(uint32_t spectra) {
    for (uint32_t i = 0; i < spectra; i++) {
        spread_take(&spread, power, 1, END);
    }
}

static void only(uint32_t k, uint64_t rms_um_s2) {
    setUp();
    put(k, rms_um_s2);
    read(ENOUGH);
}

static void test_a_narrow_band_is_told_by_where_it_lies(void) {
    for (uint32_t k = 3; k < 50; k++) {
        only(k, 5u * LEAST_um_s2);
        // 4 to 6 are 3.9 to 5.9 Hz; 7 is 6.84 Hz, 3 is 2.93 Hz.
        TEST_ASSERT_EQUAL(k >= 4u && k <= 6u, spread.is_narrow);
    }
}

static void test_it_takes_some_spectra(void) {
    put(5, 5u * LEAST_um_s2);
    read(ENOUGH - 1);
    TEST_ASSERT_FALSE(spread.is_narrow);
    read(1);
    TEST_ASSERT_TRUE(spread.is_narrow);
    spread_forget(&spread);
    TEST_ASSERT_FALSE(spread.is_narrow);
    read(ENOUGH - 1);
    TEST_ASSERT_FALSE(spread.is_narrow);
}

static void test_little_motion_is_none(void) {
    only(5, LEAST_um_s2 - LEAST_um_s2 / 100u);
    TEST_ASSERT_FALSE(spread.is_narrow);
    only(5, LEAST_um_s2 + LEAST_um_s2 / 100u);
    TEST_ASSERT_TRUE(spread.is_narrow);
    // What is narrow stays so down to half of the power.
    setUp();
    put(5, LEAST_um_s2 * 3u / 4u);
    read(FORGOTTEN);
    TEST_ASSERT_FALSE(spread.is_narrow);
    only(5, 2u * LEAST_um_s2);
    const spread_t narrow = spread;
    setUp();
    spread = narrow;
    put(5, LEAST_um_s2 * 3u / 4u);
    read(FORGOTTEN);
    TEST_ASSERT_TRUE(spread.is_narrow);
    setUp();
    spread = narrow;
    put(5, LEAST_um_s2 / 2u);
    read(FORGOTTEN);
    TEST_ASSERT_FALSE(spread.is_narrow);
}

// Beside 5 units at 4.9 Hz two at 2.9 Hz, which are displacement, and tenths at 11.7 Hz, which are
// acceleration: with 45 of them (v/x)^2 is .47 of (a/v)^2, with 50 .44, with 60 .40, all in band.
static void mix(uint32_t tenths) {
    for (uint32_t k = 0; k < POWERS; k++) {
        power[k] = 0;
    }
    put(5, 5u * LEAST_um_s2);
    put(3, 2u * LEAST_um_s2);
    put(12, tenths * LEAST_um_s2 / 10u);
    read(FORGOTTEN);
}

static void test_what_is_broad_is_not_narrow(void) {
    mix(60);
    TEST_ASSERT_FALSE(spread.is_narrow);
    mix(50);
    TEST_ASSERT_FALSE(spread.is_narrow);
    mix(45);
    TEST_ASSERT_TRUE(spread.is_narrow);
    mix(50);
    TEST_ASSERT_TRUE(spread.is_narrow);
    mix(60);
    TEST_ASSERT_FALSE(spread.is_narrow);
}

// What lies far above counts as acceleration: it makes a band broad, or moves it out.
static void test_what_lies_far_above_is_not_left_out(void) {
    put(5, 5u * LEAST_um_s2);
    put(40, 3u * LEAST_um_s2);
    read(ENOUGH);
    TEST_ASSERT_TRUE(spread.is_narrow);
    put(40, 8u * LEAST_um_s2);
    read(FORGOTTEN);
    TEST_ASSERT_FALSE(spread.is_narrow);
}

static void test_a_constant_part_is_not_read(void) {
    put(5, 5u * LEAST_um_s2);
    power[0] = power[1] = UINT64_C(1) << 60;
    read(ENOUGH);
    TEST_ASSERT_TRUE(spread.is_narrow);
}

static void test_the_largest_powers_do_not_overflow(void) {
    for (uint32_t k = 0; k < POWERS; k++) {
        power[k] = (UINT64_C(1) << 61) - 1u;
    }
    read(FORGOTTEN);
    TEST_ASSERT_FALSE(spread.is_narrow);
    TEST_ASSERT_TRUE(spread.mean[0] > UINT64_C(48) << 53 && spread.mean[0] < UINT64_C(52) << 53);
    only(5, UINT64_C(1) << 29);
    TEST_ASSERT_TRUE(spread.is_narrow);
}

static void test_the_mean_forgets(void) {
    only(20, 100u * LEAST_um_s2);
    TEST_ASSERT_FALSE(spread.is_narrow);
    const spread_t other = spread;
    setUp();
    spread = other;
    put(5, 5u * LEAST_um_s2);
    read(32);
    TEST_ASSERT_FALSE(spread.is_narrow);
    read(FORGOTTEN);
    TEST_ASSERT_TRUE(spread.is_narrow);
}

static void test_silence_is_not_narrow_and_nothing_wanted_is_told(void) {
    read(FORGOTTEN);
    TEST_ASSERT_FALSE(spread.is_narrow);
    TEST_ASSERT_TRUE(spread_is_wanted(&spread));
    spread_init(&spread, &(spread_cfg_t){3200, 0, 0});
    TEST_ASSERT_FALSE(spread_is_wanted(&spread));
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(test_a_narrow_band_is_told_by_where_it_lies);
    RUN_TEST(test_it_takes_some_spectra);
    RUN_TEST(test_little_motion_is_none);
    RUN_TEST(test_what_is_broad_is_not_narrow);
    RUN_TEST(test_what_lies_far_above_is_not_left_out);
    RUN_TEST(test_a_constant_part_is_not_read);
    RUN_TEST(test_the_largest_powers_do_not_overflow);
    RUN_TEST(test_the_mean_forgets);
    RUN_TEST(test_silence_is_not_narrow_and_nothing_wanted_is_told);
    return UNITY_END();
}
