#include "current_loop.h"
#include "unity.h"

static const current_loop_cfg_t usual = {
    .resistance_mohm = 5000,
    .gain_mV_a_mA_q8 = 50 * 256,
    .integral_time_us = 20000,
    .integral_mV = 8000,
    .least_duty = 0,
    .full_scale_mA = 2000,
};
static current_loop_t loop;

void setUp(void) {
    TEST_ASSERT_TRUE(current_loop_init(&loop, &usual));
}

void tearDown(void) {}

static void use(const current_loop_cfg_t *cfg) {
    TEST_ASSERT_TRUE(current_loop_init(&loop, cfg));
}

// A coil that takes its current at once.
static int32_t rest_mA(int32_t duty, int32_t supply_mV, int32_t resistance_mohm) {
    return (int32_t)((int64_t)duty * supply_mV / CURRENT_LOOP_FULL * 1000 / resistance_mohm);
}

static void test_current_loop_settings_out_of_range_are_refused(void) {
    current_loop_cfg_t cfg = usual;
#define REFUSED(field, value)                                                                      \
    cfg = usual;                                                                                   \
    cfg.field = (value);                                                                           \
    TEST_ASSERT_FALSE(current_loop_init(&loop, &cfg))
    REFUSED(resistance_mohm, 99);
    REFUSED(resistance_mohm, 100001);
    REFUSED(gain_mV_a_mA_q8, 0);
    REFUSED(gain_mV_a_mA_q8, 65536);
    REFUSED(integral_time_us, 999);
    REFUSED(integral_time_us, 1000001);
    REFUSED(integral_mV, -1);
    REFUSED(integral_mV, 32768);
    REFUSED(least_duty, -1);
    REFUSED(full_scale_mA, 99);
    REFUSED(full_scale_mA, 16384);
#undef REFUSED
    current_loop_command(&loop, 1000); // idle
    TEST_ASSERT_EQUAL_INT32(0, current_loop_step(&loop, 0, 12000));
}

static void test_current_loop_first_duty_is_feed_forward_and_gain(void) {
    current_loop_command(&loop, 100);
    // 500 mV of resistance, 100 mA times 50 mV/mA, and 25 mV of the integral from the next step on.
    TEST_ASSERT_EQUAL_INT32(5500 * CURRENT_LOOP_FULL / 12000, current_loop_step(&loop, 0, 12000));
    TEST_ASSERT_EQUAL_INT32((500 + 25) * CURRENT_LOOP_FULL / 12000,
                            current_loop_step(&loop, 100, 12000));
}

static void test_current_loop_duty_follows_the_supply(void) {
    current_loop_command(&loop, 1000);
    TEST_ASSERT_EQUAL_INT32(5000 * CURRENT_LOOP_FULL / 24000,
                            current_loop_step(&loop, 1000, 24000));
    TEST_ASSERT_EQUAL_INT32(5000 * CURRENT_LOOP_FULL / 8000, current_loop_step(&loop, 1000, 8000));
    TEST_ASSERT_EQUAL_INT32(CURRENT_LOOP_FULL, current_loop_step(&loop, 1000, 0));
    TEST_ASSERT_EQUAL_INT32(5000 * CURRENT_LOOP_FULL / 60000,
                            current_loop_step(&loop, 1000, INT32_MAX));
}

static void test_current_loop_one_switch_drives_one_way(void) {
    current_loop_command(&loop, -500);
    TEST_ASSERT_EQUAL_INT32(0, current_loop_step(&loop, 500, 12000));
    current_loop_command(&loop, 9000); // full scale is 2 A
    TEST_ASSERT_EQUAL_INT32(10000 * CURRENT_LOOP_FULL / 24000,
                            current_loop_step(&loop, 2000, 24000));
}

static void test_current_loop_full_bridge_drives_both_ways(void) {
    current_loop_cfg_t cfg = usual;
    cfg.least_duty = -CURRENT_LOOP_FULL;
    use(&cfg);
    current_loop_command(&loop, -9000);
    TEST_ASSERT_EQUAL_INT32(-10000 * CURRENT_LOOP_FULL / 24000,
                            current_loop_step(&loop, -2000, 24000));
    TEST_ASSERT_EQUAL_INT32(-CURRENT_LOOP_FULL, current_loop_step(&loop, 2000, 24000));
}

