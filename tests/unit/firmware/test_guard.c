// Guard, current monitor and supervisor.
#include "current_monitor.h"
#include "guard.h"
#include "supervisor.h"
#include "unity.h"

static guard_t guard;
static current_monitor_t monitor;
static supervisor_t supervisor;

static const guard_cfg_t guard_cfg = {
    .max_mA = 5000, .safe_mA = 700, .slew_mA_s = 1000000, .tick_rate_Hz = 1000};
static const current_monitor_cfg_t monitor_cfg = {
    .is_on = true, .tick_rate_Hz = 1000, .error_mA = 500, .lag_us = 5000, .fault_ticks = 20};

void setUp(void) {
    guard_init(&guard, &guard_cfg);
    current_monitor_init(&monitor, &monitor_cfg, 0);
    supervisor_init(&supervisor, QUIESCE_FAULT_NONE);
}
void tearDown(void) {}

static void test_guard_denies_by_default(void) {
    TEST_ASSERT_EQUAL_INT32(700, guard_step(&guard, 5000, false));
}

static void test_guard_limits_range_and_slew(void) {
    TEST_ASSERT_EQUAL_INT32(1700, guard_step(&guard, INT32_MAX, true));
    TEST_ASSERT_EQUAL_INT32(2700, guard_step(&guard, 6000, true));
    for (uint32_t i = 0; i < 10; i++) {
        TEST_ASSERT_TRUE(guard_step(&guard, INT32_MAX, true) <= 5000);
    }
    TEST_ASSERT_EQUAL_INT32(5000, guard_step(&guard, 5000, true));
    TEST_ASSERT_EQUAL_INT32(4000, guard_step(&guard, INT32_MIN, true));
}

static void test_guard_reaches_the_safe_current_at_once(void) {
    for (uint32_t i = 0; i < 10; i++) {
        guard_step(&guard, 5000, true);
    }
    TEST_ASSERT_EQUAL_INT32(700, guard_step(&guard, 5000, false));
    TEST_ASSERT_EQUAL_INT32(1700, guard_step(&guard, 5000, true));
}

static void test_guard_with_senseless_limits_stays_defined(void) {
    const guard_cfg_t broken = {
        .max_mA = -5, .safe_mA = 99999, .slew_mA_s = INT32_MIN, .tick_rate_Hz = 1};
    guard_init(&guard, &broken);
    TEST_ASSERT_EQUAL_INT32(0, guard_step(&guard, 5000, false));
    TEST_ASSERT_EQUAL_INT32(0, guard_step(&guard, 5000, true));
}

// The coil's own lag, in the monitor's expectation: a driver that follows is never suspected.
static void test_monitor_accepts_a_lagging_coil(void) {
    int32_t coil_mA = 0;
    for (uint32_t i = 0; i < 400; i++) {
        const int32_t command_mA = i / 50 % 2 ? 0 : 5000;
        TEST_ASSERT_EQUAL(CURRENT_OK, current_monitor_step(&monitor, command_mA, coil_mA, true));
        coil_mA += (command_mA - coil_mA) / 6;
    }
}

static current_verdict_t run_monitor(int32_t command_mA, int32_t measured_mA, bool is_measured,
                                     uint32_t ticks) {
    current_verdict_t verdict = CURRENT_OK;
    for (uint32_t i = 0; i < ticks; i++) {
        verdict = current_monitor_step(&monitor, command_mA, measured_mA, is_measured);
    }
    return verdict;
}

static void test_monitor_names_the_fault(void) {
    TEST_ASSERT_EQUAL(CURRENT_OK, run_monitor(5000, 0, true, 15));
    TEST_ASSERT_EQUAL(CURRENT_OPEN_COIL, run_monitor(5000, 0, true, 30));
    current_monitor_init(&monitor, &monitor_cfg, 5000);
    TEST_ASSERT_EQUAL(CURRENT_NOT_FOLLOWING, run_monitor(5000, 3000, true, 30));
    current_monitor_init(&monitor, &monitor_cfg, 0);
    TEST_ASSERT_EQUAL(CURRENT_NOT_FOLLOWING, run_monitor(0, 3000, true, 30)); // stuck on
    current_monitor_init(&monitor, &monitor_cfg, 0);
    TEST_ASSERT_EQUAL(CURRENT_OK, run_monitor(0, 0, false, 19));
    TEST_ASSERT_EQUAL(CURRENT_MISSING, run_monitor(0, 0, false, 1));
}

