// Drivers that are kept off while flash is erased, a program is replaced or on trial: a coil with a
// lag, measured, whose current is what the command and the enable make of it.
#include "can_make.h"
#include "node.h"
#include "quiesce_can.h"
#include "unity.h"

#include <string.h>

#define GAP_TICKS 2000u ///< the processor stands still

typedef struct {
    int32_t rate_Hz, safe_mA, lag_ms;
} coil_case_t;

static const coil_case_t cases[] = {
    {1000, 0, 5},     {1000, 500, 5},    {1000, 600, 5},   {1000, 1500, 5},  {1000, 1000, 60},
    {1000, 2000, 40}, {1000, 1000, 100}, {4000, 1000, 20}, {4000, 1000, 10}, {4000, 2000, 20},
};
#define CASES (sizeof cases / sizeof cases[0])

static node_t node;
static int64_t coil_q16;
static int32_t gain_q16;
static uint32_t rate_Hz;
static uint32_t seed;
static bool enable;
static bool is_measured;
static bool board_fails;
static int32_t leak_mA; ///< that flows whatever is commanded

void setUp(void) {}
void tearDown(void) {}

static void start(const coil_case_t *one) {
    quiesce_params_t params;
    quiesce_params_default(&params);
    params.safe_current_mA = one->safe_mA;
    params.current_lag_ms = one->lag_ms;
    params.tick_rate_Hz = one->rate_Hz;
    coil_q16 = 0;
    seed = 1;
    enable = false;
    is_measured = true;
    board_fails = false;
    leak_mA = 0;
    rate_Hz = (uint32_t)one->rate_Hz;
    gain_q16 = 65536 * 1000 / (1000 + one->lag_ms * one->rate_Hz);
    memset(&node, 0xA5, sizeof node);
    TEST_ASSERT_TRUE(
        node_init(&node, NULL, &params, (node_sources_t){.enable = NODE_ENABLE_BOARD}));
}

static void tick(uint32_t ticks, bool estop, bool reset) {
    can_frame_t frames[NODE_MAX_FRAMES];
    node_inputs_t inputs = {
        .enable = enable, .estop = estop, .fault_reset = reset, .ticks_elapsed = ticks};
    seed = seed * 1664525u + 1013904223u;
    inputs.sensor[0].counts = (int32_t)(seed >> 16) - 32768;
    inputs.sensor[0].is_fresh = true;
    inputs.driver[0].is_measured = is_measured;
    inputs.driver[0].has_failed = board_fails;
    inputs.driver[0].current_mA = (int32_t)(coil_q16 >> 16);
    node_step(&node, &inputs);
    const quiesce_command_t *const out = &node.out.damper[0];
    const int64_t target_q16 = out->driver_enable ? (int64_t)out->current_cmd_mA * 65536 : 0;
    coil_q16 += (target_q16 - coil_q16) * gain_q16 >> 16;
    const int64_t leak_q16 = (int64_t)leak_mA * 65536;
    coil_q16 = coil_q16 > leak_q16 ? coil_q16 : leak_q16;
    TEST_ASSERT_NULL(node_task(&node));
    (void)node_frames(&node, frames);
}

static void run_ms(uint32_t ms) {
    for (uint32_t i = 0; i < ms * rate_Hz / 1000u; i++) {
        tick(1, false, false);
    }
}

static void assert_runs(const coil_case_t *one) {
    TEST_ASSERT_EQUAL(QUIESCE_FAULT_NONE, node.out.telemetry.fault);
    TEST_ASSERT_EQUAL(QUIESCE_STATE_IDLE, node.out.telemetry.state);
    TEST_ASSERT_TRUE(node.out.damper[0].driver_enable);
    TEST_ASSERT_INT32_WITHIN(one->safe_mA / 100 + 2, one->safe_mA, (int32_t)(coil_q16 >> 16));
}

static void assert_held(void) {
    TEST_ASSERT_FALSE(node.out.damper[0].driver_enable);
    TEST_ASSERT_INT32_WITHIN(2, 0, (int32_t)(coil_q16 >> 16));
}

static void test_a_trial_from_the_start_ends_without_a_fault(void) {
    for (uint32_t i = 0; i < CASES; i++) {
        start(&cases[i]);
        node.images.is_held = true;
        run_ms(2500);
        TEST_ASSERT_EQUAL(QUIESCE_FAULT_NONE, node.out.telemetry.fault);
        assert_held();
        node.images.is_held = false;
        run_ms(2000);
        assert_runs(&cases[i]);
    }
}

