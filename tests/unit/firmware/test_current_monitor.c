// The current monitor at its edges: what it expects, tick by tick, and the ticks of each verdict.
#include "current_monitor.h"
#include "unity.h"

#include <stddef.h>

static current_monitor_t monitor;

void setUp(void) {}
void tearDown(void) {}

static void start(current_check_t check, int32_t trip_mA, int32_t initial_mA) {
    const current_monitor_cfg_t cfg = {
        .check = check,
        .tick_rate_Hz = 1000,
        .error_mA = 100,
        .lag_us = 6000,
        .fault_ticks = 10,
        .trip_mA = trip_mA,
        .trip_ticks = 5,
    };
    current_monitor_init(&monitor, &cfg);
    current_monitor_follow(&monitor, initial_mA);
}

static current_verdict_t step(int32_t measured_mA) {
    return current_monitor_step(&monitor, 1000, measured_mA, CURRENT_NEW);
}

// In ticks of a measurement that stays, until this verdict.
static uint32_t ticks_until(current_verdict_t verdict, int32_t measured_mA) {
    for (uint32_t i = 1; i <= 100; i++) {
        if (step(measured_mA) == verdict) {
            return i;
        }
    }
    return 0;
}

// Half of six ticks of lag: a quarter of the step in a tick, exactly.
static void test_the_expectation_starts_at_the_initial_current_and_lags(void) {
    start(CURRENT_CHECK_ALWAYS, 0, 20000);
    TEST_ASSERT_TRUE(monitor.early.mA_q14 == 20000 * 16384);
    TEST_ASSERT_EQUAL_INT32(20000, current_monitor_expected_mA(&monitor));
    TEST_ASSERT_EQUAL_INT32(1 << 28, monitor.early.gain_q30);
    (void)current_monitor_step(&monitor, 0, 15000, CURRENT_NEW);
    TEST_ASSERT_TRUE(monitor.early.mA_q14 == 15000 * 16384);
    (void)current_monitor_step(&monitor, 20000, 16250, CURRENT_NEW);
    TEST_ASSERT_TRUE(monitor.early.mA_q14 == 16250 * 16384);
    TEST_ASSERT_EQUAL_INT32(16250, current_monitor_expected_mA(&monitor));
}

static void test_what_is_followed_is_expected_and_forgives(void) {
    start(CURRENT_CHECK_ALWAYS, 1500, 0);
    for (uint32_t i = 0; i < 9; i++) {
        TEST_ASSERT_EQUAL(CURRENT_OK, step(0));
    }
    current_monitor_follow(&monitor, 700);
    TEST_ASSERT_EQUAL_INT32(700, current_monitor_expected_mA(&monitor));
    TEST_ASSERT_EQUAL(CURRENT_OK, step(775)); // a quarter of the way
    TEST_ASSERT_EQUAL_INT32(775, current_monitor_expected_mA(&monitor));
    TEST_ASSERT_EQUAL(10, ticks_until(CURRENT_NOT_FOLLOWING, -1000));
    current_monitor_follow(&monitor, 0);
    for (uint32_t i = 0; i < 4; i++) {
        (void)step(1600); // a trip goes on
        current_monitor_follow(&monitor, 1600);
    }
    TEST_ASSERT_EQUAL(CURRENT_OVER, step(1600));
}

static void test_no_lag_is_the_command(void) {
    const current_monitor_cfg_t cfg = {
        .check = CURRENT_CHECK_ALWAYS, .tick_rate_Hz = 4000, .error_mA = 1, .fault_ticks = 1};
    current_monitor_init(&monitor, &cfg);
    TEST_ASSERT_EQUAL_INT32(1 << 30, monitor.early.gain_q30);
    TEST_ASSERT_EQUAL(CURRENT_OK, current_monitor_step(&monitor, 20000, 20001, CURRENT_NEW));
    TEST_ASSERT_EQUAL(CURRENT_NOT_FOLLOWING,
                      current_monitor_step(&monitor, 20000, 20002, CURRENT_NEW));
}

