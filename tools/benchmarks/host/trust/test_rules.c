// The rules that the benchmark of trust holds a controller to see what breaks them.
#include "rules.h"
#include "unity.h"

static rig_t rig;
static rules_t rules;
static quiesce_in_t in;
static quiesce_out_t out;

void setUp(void) {
    quiesce_params_default(&rig.params);
    rig.params.tick_rate_Hz = 1000;
    rig.params.slew_mA_s = 1000000;
    rig.params.max_current_mA = 5000;
    rig.params.safe_current_mA = 200;
    rig.has_board = false;
    rules = (rules_t){0};
    rules_start(&rules, &rig);
    in = (quiesce_in_t){0};
    out = (quiesce_out_t){0};
}
void tearDown(void) {}

static rule_t tick(quiesce_state_t state, quiesce_fault_t fault, int32_t cmd_mA, bool is_on) {
    in.tick++;
    out.telemetry.state = state;
    out.telemetry.fault = fault;
    out.damper[0] = (quiesce_command_t){.current_cmd_mA = cmd_mA, .driver_enable = is_on};
    return rules_tick(&rules, &in, &out);
}

static rule_t idle(void) {
    return tick(QUIESCE_STATE_IDLE, QUIESCE_FAULT_NONE, 200, true);
}

static rule_t run(int32_t cmd_mA) {
    return tick(QUIESCE_STATE_RUN, QUIESCE_FAULT_NONE, cmd_mA, true);
}

static rule_t stop(bool is_on) {
    return tick(QUIESCE_STATE_FAULT, QUIESCE_FAULT_ESTOP, 200, is_on);
}

static void arm(void) {
    in.enable = false;
    TEST_ASSERT_EQUAL(RULES, idle());
    in.enable = true;
    TEST_ASSERT_EQUAL(RULES, idle());
}

static void test_what_keeps_all_rules_breaks_none(void) {
    arm();
    for (int32_t cmd_mA = 1200; cmd_mA <= 5000; cmd_mA += 950) {
        TEST_ASSERT_EQUAL(RULES, run(cmd_mA));
    }
    in.estop = true;
    TEST_ASSERT_EQUAL(RULES, stop(false));
    in.estop = false;
    in.fault_reset = true;
    TEST_ASSERT_EQUAL(RULES, tick(QUIESCE_STATE_INIT, QUIESCE_FAULT_NONE, 200, true));
    TEST_ASSERT_EQUAL_UINT64(9, rules.ticks);
    TEST_ASSERT_EQUAL_UINT64(5, rules.running_ticks);
    TEST_ASSERT_EQUAL_UINT64(1, rules.starts);
    TEST_ASSERT_EQUAL_UINT64(1, rules.stops);
}

static void test_range(void) {
    arm();
    TEST_ASSERT_EQUAL(RULE_RANGE, run(5001));
    TEST_ASSERT_EQUAL(RULE_RANGE, run(-1));
    TEST_ASSERT_EQUAL_UINT64(2, rules.broken[RULE_RANGE]);
}

static void test_ceiling_of_the_board(void) {
    rig.has_board = true;
    quiesce_board_default(&rig.board);
    rig.board.damper[0].ceiling_mA = 1000;
    rig.board.damper[0].safe_mA = 200;
    arm();
    TEST_ASSERT_EQUAL(RULE_RANGE, run(1001));
}

static void test_slew(void) {
    arm();
    TEST_ASSERT_EQUAL(RULE_SLEW, run(1202)); // from the safe current
    TEST_ASSERT_EQUAL(RULES, run(2203));
    TEST_ASSERT_EQUAL(RULE_SLEW, run(3205));
}

static void test_safe_current(void) {
    TEST_ASSERT_EQUAL(RULE_SAFE, tick(QUIESCE_STATE_IDLE, QUIESCE_FAULT_NONE, 199, true));
    TEST_ASSERT_EQUAL(RULE_SAFE, tick(QUIESCE_STATE_SAFE, QUIESCE_FAULT_TICK_LOST, 0, true));
}

static void test_driver(void) {
    in.driver[0].has_failed = true;
    TEST_ASSERT_EQUAL(RULE_DRIVER,
                      tick(QUIESCE_STATE_FAULT, QUIESCE_FAULT_DRIVER_FAILED, 200, true));
    in.driver[0].has_failed = false;
    TEST_ASSERT_EQUAL(RULE_DRIVER, stop(true));
    TEST_ASSERT_EQUAL(RULE_DRIVER, tick(QUIESCE_STATE_FAULT, QUIESCE_FAULT_COIL_OPEN, 200, true));
}

static void test_stop_is_in_its_very_tick(void) {
    in.estop = true;
    TEST_ASSERT_EQUAL(RULE_STOP, tick(QUIESCE_STATE_IDLE, QUIESCE_FAULT_NONE, 200, false));
    TEST_ASSERT_EQUAL(RULE_STOP, tick(QUIESCE_STATE_FAULT, QUIESCE_FAULT_COIL_OPEN, 200, false));
}

static void test_latch_needs_an_edge(void) {
    TEST_ASSERT_EQUAL(RULES, stop(false));
    TEST_ASSERT_EQUAL(RULE_LATCH, idle());
    in.fault_reset = true;
    TEST_ASSERT_EQUAL(RULES, stop(false));
    TEST_ASSERT_EQUAL(RULE_LATCH, idle()); // held
}

static void test_running_needs_an_edge_of_enable(void) {
    in.enable = true; // from the start on
    TEST_ASSERT_EQUAL(RULES, idle());
    TEST_ASSERT_EQUAL(RULE_ARMING, run(200));
    setUp();
    arm();
    TEST_ASSERT_EQUAL(RULES, run(200));
    TEST_ASSERT_EQUAL(RULES, stop(false)); // enable is still held
    in.fault_reset = true;
    TEST_ASSERT_EQUAL(RULES, idle());
    TEST_ASSERT_EQUAL(RULE_ARMING, run(200));
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(test_what_keeps_all_rules_breaks_none);
    RUN_TEST(test_range);
    RUN_TEST(test_ceiling_of_the_board);
    RUN_TEST(test_slew);
    RUN_TEST(test_safe_current);
    RUN_TEST(test_driver);
    RUN_TEST(test_stop_is_in_its_very_tick);
    RUN_TEST(test_latch_needs_an_edge);
    RUN_TEST(test_running_needs_an_edge_of_enable);
    return UNITY_END();
}
