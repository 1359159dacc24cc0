// The wired controller, through the lock-step server as every target runs it.
#include "lockstep.h"

#include <stddef.h>

#include "test_signal.h"
#include "unity.h"

static lockstep_t server;
static lockstep_reply_t reply;
static quiesce_params_t params;
static uint32_t flags;
static uint32_t time_ticks;
static uint32_t noise_seed;

static void start(void) {
    flags = LOCKSTEP_FRESH | LOCKSTEP_ENABLE;
    time_ticks = 0;
    noise_seed = 1;
    TEST_ASSERT_TRUE(lockstep_start(&server, NULL, &params, NULL));
}

void setUp(void) {
    quiesce_params_default(&params);
}
void tearDown(void) {}

// Its edge arms: enable comes with the second tick.
static void tick(int32_t accel_counts, int32_t current_mA) {
    const uint32_t given = time_ticks > 0 ? flags : flags & ~LOCKSTEP_ENABLE;
    const lockstep_stimulus_t in = {given, {accel_counts}, {current_mA}};
    lockstep_exchange(&server, &in, &reply);
    time_ticks++;
}

// A vibration of 0.3 m/s2 at freq_mHz in 0.5 mg of noise.
static void vibrate(uint32_t freq_mHz, uint32_t ticks) {
    for (uint32_t i = 0; i < ticks; i++) {
        const int32_t noise = signal_noise(&noise_seed, 147);
        tick(signal_sine(5195, freq_mHz, time_ticks, 1000) + noise, 0);
    }
}

static void assert_state(quiesce_state_t state, quiesce_fault_t fault) {
    TEST_ASSERT_EQUAL_UINT32(state, reply.telemetry.state);
    TEST_ASSERT_EQUAL_UINT32(fault, reply.telemetry.fault);
    if (state != QUIESCE_STATE_RUN) {
        TEST_ASSERT_EQUAL_INT32(params.safe_current_mA, reply.current_cmd_mA[0]);
    }
}

static void test_chain_reaches_the_rule_bases_current(void) {
    params.law = QUIESCE_LAW_FUZZY;
    start();
    vibrate(10000, 200);
    assert_state(QUIESCE_STATE_SELF_TEST, QUIESCE_FAULT_NONE);
    vibrate(10000, 300);
    assert_state(QUIESCE_STATE_RUN, QUIESCE_FAULT_NONE);
    TEST_ASSERT_EQUAL_INT32(5000, reply.current_cmd_mA[0]); // unlock_current_mA
    vibrate(10000, 1000);
    TEST_ASSERT_EQUAL_UINT32(1, reply.telemetry.freq_is_valid);
    TEST_ASSERT_INT32_WITHIN(5000, 10000000, reply.telemetry.freq_uHz);
    TEST_ASSERT_INT32_WITHIN(3000, 212000, reply.telemetry.rms_um_s2);
    TEST_ASSERT_INT32_WITHIN(5, 5000, reply.current_cmd_mA[0]);
    vibrate(5000, 1500);
    TEST_ASSERT_INT32_WITHIN(20, 0, reply.current_cmd_mA[0]);
}

static void test_unlock_current_is_not_the_safe_current(void) {
    params.law = QUIESCE_LAW_FUZZY;
    params.unlock_current_mA = 3210;
    params.safe_current_mA = 123;
    start();
    vibrate(10000, 100);
    assert_state(QUIESCE_STATE_SELF_TEST, QUIESCE_FAULT_NONE);
    vibrate(10000, 400);
    TEST_ASSERT_EQUAL_INT32(3210, reply.current_cmd_mA[0]);
}

// A vibration that a lock has followed since it was in the band, further and further out of it.
static void leave_the_band(uint32_t from_mHz, uint32_t to_mHz) {
    int64_t phase_turn = 0;
    params.law = QUIESCE_LAW_PHASE;
    start();
    vibrate(from_mHz, 4000);
    TEST_ASSERT_EQUAL_UINT32(1, reply.telemetry.lock_is_on);
    for (uint32_t i = 0; i < 60000; i++) {
        const int64_t freq_mHz = from_mHz + ((int64_t)to_mHz - from_mHz) * i / 60000;
        phase_turn += freq_mHz * (INT64_C(1) << 32) / 1000000;
        tick(signal_cosine(5195, (uint32_t)phase_turn) + signal_noise(&noise_seed, 147), 0);
        const bool is_out =
            freq_mHz * 4 < params.band_low_mHz * 3 || freq_mHz * 3 > params.band_high_mHz * 4;
        TEST_ASSERT_FALSE(is_out && reply.telemetry.lock_is_on != 0);
    }
}