static void test_the_error_itself_is_allowed_on_either_side(void) {
    start(CURRENT_CHECK_ALWAYS, 0, 1000);
    TEST_ASSERT_EQUAL_UINT32(0, ticks_until(CURRENT_NOT_FOLLOWING, 1100));
    TEST_ASSERT_EQUAL_UINT32(0, ticks_until(CURRENT_NOT_FOLLOWING, 900));
    TEST_ASSERT_EQUAL_UINT32(10, ticks_until(CURRENT_NOT_FOLLOWING, 1101));
    start(CURRENT_CHECK_ALWAYS, 0, 1000);
    TEST_ASSERT_EQUAL_UINT32(10, ticks_until(CURRENT_NOT_FOLLOWING, 899));
}

static void test_a_trip_at_the_level_is_none_and_comes_in_its_time_beyond(void) {
    start(CURRENT_CHECK_NEVER, 3000, 1000);
    TEST_ASSERT_EQUAL_UINT32(0, ticks_until(CURRENT_OVER, 3000));
    TEST_ASSERT_EQUAL_UINT32(0, ticks_until(CURRENT_OVER, -3000));
    TEST_ASSERT_EQUAL_UINT32(5, ticks_until(CURRENT_OVER, 3001));
    start(CURRENT_CHECK_NEVER, 3000, 1000);
    TEST_ASSERT_EQUAL_UINT32(5, ticks_until(CURRENT_OVER, -3001));
}

static void test_the_least_level_of_a_trip_trips(void) {
    start(CURRENT_CHECK_NEVER, 1, 0);
    TEST_ASSERT_EQUAL_UINT32(5, ticks_until(CURRENT_OVER, 2));
    start(CURRENT_CHECK_NEVER, 0, 0);
    TEST_ASSERT_EQUAL_UINT32(0, ticks_until(CURRENT_OVER, INT32_MAX));
}

static void test_good_ticks_take_back_an_eighth_of_a_trip(void) {
    start(CURRENT_CHECK_NEVER, 3000, 1000);
    for (uint32_t i = 0; i < 4; i++) {
        TEST_ASSERT_EQUAL(CURRENT_OK, step(3001));
    }
    for (uint32_t i = 0; i < 8; i++) { // one of the four
        TEST_ASSERT_EQUAL(CURRENT_OK, step(1000));
    }
    TEST_ASSERT_EQUAL(CURRENT_OK, step(3001));
    TEST_ASSERT_EQUAL(CURRENT_OVER, step(3001));
}

static void test_good_ticks_take_back_a_quarter_of_an_error(void) {
    start(CURRENT_CHECK_ALWAYS, 0, 1000);
    for (uint32_t i = 0; i < 9; i++) {
        TEST_ASSERT_EQUAL(CURRENT_OK, step(2000));
    }
    for (uint32_t i = 0; i < 4; i++) {
        TEST_ASSERT_EQUAL(CURRENT_OK, step(1000));
    }
    TEST_ASSERT_EQUAL(CURRENT_OK, step(2000));
    TEST_ASSERT_EQUAL(CURRENT_NOT_FOLLOWING, step(2000));
}

// A single bad tick is forgotten to the last count.
static void test_counts_go_back_to_nothing(void) {
    start(CURRENT_CHECK_ALWAYS, 3000, 1000);
    (void)step(5000);
    for (uint32_t i = 0; i < 8; i++) {
        (void)step(1000);
    }
    TEST_ASSERT_EQUAL_UINT32(0, monitor.over);
    TEST_ASSERT_EQUAL_UINT32(0, monitor.wrong);
}