static void test_current_loop_integral_removes_a_wrong_resistance(void) {
    current_loop_command(&loop, 1000);
    int32_t current_mA = 0;
    for (int i = 0; i < 5000; i++) {
        const int32_t duty = current_loop_step(&loop, current_mA, 12000);
        current_mA += (rest_mA(duty, 12000, 6500) - current_mA) / 16;
    }
    TEST_ASSERT_INT32_WITHIN(16, 1000, current_mA);
    TEST_ASSERT_INT32_WITHIN(80, 1500, loop.integral_mV_q12 >> 12);
}

static void test_current_loop_integral_stays_while_the_supply_is_the_limit(void) {
    current_loop_command(&loop, 2000);
    for (int i = 0; i < 10000; i++) {
        TEST_ASSERT_EQUAL_INT32(CURRENT_LOOP_FULL, current_loop_step(&loop, 100, 12000));
    }
    TEST_ASSERT_EQUAL_INT32(0, loop.integral_mV_q12);
    // What leads back counts at once.
    current_loop_command(&loop, 0);
    loop.integral_mV_q12 = 1000 << 12;
    (void)current_loop_step(&loop, -2000, 12000);
    TEST_ASSERT_GREATER_THAN_INT32(1000 << 12, loop.integral_mV_q12 + 1);
}

static void test_current_loop_integral_is_limited(void) {
    current_loop_cfg_t cfg = usual;
    cfg.gain_mV_a_mA_q8 = 1;
    cfg.integral_time_us = 1000;
    cfg.integral_mV = 300;
    use(&cfg);
    current_loop_command(&loop, 100);
    for (int i = 0; i < 200000; i++) {
        (void)current_loop_step(&loop, 0, 60000);
    }
    TEST_ASSERT_EQUAL_INT32(300 << 12, loop.integral_mV_q12);
}

static void test_current_loop_takes_any_word(void) {
    static const int32_t words[] = {INT32_MIN, -60000, -1, 0, 1, 999, 60000, INT32_MAX};
    current_loop_cfg_t cfg = usual;
    cfg.least_duty = -CURRENT_LOOP_FULL;
    cfg.gain_mV_a_mA_q8 = 65535;
    cfg.integral_mV = 32767;
    cfg.full_scale_mA = 16383;
    cfg.resistance_mohm = 100000;
    cfg.integral_time_us = 1000;
    use(&cfg);
    for (uint32_t i = 0; i < 8u * 8u * 8u; i++) {
        current_loop_command(&loop, words[i % 8u]);
        const int32_t duty = current_loop_step(&loop, words[i / 8u % 8u], words[i / 64u]);
        TEST_ASSERT_TRUE(duty >= -CURRENT_LOOP_FULL && duty <= CURRENT_LOOP_FULL);
    }
}

static current_loop_report_t report;

// Steps at which the coil has this current, with the voltage of a resistance.
static bool watched(uint32_t steps, int32_t current_mA, int32_t resistance_mohm) {
    for (uint32_t i = 0; i < steps; i++) {
        loop.integral_mV_q12 = (current_mA * (resistance_mohm - 5000) / 1000) * (1 << 12);
        (void)current_loop_step(&loop, current_mA, 24000);
    }
    return current_loop_report(&loop, 24000, &report);
}

static void test_current_loop_tells_the_resistance_and_its_rise(void) {
    current_loop_command(&loop, 1000);
    TEST_ASSERT_FALSE(watched(CURRENT_LOOP_WINDOW - 1u, 1000, 5000));
    TEST_ASSERT_TRUE(watched(1, 1000, 5000));
    TEST_ASSERT_EQUAL(CURRENT_LOOP_FOLLOWS, report.coil);
    TEST_ASSERT_INT32_WITHIN(5, 5000, report.resistance_mohm);
    TEST_ASSERT_INT32_WITHIN(1, 0, report.rise_degC);
    TEST_ASSERT_FALSE(current_loop_report(&loop, 24000, &report)); // told once
    TEST_ASSERT_TRUE(watched(CURRENT_LOOP_WINDOW, 1000, 6965));    // 100 degC more
    TEST_ASSERT_INT32_WITHIN(5, 6965, report.resistance_mohm);
    TEST_ASSERT_INT32_WITHIN(1, 99, report.rise_degC);
}