static void test_lock_does_not_leave_the_band(void) {
    leave_the_band(15000, 60000);
    leave_the_band(3000, 300);
}

static void test_refused_parameter_latches_and_keeps_the_safe_current(void) {
    params.safe_current_mA = 400;
    params.law = 99;
    TEST_ASSERT_FALSE(lockstep_start(&server, NULL, &params, NULL));
    flags = LOCKSTEP_FRESH | LOCKSTEP_ENABLE | LOCKSTEP_FAULT_RESET;
    vibrate(10000, 600);
    assert_state(QUIESCE_STATE_FAULT, QUIESCE_FAULT_PARAMETER);
    TEST_ASSERT_EQUAL_UINT32(0, reply.drivers_enabled);
}

static void bad_samples(quiesce_fault_t fault, int32_t counts, bool is_fresh, uint32_t ticks) {
    params.law = QUIESCE_LAW_CONSTANT;
    start();
    vibrate(10000, 1500);
    assert_state(QUIESCE_STATE_RUN, QUIESCE_FAULT_NONE);
    TEST_ASSERT_EQUAL_INT32(5000, reply.current_cmd_mA[0]);
    flags = LOCKSTEP_ENABLE | (is_fresh ? LOCKSTEP_FRESH : 0);
    for (uint32_t i = 0; i < ticks; i++) {
        tick(counts, 0);
    }
    assert_state(QUIESCE_STATE_SAFE, fault);
    TEST_ASSERT_EQUAL_UINT32(0, reply.telemetry.freq_is_valid);
    TEST_ASSERT_TRUE(reply.telemetry.bad_sample_count > 0);
    flags = LOCKSTEP_FRESH | LOCKSTEP_ENABLE;
    vibrate(10000, 200);
    assert_state(QUIESCE_STATE_SAFE, fault);
    vibrate(10000, 100);
    assert_state(QUIESCE_STATE_RUN, QUIESCE_FAULT_NONE);
}

static void test_sensor_faults_lead_to_safe_and_back(void) {
    bad_samples(QUIESCE_FAULT_SENSOR_LOST, 0, false, 12);
    bad_samples(QUIESCE_FAULT_SENSOR_SATURATED, 8388607, true, 12);
    bad_samples(QUIESCE_FAULT_SENSOR_RANGE, -9000000, true, 12);
    bad_samples(QUIESCE_FAULT_SENSOR_STUCK, 4711, true, 252);
}

static void test_quiet_sensor_leads_to_safe_and_back(void) {
    params.law = QUIESCE_LAW_CONSTANT;
    params.sensor_min_noise_counts = 20;
    start();
    vibrate(10000, 3000);
    assert_state(QUIESCE_STATE_RUN, QUIESCE_FAULT_NONE);
    for (uint32_t i = 0; i < 2000; i++) {
        tick(i / 10 % 2 ? 300 : 301, 0);
    }
    assert_state(QUIESCE_STATE_SAFE, QUIESCE_FAULT_SENSOR_QUIET);
    TEST_ASSERT_EQUAL_UINT32(0, reply.telemetry.freq_is_valid);
    vibrate(10000, 250); // the noise check has not yet seen enough
    assert_state(QUIESCE_STATE_SAFE, QUIESCE_FAULT_SENSOR_QUIET);
    vibrate(10000, 1000);
    assert_state(QUIESCE_STATE_RUN, QUIESCE_FAULT_NONE);
}

static void test_short_dropout_is_bridged(void) {
    params.law = QUIESCE_LAW_CONSTANT;
    start();
    vibrate(10000, 1500);
    flags = LOCKSTEP_ENABLE;
    vibrate(10000, 9);
    assert_state(QUIESCE_STATE_RUN, QUIESCE_FAULT_NONE);
    TEST_ASSERT_EQUAL_UINT32(9, reply.telemetry.bad_sample_count);
}