static void test_monitor_off_and_extremes(void) {
    current_monitor_cfg_t off = monitor_cfg;
    off.is_on = false;
    current_monitor_init(&monitor, &off, 0);
    TEST_ASSERT_EQUAL(CURRENT_OK, run_monitor(5000, 0, true, 1000));
    current_monitor_init(&monitor, &monitor_cfg, 0);
    TEST_ASSERT_EQUAL(CURRENT_NOT_FOLLOWING, run_monitor(20000, INT32_MIN, true, 30));
    TEST_ASSERT_EQUAL(CURRENT_NOT_FOLLOWING, run_monitor(20000, INT32_MAX, true, 30));
}

static quiesce_state_t drive(quiesce_fault_t clearing, quiesce_fault_t latched, bool is_ready,
                             bool enable, bool reset) {
    const supervisor_in_t in = {clearing, latched, is_ready, enable, reset};
    supervisor_step(&supervisor, &in);
    TEST_ASSERT_EQUAL(supervisor.state == QUIESCE_STATE_RUN, supervisor_allows_output(&supervisor));
    return supervisor.state;
}

#define NONE QUIESCE_FAULT_NONE

static void go_to_run(void) {
    drive(NONE, NONE, true, true, false);
    TEST_ASSERT_EQUAL(QUIESCE_STATE_RUN, drive(NONE, NONE, true, true, false));
}

static void test_way_from_init_to_run_and_back(void) {
    TEST_ASSERT_EQUAL(QUIESCE_STATE_INIT, drive(NONE, NONE, false, true, false));
    TEST_ASSERT_EQUAL(QUIESCE_STATE_IDLE, drive(NONE, NONE, true, true, false));
    TEST_ASSERT_EQUAL(QUIESCE_STATE_RUN, drive(NONE, NONE, true, true, false));
    TEST_ASSERT_EQUAL(QUIESCE_STATE_RUN, drive(NONE, NONE, false, true, false));
    TEST_ASSERT_EQUAL(QUIESCE_STATE_IDLE, drive(NONE, NONE, false, false, false));
}

static void test_clearing_fault_returns_by_itself(void) {
    go_to_run();
    TEST_ASSERT_EQUAL(QUIESCE_STATE_SAFE,
                      drive(QUIESCE_FAULT_SENSOR_LOST, NONE, false, true, false));
    TEST_ASSERT_EQUAL(QUIESCE_FAULT_SENSOR_LOST, supervisor.fault);
    TEST_ASSERT_EQUAL(QUIESCE_STATE_SAFE, drive(NONE, NONE, false, true, false));
    TEST_ASSERT_EQUAL(QUIESCE_FAULT_SENSOR_LOST, supervisor.fault);
    TEST_ASSERT_EQUAL(QUIESCE_STATE_IDLE, drive(NONE, NONE, true, true, false));
    TEST_ASSERT_EQUAL(QUIESCE_FAULT_NONE, supervisor.fault);
    TEST_ASSERT_EQUAL(QUIESCE_STATE_RUN, drive(NONE, NONE, true, true, false));
    TEST_ASSERT_EQUAL_UINT32(1, supervisor.fault_count);
}

static void test_latched_fault_needs_an_edge_with_the_cause_gone(void) {
    go_to_run();
    TEST_ASSERT_EQUAL(QUIESCE_STATE_FAULT, drive(NONE, QUIESCE_FAULT_ESTOP, true, true, false));
    TEST_ASSERT_FALSE(supervisor_allows_driver(&supervisor));
    TEST_ASSERT_EQUAL(QUIESCE_STATE_FAULT, drive(NONE, QUIESCE_FAULT_ESTOP, true, true, true));
    TEST_ASSERT_EQUAL(QUIESCE_STATE_FAULT, drive(NONE, NONE, true, true, true)); // no new edge
    TEST_ASSERT_EQUAL(QUIESCE_STATE_FAULT, drive(NONE, NONE, true, true, false));
    TEST_ASSERT_EQUAL(QUIESCE_STATE_INIT, drive(NONE, NONE, true, true, true));
    TEST_ASSERT_TRUE(supervisor_allows_driver(&supervisor));
}