static void test_current_loop_window_ends_at_the_current_that_it_began_with(void) {
    current_loop_command(&loop, 500);
    (void)watched(1, 500, 5000);
    TEST_ASSERT_FALSE(watched(2u * CURRENT_LOOP_WINDOW, 900, 5000));
    TEST_ASSERT_TRUE(watched(1, 500 + CURRENT_LOOP_SAME_mA, 5000));
    // Not ever: given up, and a new one begins.
    (void)watched(1, 500, 5000);
    TEST_ASSERT_FALSE(watched(CURRENT_LOOP_WINDOW_MOST - 1u, 900, 5000));
    TEST_ASSERT_EQUAL_UINT32(0, loop.window.count);
}

static void test_current_loop_knows_open_and_short_coils(void) {
    current_loop_command(&loop, 1000);
    TEST_ASSERT_TRUE(watched(CURRENT_LOOP_WINDOW, 0, 5000)); // pushes with all there is
    TEST_ASSERT_EQUAL(CURRENT_LOOP_OPEN, report.coil);
    TEST_ASSERT_EQUAL_INT32(0, report.resistance_mohm);
    TEST_ASSERT_TRUE(watched(CURRENT_LOOP_WINDOW, 1000, 1200));
    TEST_ASSERT_EQUAL(CURRENT_LOOP_SHORT, report.coil);
    TEST_ASSERT_TRUE(watched(CURRENT_LOOP_WINDOW, 1000, 1300));
    TEST_ASSERT_EQUAL(CURRENT_LOOP_FOLLOWS, report.coil);
    current_loop_command(&loop, 0);
    TEST_ASSERT_TRUE(watched(CURRENT_LOOP_WINDOW, 0, 5000)); // nothing is asked for
    TEST_ASSERT_EQUAL(CURRENT_LOOP_UNKNOWN, report.coil);
}

// A coil of 5 ohm and 60 mH at 24 V, whose sensor reads half: its current after these steps.
static int32_t half_seen_mA(uint32_t steps) {
    int32_t current_uA = 0;
    for (uint32_t i = 0; i < steps; i++) {
        const int32_t duty = current_loop_step(&loop, current_uA / 2000, 24000);
        const int32_t coil_uV = duty * 375 / 512 * 1000 - 5 * current_uA;
        current_uA += coil_uV / 600; // 0.1 ms over 60 mH
    }
    return current_uA / 1000;
}

// What docs/explanation/current-loop.md warns of.
static void test_current_loop_believes_a_sensor_that_fails(void) {
    current_loop_command(&loop, 1000);
    TEST_ASSERT_EQUAL_INT32(CURRENT_LOOP_FULL, current_loop_step(&loop, 0, 12000));
    const int32_t current_mA = half_seen_mA(10 * CURRENT_LOOP_WINDOW);
    TEST_ASSERT_INT32_WITHIN(5, 2000, current_mA);
    TEST_ASSERT_TRUE(current_loop_report(&loop, 24000, &report));
    TEST_ASSERT_EQUAL(CURRENT_LOOP_FOLLOWS, report.coil);
    TEST_ASSERT_INT32_WITHIN(50, 10000, report.resistance_mohm);
}

static void test_current_loop_rest_forgets(void) {
    current_loop_command(&loop, 1000);
    (void)watched(100, 900, 5000);
    current_loop_rest(&loop);
    TEST_ASSERT_EQUAL_INT32(0, loop.integral_mV_q12);
    TEST_ASSERT_EQUAL_UINT32(0, loop.window.count);
    TEST_ASSERT_EQUAL_INT32(5000 * CURRENT_LOOP_FULL / 12000,
                            current_loop_step(&loop, 1000, 12000));
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(test_current_loop_settings_out_of_range_are_refused);
    RUN_TEST(test_current_loop_first_duty_is_feed_forward_and_gain);
    RUN_TEST(test_current_loop_duty_follows_the_supply);
    RUN_TEST(test_current_loop_one_switch_drives_one_way);
    RUN_TEST(test_current_loop_full_bridge_drives_both_ways);
    RUN_TEST(test_current_loop_integral_removes_a_wrong_resistance);
    RUN_TEST(test_current_loop_integral_stays_while_the_supply_is_the_limit);
    RUN_TEST(test_current_loop_integral_is_limited);
    RUN_TEST(test_current_loop_takes_any_word);
    RUN_TEST(test_current_loop_tells_the_resistance_and_its_rise);
    RUN_TEST(test_current_loop_window_ends_at_the_current_that_it_began_with);
    RUN_TEST(test_current_loop_knows_open_and_short_coils);
    RUN_TEST(test_current_loop_believes_a_sensor_that_fails);
    RUN_TEST(test_current_loop_rest_forgets);
    return UNITY_END();
}