static void test_emergency_stop_latches_within_its_tick(void) {
    params.law = QUIESCE_LAW_CONSTANT;
    start();
    vibrate(10000, 500);
    flags |= LOCKSTEP_ESTOP;
    vibrate(10000, 1);
    assert_state(QUIESCE_STATE_FAULT, QUIESCE_FAULT_ESTOP);
    TEST_ASSERT_EQUAL_UINT32(0, reply.drivers_enabled);
    flags = LOCKSTEP_FRESH | LOCKSTEP_ENABLE;
    vibrate(10000, 500);
    assert_state(QUIESCE_STATE_FAULT, QUIESCE_FAULT_ESTOP);
    flags |= LOCKSTEP_FAULT_RESET;
    vibrate(10000, 500); // enable is still held: that restarts nothing
    assert_state(QUIESCE_STATE_IDLE, QUIESCE_FAULT_NONE);
    flags = LOCKSTEP_FRESH;
    vibrate(10000, 1);
    flags |= LOCKSTEP_ENABLE;
    vibrate(10000, 2);
    assert_state(QUIESCE_STATE_RUN, QUIESCE_FAULT_NONE);
}

static void test_enable_held_from_the_start_runs_nothing(void) {
    params.law = QUIESCE_LAW_CONSTANT;
    start();
    time_ticks = 1; // the first tick finds it
    vibrate(10000, 3000);
    assert_state(QUIESCE_STATE_IDLE, QUIESCE_FAULT_NONE);
}

static void test_disable_takes_the_current_away_and_enable_returns_it(void) {
    params.law = QUIESCE_LAW_CONSTANT;
    start();
    vibrate(10000, 500);
    flags = LOCKSTEP_FRESH;
    vibrate(10000, 1);
    assert_state(QUIESCE_STATE_IDLE, QUIESCE_FAULT_NONE);
    flags |= LOCKSTEP_ENABLE;
    vibrate(10000, 1);
    assert_state(QUIESCE_STATE_ARMED, QUIESCE_FAULT_NONE);
    vibrate(10000, 1);
    assert_state(QUIESCE_STATE_RUN, QUIESCE_FAULT_NONE);
}

// A coil with the expected lag, of which share_percent of the current arrives.
static void run_coil(int32_t share_percent, bool is_measured, uint32_t ticks) {
    int64_t coil_uA = 0;
    for (uint32_t i = 0; i < ticks; i++) {
        const uint32_t measured = is_measured ? LOCKSTEP_HAS_CURRENT : 0;
        flags = LOCKSTEP_FRESH | LOCKSTEP_ENABLE | measured;
        const int32_t noise = signal_noise(&noise_seed, 147);
        tick(signal_sine(5195, 10000, time_ticks, 1000) + noise, (int32_t)(coil_uA / 1000));
        const int64_t driven_mA = reply.drivers_enabled != 0 ? reply.current_cmd_mA[0] : 0;
        coil_uA += (driven_mA * 10 * share_percent - coil_uA) / 6;
    }
}

static void test_current_check_tells_its_faults_apart(void) {
    params.law = QUIESCE_LAW_CONSTANT;
    params.current_check = QUIESCE_CURRENT_CHECK_ON;
    start();
    run_coil(100, true, 2000);
    assert_state(QUIESCE_STATE_RUN, QUIESCE_FAULT_NONE);
    start();
    run_coil(60, true, 2000);
    assert_state(QUIESCE_STATE_FAULT, QUIESCE_FAULT_DRIVER_NOT_FOLLOWING);
    start();
    run_coil(0, true, 2000);
    assert_state(QUIESCE_STATE_FAULT, QUIESCE_FAULT_COIL_OPEN);
    start();
    run_coil(100, false, 2000);
    assert_state(QUIESCE_STATE_FAULT, QUIESCE_FAULT_CURRENT_LOST);
}

// The driver is off after an emergency stop: no current may then not count as a new fault.
static void test_emergency_stop_can_be_acknowledged_with_the_current_check_on(void) {
    params.law = QUIESCE_LAW_CONSTANT;
    params.current_check = QUIESCE_CURRENT_CHECK_ON;
    params.safe_current_mA = 2000;
    start();
    run_coil(100, true, 2000);
    assert_state(QUIESCE_STATE_RUN, QUIESCE_FAULT_NONE);
    flags = LOCKSTEP_FRESH | LOCKSTEP_ENABLE | LOCKSTEP_HAS_CURRENT | LOCKSTEP_ESTOP;
    for (uint32_t i = 0; i < 300; i++) {
        tick(signal_noise(&noise_seed, 147), 0);
    }
    assert_state(QUIESCE_STATE_FAULT, QUIESCE_FAULT_ESTOP);
    flags = LOCKSTEP_FRESH | LOCKSTEP_HAS_CURRENT | LOCKSTEP_FAULT_RESET;
    tick(signal_noise(&noise_seed, 147), 0);
    assert_state(QUIESCE_STATE_INIT, QUIESCE_FAULT_NONE);
}