// Off first, then the processor stands still, then on again.
static void test_an_erasure_of_records_ends_without_a_fault(void) {
    for (uint32_t i = 0; i < CASES; i++) {
        start(&cases[i]);
        run_ms(2500);
        assert_runs(&cases[i]);
        node.drivers_are_held = true;
        tick(1, false, false);
        TEST_ASSERT_FALSE(node.out.damper[0].driver_enable);
        coil_q16 = 0; // meanwhile
        tick(GAP_TICKS, false, false);
        run_ms(3);
        assert_held();
        node.drivers_are_held = false;
        run_ms(2000);
        assert_runs(&cases[i]);
    }
}

static void test_a_stop_while_held_is_acknowledged_as_any(void) {
    for (uint32_t i = 0; i < CASES; i++) {
        start(&cases[i]);
        run_ms(2500);
        node.drivers_are_held = true;
        run_ms(2500);
        tick(1, true, false);
        run_ms(20);
        TEST_ASSERT_EQUAL(QUIESCE_FAULT_ESTOP, node.out.telemetry.fault);
        tick(1, false, true);
        run_ms(1500);
        TEST_ASSERT_EQUAL(QUIESCE_FAULT_NONE, node.out.telemetry.fault);
        assert_held();
        node.drivers_are_held = false;
        run_ms(2000);
        assert_runs(&cases[i]);
    }
}

// A stage that conducts although it is off, from the start of a trial on, or when a stop is
// acknowledged.
static void test_the_self_test_is_none_the_easier(void) {
    for (uint32_t i = 0; i < 2u; i++) {
        start(&cases[3]);
        run_ms(i == 0u ? 0 : 2500);
        node.images.is_held = true;
        run_ms(i == 0u ? 0 : 1000);
        tick(1, i == 1u, false);
        leak_mA = cases[3].safe_mA;
        tick(1, false, i == 1u);
        run_ms(1000);
        TEST_ASSERT_EQUAL(QUIESCE_FAULT_DRIVER_NOT_FOLLOWING, node.out.telemetry.fault);
        node.images.is_held = false;
        run_ms(1000);
        TEST_ASSERT_EQUAL(QUIESCE_FAULT_DRIVER_NOT_FOLLOWING, node.out.telemetry.fault);
    }
}

// After the processor has stood still nothing is known of the bus for a while.
static void test_measurements_that_come_back_late_are_waited_for(void) {
    for (uint32_t i = 0; i < CASES; i++) {
        start(&cases[i]);
        run_ms(2500);
        node.drivers_are_held = true;
        tick(1, false, false);
        tick(GAP_TICKS, false, false);
        // The driver's own timeout has put it at its safe current meanwhile.
        coil_q16 = (int64_t)cases[i].safe_mA * 65536;
        is_measured = false;
        run_ms(5);
        node.drivers_are_held = false;
        run_ms(40);
        is_measured = true;
        run_ms(2000);
        assert_runs(&cases[i]);
    }
}

// The board's own stage has nothing to tell while it is off; one on the bus says once what it has.
static void test_a_driver_on_the_bus_that_fails_while_held_is_told(void) {
    start(&cases[0]);
    run_ms(1000);
    node.drivers_are_held = true;
    run_ms(10);
    board_fails = true;
    run_ms(10);
    board_fails = false;
    TEST_ASSERT_EQUAL(QUIESCE_FAULT_NONE, node.out.telemetry.fault);
    const can_frame_t frame =
        make_driver(0, QUIESCE_CAN_CURRENT_MEASURED_DRIVER_STATUS_SHORT_CHOICE, 0);
    node_receive(&node, &frame);
    run_ms(10);
    TEST_ASSERT_EQUAL(QUIESCE_FAULT_DRIVER_FAILED, node.out.telemetry.fault);
}

static void test_an_enable_while_held_has_to_be_let_go(void) {
    start(&cases[0]);
    run_ms(1000);
    node.drivers_are_held = true;
    enable = true;
    run_ms(100);
    node.drivers_are_held = false;
    run_ms(500);
    TEST_ASSERT_FALSE(quiesce_is_armed(&node.controller));
    enable = false;
    run_ms(10);
    enable = true;
    run_ms(10);
    TEST_ASSERT_TRUE(quiesce_is_armed(&node.controller));
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(test_a_trial_from_the_start_ends_without_a_fault);
    RUN_TEST(test_an_erasure_of_records_ends_without_a_fault);
    RUN_TEST(test_a_stop_while_held_is_acknowledged_as_any);
    RUN_TEST(test_the_self_test_is_none_the_easier);
    RUN_TEST(test_measurements_that_come_back_late_are_waited_for);
    RUN_TEST(test_a_driver_on_the_bus_that_fails_while_held_is_told);
    RUN_TEST(test_an_enable_while_held_has_to_be_let_go);
    return UNITY_END();
}