static void test_a_coil_is_open_from_twice_the_error_on(void) {
    start(CURRENT_CHECK_ALWAYS, 0, 200);
    for (uint32_t i = 0; i < 10; i++) {
        (void)current_monitor_step(&monitor, 200, 49, CURRENT_NEW);
    }
    TEST_ASSERT_EQUAL(CURRENT_OPEN_COIL, current_monitor_step(&monitor, 200, 49, CURRENT_NEW));
    TEST_ASSERT_EQUAL(CURRENT_OPEN_COIL, current_monitor_step(&monitor, 200, -49, CURRENT_NEW));
    TEST_ASSERT_EQUAL(CURRENT_NOT_FOLLOWING, current_monitor_step(&monitor, 200, 50, CURRENT_NEW));
    start(CURRENT_CHECK_ALWAYS, 0, 199);
    for (uint32_t i = 0; i < 10; i++) {
        (void)current_monitor_step(&monitor, 199, 0, CURRENT_NEW);
    }
    TEST_ASSERT_EQUAL(CURRENT_NOT_FOLLOWING, current_monitor_step(&monitor, 199, 0, CURRENT_NEW));
}

// A driver's current in the pulses of a law, twice a vibration's cycle: the coil behind a command
// that it hears some ticks late.
typedef struct {
    uint32_t rate_Hz;
    uint32_t freq_Hz;
    uint32_t lag_us;
    uint32_t delay_ticks;
    uint32_t share_pct; ///< of the time with current
    uint32_t cycle_ms;  ///< between two measurements; 0: one a tick
} pulses_t;

enum { HIGH_mA = 5000, PULSE_FAULT_TICKS = 50 };

static void start_pulses(uint32_t rate_Hz) {
    const current_monitor_cfg_t cfg = {.check = CURRENT_CHECK_ALWAYS,
                                       .tick_rate_Hz = rate_Hz,
                                       .error_mA = 500,
                                       .lag_us = 5000,
                                       .fault_ticks = PULSE_FAULT_TICKS * rate_Hz / 1000u};
    current_monitor_init(&monitor, &cfg);
}

static uint16_t pulse_mA(const pulses_t *p, uint32_t tick) {
    const uint32_t in_cycle = tick * p->freq_Hz * 2u % p->rate_Hz;
    return in_cycle * 100u < p->share_pct * p->rate_Hz ? HIGH_mA : 0u;
}

typedef int32_t (*fault_t)(int32_t coil_mA);

// Ticks until a verdict; 0: none in four seconds.
static uint32_t ticks_of_pulses(const pulses_t *p, fault_t fault) {
    int64_t coil_uA = 0;
    int32_t measured_mA = 0;
    start_pulses(p->rate_Hz);
    for (uint32_t tick = 1; tick < 4u * p->rate_Hz; tick++) {
        const uint32_t heard = tick > p->delay_ticks + 1u ? tick - p->delay_ticks - 1u : 0u;
        const int64_t towards_uA = (int64_t)1000 * pulse_mA(p, heard) - coil_uA;
        coil_uA += towards_uA * 1000000 / (1000000 + (int64_t)p->lag_us * p->rate_Hz);
        const int32_t coil_mA = (int32_t)(coil_uA / 1000);
        const bool is_new = p->cycle_ms == 0u || tick % (p->cycle_ms * p->rate_Hz / 1000u) == 1u;
        measured_mA = !is_new ? measured_mA : fault != NULL ? fault(coil_mA) : coil_mA;
        if (current_monitor_step(&monitor, pulse_mA(p, tick - 1u), measured_mA,
                                 is_new ? CURRENT_NEW : CURRENT_OLD) != CURRENT_OK) {
            return tick;
        }
    }
    return 0;
}

static void test_half_and_twice_the_lag_on_a_bus_follow(void) {
    static const uint32_t rates_Hz[] = {500, 1000, 2000, 4000};
    static const uint32_t lags_us[] = {2500, 3500, 5000, 7000, 10000};
    static const uint32_t freqs_Hz[] = {2, 4, 8, 11, 16, 22};
    for (uint32_t i = 0; i < 4u * 5u * 6u * 3u * 2u; i++) {
        const uint32_t rate_Hz = rates_Hz[i % 4u];
        const pulses_t p = {.rate_Hz = rate_Hz,
                            .lag_us = lags_us[i / 4u % 5u],
                            .freq_Hz = freqs_Hz[i / 20u % 6u],
                            .delay_ticks = i / 120u % 3u * rate_Hz / 1000u,
                            .share_pct = 50,
                            .cycle_ms = i / 360u * 10u};
        const uint32_t ticks = ticks_of_pulses(&p, NULL);
        TEST_ASSERT_EQUAL_UINT32(0, ticks == 0u ? 0u : i * 100000u + ticks); // which one
    }
}