static void test_lost_tick_invalidates_the_frequency_until_a_window_is_new(void) {
    params.law = QUIESCE_LAW_FUZZY;
    start();
    vibrate(10000, 1500);
    TEST_ASSERT_EQUAL_UINT32(1, reply.telemetry.freq_is_valid);
    server.in.tick += 50;
    vibrate(10000, 150);
    TEST_ASSERT_EQUAL_UINT32(0, reply.telemetry.freq_is_valid);
    vibrate(10000, 150);
    TEST_ASSERT_EQUAL_UINT32(1, reply.telemetry.freq_is_valid);
    TEST_ASSERT_EQUAL_UINT32(128, reply.telemetry.freq_window_ms);
}

// Ticks that the vibration goes on in and the controller is not called.
static void lose(uint32_t ticks) {
    server.in.tick += ticks;
    time_ticks += ticks;
}

static void test_lost_ticks_do_not_cost_the_lock(void) {
    static const uint32_t lost[] = {1, 2, 8};
    params.law = QUIESCE_LAW_PHASE;
    start();
    vibrate(10000, 3000);
    for (uint32_t i = 0; i < 30u; i++) {
        lose(lost[i % 3u]);
        for (uint32_t j = 0; j < 50u + i; j++) {
            vibrate(10000, 1);
            TEST_ASSERT_EQUAL_UINT32(1, reply.telemetry.lock_is_on);
        }
        assert_state(QUIESCE_STATE_RUN, QUIESCE_FAULT_NONE);
    }
    lose(9);
    vibrate(10000, 1);
    TEST_ASSERT_EQUAL_UINT32(0, reply.telemetry.lock_is_on);
}

// One or two are made up for: the frequency stays valid, too.
static void test_few_lost_ticks_do_not_cost_the_frequency(void) {
    for (int32_t estimator = 0; estimator <= QUIESCE_ESTIMATOR_FFT; estimator++) {
        params.law = QUIESCE_LAW_PHASE;
        params.estimator = estimator;
        start();
        vibrate(10000, 3000);
        for (uint32_t i = 0; i < 40u; i++) {
            lose(1u + i % 2u);
            for (uint32_t j = 0; j < 97u; j++) {
                vibrate(10000, 1);
                TEST_ASSERT_EQUAL_UINT32(1, reply.telemetry.freq_is_valid);
                TEST_ASSERT_EQUAL_UINT32(1, reply.telemetry.lock_is_on);
            }
            assert_state(QUIESCE_STATE_RUN, QUIESCE_FAULT_NONE);
        }
    }
}

static void test_rms_is_right_soon_after_a_stuck_sensor(void) {
    params.law = QUIESCE_LAW_FUZZY;
    start();
    vibrate(10000, 1500);
    for (uint32_t i = 0; i < 5000; i++) {
        tick(4000000, 0);
    }
    assert_state(QUIESCE_STATE_SAFE, QUIESCE_FAULT_SENSOR_STUCK);
    vibrate(10000, 520);
    assert_state(QUIESCE_STATE_RUN, QUIESCE_FAULT_NONE);
    TEST_ASSERT_INT32_WITHIN(10000, 212000, reply.telemetry.rms_um_s2);
}

static void test_in_a_lost_tick_the_controller_does_not_run(void) {
    params.law = QUIESCE_LAW_CONSTANT;
    start();
    vibrate(10000, 500);
    const lockstep_reply_t before = reply;
    flags |= LOCKSTEP_LOST | LOCKSTEP_ESTOP;
    tick(4000000, 0);
    TEST_ASSERT_EQUAL_MEMORY(&before, &reply, sizeof reply);
    flags = LOCKSTEP_FRESH | LOCKSTEP_ENABLE;
    vibrate(10000, 1);
    TEST_ASSERT_EQUAL_UINT32(before.telemetry.tick + 2u, reply.telemetry.tick);
    assert_state(QUIESCE_STATE_SAFE, QUIESCE_FAULT_TICK_LOST);
}