static void test_latched_fault_outranks_a_clearing_one_and_interrupts_safe(void) {
    drive(QUIESCE_FAULT_SENSOR_STUCK, NONE, false, true, false);
    TEST_ASSERT_EQUAL(QUIESCE_STATE_FAULT, drive(QUIESCE_FAULT_SENSOR_STUCK,
                                                 QUIESCE_FAULT_COIL_OPEN, false, true, false));
    TEST_ASSERT_EQUAL(QUIESCE_FAULT_COIL_OPEN, supervisor.fault);
    TEST_ASSERT_TRUE(supervisor_allows_driver(&supervisor));
    TEST_ASSERT_EQUAL_UINT32(2, supervisor.fault_count);
}

static void test_emergency_stop_switches_off_on_top_of_any_latched_fault(void) {
    static const quiesce_fault_t faults[] = {QUIESCE_FAULT_DRIVER_NOT_FOLLOWING,
                                             QUIESCE_FAULT_COIL_OPEN, QUIESCE_FAULT_CURRENT_LOST};
    for (uint32_t i = 0; i < 3; i++) {
        supervisor_init(&supervisor, QUIESCE_FAULT_NONE);
        drive(NONE, faults[i], true, true, false);
        TEST_ASSERT_TRUE(supervisor_allows_driver(&supervisor));
        drive(NONE, QUIESCE_FAULT_ESTOP, true, true, false);
        TEST_ASSERT_EQUAL(QUIESCE_FAULT_ESTOP, supervisor.fault);
        TEST_ASSERT_FALSE(supervisor_allows_driver(&supervisor));
    }
    supervisor_init(&supervisor, QUIESCE_FAULT_PARAMETER);
    drive(NONE, QUIESCE_FAULT_ESTOP, true, true, false);
    TEST_ASSERT_EQUAL(QUIESCE_FAULT_PARAMETER, supervisor.fault);
    TEST_ASSERT_FALSE(supervisor_allows_driver(&supervisor));
}

static void test_failed_driver_is_switched_off_and_gives_way_to_an_emergency_stop_only(void) {
    drive(NONE, QUIESCE_FAULT_CURRENT_LOST, true, true, false);
    TEST_ASSERT_TRUE(supervisor_allows_driver(&supervisor));
    drive(NONE, QUIESCE_FAULT_DRIVER_FAILED, true, true, false);
    TEST_ASSERT_EQUAL(QUIESCE_FAULT_DRIVER_FAILED, supervisor.fault);
    TEST_ASSERT_FALSE(supervisor_allows_driver(&supervisor));
    drive(NONE, QUIESCE_FAULT_CURRENT_LOST, true, true, false);
    TEST_ASSERT_EQUAL(QUIESCE_FAULT_DRIVER_FAILED, supervisor.fault);
    drive(NONE, QUIESCE_FAULT_ESTOP, true, true, false);
    drive(NONE, QUIESCE_FAULT_DRIVER_FAILED, true, true, false);
    TEST_ASSERT_EQUAL(QUIESCE_FAULT_ESTOP, supervisor.fault);
    TEST_ASSERT_EQUAL_UINT32(3, supervisor.fault_count);
}

static void test_refused_parameters_never_leave_fault(void) {
    supervisor_init(&supervisor, QUIESCE_FAULT_PARAMETER);
    for (uint32_t i = 0; i < 20; i++) {
        TEST_ASSERT_EQUAL(QUIESCE_STATE_FAULT, drive(NONE, NONE, true, true, i % 2 != 0));
    }
    TEST_ASSERT_EQUAL(QUIESCE_FAULT_PARAMETER, supervisor.fault);
    TEST_ASSERT_FALSE(supervisor_allows_driver(&supervisor));
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(test_guard_denies_by_default);
    RUN_TEST(test_guard_limits_range_and_slew);
    RUN_TEST(test_guard_reaches_the_safe_current_at_once);
    RUN_TEST(test_guard_with_senseless_limits_stays_defined);
    RUN_TEST(test_monitor_accepts_a_lagging_coil);
    RUN_TEST(test_monitor_names_the_fault);
    RUN_TEST(test_monitor_off_and_extremes);
    RUN_TEST(test_way_from_init_to_run_and_back);
    RUN_TEST(test_clearing_fault_returns_by_itself);
    RUN_TEST(test_latched_fault_needs_an_edge_with_the_cause_gone);
    RUN_TEST(test_latched_fault_outranks_a_clearing_one_and_interrupts_safe);
    RUN_TEST(test_emergency_stop_switches_off_on_top_of_any_latched_fault);
    RUN_TEST(test_failed_driver_is_switched_off_and_gives_way_to_an_emergency_stop_only);
    RUN_TEST(test_refused_parameters_never_leave_fault);
    return UNITY_END();
}