static int32_t open_coil(int32_t coil_mA) {
    return 0 * coil_mA;
}

static int32_t stuck_high(int32_t coil_mA) {
    return HIGH_mA + 0 * coil_mA;
}

static int32_t half_of_it(int32_t coil_mA) {
    return coil_mA / 2;
}

static int32_t stuck_in_the_middle(int32_t coil_mA) {
    return HIGH_mA / 2 + 0 * coil_mA;
}

// Of a driver on a bus whose measurement comes every 10 ms.
static void test_faults_are_found_between_two_measurements_too(void) {
    static const fault_t faults[] = {open_coil, stuck_high, half_of_it};
    static const uint32_t freqs_Hz[] = {4, 8, 16, 22};
    for (uint32_t i = 0; i < 3u; i++) {
        for (uint32_t k = 0; k < 4u; k++) {
            const pulses_t p = {.rate_Hz = 1000,
                                .lag_us = 5000,
                                .freq_Hz = freqs_Hz[k],
                                .share_pct = 50,
                                .cycle_ms = 10};
            const uint32_t ticks = ticks_of_pulses(&p, faults[i]);
            TEST_ASSERT_TRUE(ticks > 0u);
            TEST_ASSERT_LESS_OR_EQUAL_UINT32(260, ticks);
        }
    }
}

// What the band costs: the ticks of a fault within which it is told, at 1 kHz.
static void test_faults_of_a_driver_in_pulses_are_found(void) {
    static const struct {
        fault_t fault;
        uint32_t share_pct;
        uint32_t most_ticks;
    } rows[] = {
        {open_coil, 50, 100},           {open_coil, 30, 210},  {open_coil, 80, 60},
        {stuck_high, 50, 120},          {half_of_it, 50, 270}, {half_of_it, 80, 80},
        {stuck_in_the_middle, 30, 140},
    };
    static const uint32_t freqs_Hz[] = {4, 8, 16, 22};
    for (uint32_t i = 0; i < sizeof rows / sizeof rows[0]; i++) {
        for (uint32_t k = 0; k < 4u; k++) {
            const pulses_t p = {.rate_Hz = 1000,
                                .lag_us = 5000,
                                .freq_Hz = freqs_Hz[k],
                                .share_pct = rows[i].share_pct};
            const uint32_t ticks = ticks_of_pulses(&p, rows[i].fault);
            TEST_ASSERT_TRUE(ticks > 0u);
            TEST_ASSERT_LESS_OR_EQUAL_UINT32(rows[i].most_ticks, ticks);
        }
    }
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(test_half_and_twice_the_lag_on_a_bus_follow);
    RUN_TEST(test_faults_of_a_driver_in_pulses_are_found);
    RUN_TEST(test_faults_are_found_between_two_measurements_too);
    RUN_TEST(test_the_expectation_starts_at_the_initial_current_and_lags);
    RUN_TEST(test_what_is_followed_is_expected_and_forgives);
    RUN_TEST(test_no_lag_is_the_command);
    RUN_TEST(test_the_error_itself_is_allowed_on_either_side);
    RUN_TEST(test_a_trip_at_the_level_is_none_and_comes_in_its_time_beyond);
    RUN_TEST(test_the_least_level_of_a_trip_trips);
    RUN_TEST(test_good_ticks_take_back_an_eighth_of_a_trip);
    RUN_TEST(test_good_ticks_take_back_a_quarter_of_an_error);
    RUN_TEST(test_counts_go_back_to_nothing);
    RUN_TEST(test_a_coil_is_open_from_twice_the_error_on);
    return UNITY_END();
}