static void test_lost_tick_is_a_clearing_fault(void) {
    params.law = QUIESCE_LAW_CONSTANT;
    start();
    vibrate(10000, 500);
    server.in.tick += 3;
    vibrate(10000, 1);
    assert_state(QUIESCE_STATE_SAFE, QUIESCE_FAULT_TICK_LOST);
    vibrate(10000, 3);
    assert_state(QUIESCE_STATE_RUN, QUIESCE_FAULT_NONE);
}

static void test_two_controllers_do_not_share_state(void) {
    static lockstep_t other;
    static lockstep_reply_t other_reply;
    params.law = QUIESCE_LAW_FUZZY;
    start();
    TEST_ASSERT_TRUE(lockstep_start(&other, NULL, &params, NULL));
    for (uint32_t i = 0; i < 1500; i++) {
        vibrate(10000, 1);
        const lockstep_stimulus_t in = {flags, {signal_sine(5195, 20000, i, 1000)}, {0}};
        lockstep_exchange(&other, &in, &other_reply);
    }
    TEST_ASSERT_INT32_WITHIN(5000, 10000000, reply.telemetry.freq_uHz);
    TEST_ASSERT_INT32_WITHIN(5000, 20000000, other_reply.telemetry.freq_uHz);
}

// Any bytes in: nothing undefined (sanitizers watch), the command never leaves its range.
static void test_arbitrary_input_never_drives_the_command_out_of_range(void) {
    uint32_t seed = 99;
    params.law = QUIESCE_LAW_FUZZY_SELFTUNE;
    params.current_check = QUIESCE_CURRENT_CHECK_ON;
    start();
    for (uint32_t i = 0; i < 20000; i++) {
        const lockstep_stimulus_t in = {
            .counts = {(int32_t)((uint32_t)signal_noise(&seed, INT32_MAX) >> (i / 640))},
            .flags =
                (uint32_t)signal_noise(&seed, INT32_MAX) | ((i & 1u) != 0 ? LOCKSTEP_FRESH : 0u),
            .current_meas_mA = {signal_noise(&seed, INT32_MAX)},
        };
        lockstep_exchange(&server, &in, &reply);
        TEST_ASSERT_TRUE(reply.current_cmd_mA[0] >= 0 && reply.current_cmd_mA[0] <= 5000);
        TEST_ASSERT_TRUE(reply.telemetry.state == QUIESCE_STATE_RUN ||
                         reply.telemetry.state == QUIESCE_STATE_DEGRADED ||
                         reply.current_cmd_mA[0] == 0);
    }
}

static void run_wildly(uint32_t ticks) {
    uint32_t seed = 17;
    for (uint32_t i = 0; i < ticks; i++) {
        const lockstep_stimulus_t in = {
            .counts = {signal_noise(&seed, 8388606)},
            .flags = LOCKSTEP_FRESH | (i % 300 > 0 ? LOCKSTEP_ENABLE : 0u) | LOCKSTEP_HAS_CURRENT,
            .current_meas_mA = {signal_noise(&seed, 20000)},
        };
        lockstep_exchange(&server, &in, &reply);
        TEST_ASSERT_TRUE(reply.current_cmd_mA[0] >= 0);
        TEST_ASSERT_TRUE(reply.current_cmd_mA[0] <= params.max_current_mA);
    }
}

// Whatever the check accepts must run: each parameter at its ends, at every tick rate and law.
static void test_every_accepted_extreme_runs(void) {
    static const int32_t rates_Hz[] = {500, 1000, 2000, 4000};
    for (uint32_t i = 0; i < 2 * QUIESCE_PARAM_COUNT; i++) {
        const quiesce_param_info_t *info = quiesce_param_info(i / 2);
        for (uint32_t k = 0; k < 4; k++) {
            quiesce_params_default(&params);
            params.tick_rate_Hz = rates_Hz[k];
            params.law = (int32_t)k;
            params.current_check = (int32_t)(k % 2);
            quiesce_param_set(&params, i / 2, i % 2 ? info->max : info->min);
            if (quiesce_params_check(&params, NULL)) {
                TEST_ASSERT_TRUE(lockstep_start(&server, NULL, &params, NULL));
                run_wildly(700);
            }
        }
    }
}

// All at once, as far as they do not contradict each other.
static void test_all_parameters_at_their_ends_together_run(void) {
    for (uint32_t end = 0; end < 2; end++) {
        for (uint32_t i = 0; i < QUIESCE_PARAM_COUNT; i++) {
            const quiesce_param_info_t *info = quiesce_param_info(i);
            quiesce_param_set(&params, i, end ? info->max : info->min);
        }
        params.accel_scale_nm_s2 = end ? 50000 : params.accel_scale_nm_s2; // 500 m/s2
        params.constant_current_mA = 0;
        params.law = QUIESCE_LAW_FUZZY_SELFTUNE;
        params.current_check = (int32_t)end; // the smallest limits leave it nothing to see
        params.sensor_recover_ticks = 1;
        params.current_error_mA = 10;
        params.safe_current_mA = 0;
        params.narrow_low_mHz = 0;
        params.unlock_current_mA = 0;
        TEST_ASSERT_TRUE(lockstep_start(&server, NULL, &params, NULL));
        run_wildly(20000);
    }
}

// Commands of law phase at 8 Hz from 4 s to 6 s, where samples come late_ticks after the motion and
// the board says so or not, into out.
static void run_late_on(quiesce_board_t board, uint32_t late_ticks, int32_t out[2000]) {
    static quiesce_t controller;
    quiesce_in_t in = {0};
    quiesce_out_t result;
    uint32_t seed = 3;
    params.law = QUIESCE_LAW_PHASE;
    params.slew_mA_s = 10000000;
    TEST_ASSERT_TRUE(quiesce_init_board(&controller, &board, &params));
    for (uint32_t i = 0; i < 6000; i++) {
        in.enable = i > 0;
        in.tick++;
        in.sensor[0].counts =
            signal_sine(20000, 8000, i + 1000 - late_ticks, 1000) + signal_noise(&seed, 20);
        in.sensor[0].is_fresh = true;
        quiesce_step(&controller, &in, &result);
        if (i >= 4000) {
            out[i - 4000] = result.damper[0].current_cmd_mA;
        }
    }
}

static void run_late(uint32_t late_ticks, int32_t sensor_us, int32_t bus_us, int32_t out[2000]) {
    quiesce_board_t board;
    quiesce_board_default(&board);
    board.sensor[0].latency_us = sensor_us;
    board.bus_latency_us = bus_us;
    run_late_on(board, late_ticks, out);
}

static int32_t mean_difference_mA(const int32_t a[2000], const int32_t b[2000], uint32_t shift) {
    int64_t sum = 0;
    for (uint32_t i = 0; i + shift < 2000; i++) {
        sum += a[i + shift] > b[i] ? a[i + shift] - b[i] : b[i] - a[i + shift];
    }
    return (int32_t)(sum / (2000 - shift));
}

static void test_latencies_of_sensor_and_bus_are_made_up_for(void) {
    static int32_t punctual[2000];
    static int32_t late[2000];
    run_late(0, 0, 0, punctual);
    run_late(9, 0, 0, late); // and nobody has said so
    TEST_ASSERT_GREATER_THAN_INT32(800, mean_difference_mA(punctual, late, 0));
    run_late(9, 9000, 0, late);
    TEST_ASSERT_LESS_THAN_INT32(60, mean_difference_mA(punctual, late, 0));
    // Commands leave as much earlier as the bus takes.
    run_late(0, 0, 7000, late);
    TEST_ASSERT_LESS_THAN_INT32(60, mean_difference_mA(punctual, late, 7));
    TEST_ASSERT_GREATER_THAN_INT32(600, mean_difference_mA(punctual, late, 0));
}

// A high-pass of 2.937 Hz leads at 8 Hz by atan(2.937 / 8) = 20.16 degrees: 7 ticks.
static void test_the_lead_of_a_sensors_corner_is_taken_back(void) {
    static int32_t punctual[2000];
    static int32_t led[2000];
    const uint32_t early_ticks = 7;
    quiesce_board_t board;
    quiesce_board_default(&board);
    run_late_on(board, 0, punctual);
    run_late_on(board, 0u - early_ticks, led); // and nobody has said so
    TEST_ASSERT_GREATER_THAN_INT32(600, mean_difference_mA(punctual, led, 0));
    board.sensor[0].corner_mHz = 2937;
    run_late_on(board, 0u - early_ticks, led);
    TEST_ASSERT_LESS_THAN_INT32(60, mean_difference_mA(punctual, led, 0));
    // With a latency beside it: both.
    board.sensor[0].latency_us = 9000;
    run_late_on(board, 9u - early_ticks, led);
    TEST_ASSERT_LESS_THAN_INT32(60, mean_difference_mA(punctual, led, 0));
}

static lockstep_t elsewhere;

// Beside the other one, tick for tick the same.
static void assert_both_go_on_alike(uint32_t ticks) {
    for (uint32_t i = 0; i < ticks; i++, time_ticks++) {
        const lockstep_stimulus_t in = {flags, {signal_sine(5195, 11000, time_ticks, 1000)}, {0}};
        lockstep_reply_t other = reply;
        lockstep_exchange(&server, &in, &reply);
        lockstep_exchange(&elsewhere, &in, &other);
        TEST_ASSERT_EQUAL_MEMORY(&reply, &other, sizeof reply);
    }
}

static void test_another_controller_goes_on_where_one_stands(void) {
    for (int32_t law = 0; law < QUIESCE_LAW_COUNT; law++) {
        params.law = law;
        if (!quiesce_params_check(&params, NULL)) {
            continue; // of another build
        }
        start();
        vibrate(10000, 1500);
        params.constant_current_mA = 700; // live
        TEST_ASSERT_TRUE(quiesce_params_use(&server.controller, &params));
        vibrate(11000, 777);
        params.constant_current_mA = 600;
        TEST_ASSERT_TRUE(lockstep_start(&elsewhere, NULL, &params, NULL));
        elsewhere.in = server.in;
        TEST_ASSERT_TRUE(quiesce_go_on(&elsewhere.controller, &server.controller));
        assert_both_go_on_alike(1500);
    }
}

static void test_it_does_not_go_on_with_another_law(void) {
    params.law = QUIESCE_LAW_FUZZY;
    start();
    params.law = QUIESCE_LAW_PHASE;
    TEST_ASSERT_TRUE(lockstep_start(&elsewhere, NULL, &params, NULL));
    const quiesce_t before = elsewhere.controller;
    TEST_ASSERT_FALSE(quiesce_go_on(&elsewhere.controller, &server.controller));
    TEST_ASSERT_EQUAL_MEMORY(&before, &elsewhere.controller, sizeof before);
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(test_chain_reaches_the_rule_bases_current);
    RUN_TEST(test_unlock_current_is_not_the_safe_current);
    RUN_TEST(test_lock_does_not_leave_the_band);
    RUN_TEST(test_refused_parameter_latches_and_keeps_the_safe_current);
    RUN_TEST(test_sensor_faults_lead_to_safe_and_back);
    RUN_TEST(test_quiet_sensor_leads_to_safe_and_back);
    RUN_TEST(test_short_dropout_is_bridged);
    RUN_TEST(test_emergency_stop_latches_within_its_tick);
    RUN_TEST(test_enable_held_from_the_start_runs_nothing);
    RUN_TEST(test_disable_takes_the_current_away_and_enable_returns_it);
    RUN_TEST(test_current_check_tells_its_faults_apart);
    RUN_TEST(test_emergency_stop_can_be_acknowledged_with_the_current_check_on);
    RUN_TEST(test_lost_tick_invalidates_the_frequency_until_a_window_is_new);
    RUN_TEST(test_lost_ticks_do_not_cost_the_lock);
    RUN_TEST(test_few_lost_ticks_do_not_cost_the_frequency);
    RUN_TEST(test_rms_is_right_soon_after_a_stuck_sensor);
    RUN_TEST(test_in_a_lost_tick_the_controller_does_not_run);
    RUN_TEST(test_lost_tick_is_a_clearing_fault);
    RUN_TEST(test_two_controllers_do_not_share_state);
    RUN_TEST(test_arbitrary_input_never_drives_the_command_out_of_range);
    RUN_TEST(test_every_accepted_extreme_runs);
    RUN_TEST(test_all_parameters_at_their_ends_together_run);
    RUN_TEST(test_latencies_of_sensor_and_bus_are_made_up_for);
    RUN_TEST(test_the_lead_of_a_sensors_corner_is_taken_back);
    RUN_TEST(test_another_controller_goes_on_where_one_stands);
    RUN_TEST(test_it_does_not_go_on_with_another_law);
    return UNITY_END();
}
