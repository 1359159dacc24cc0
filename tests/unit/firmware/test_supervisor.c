// Supervisor: every entry of its table, arming, faults, and what holds over random walks.
#include "supervisor.h"
#include "test_signal.h"
#include "twin.h"
#include "unity.h"

#define NONE QUIESCE_FAULT_NONE
#define LOST QUIESCE_FAULT_SENSOR_LOST
#define ESTOP QUIESCE_FAULT_ESTOP

static supervisor_t supervisor;

void setUp(void) {
    supervisor_init(&supervisor, NONE);
}
void tearDown(void) {}

static quiesce_state_t step(const supervisor_in_t *in) {
    (void)supervisor_step(&supervisor, in);
    const bool may_run =
        supervisor.state == QUIESCE_STATE_RUN || supervisor.state == QUIESCE_STATE_DEGRADED;
    TEST_ASSERT_EQUAL(may_run, supervisor_allows_output(&supervisor));
    const bool is_off = supervisor.state == QUIESCE_STATE_INIT ||
                        supervisor.state == QUIESCE_STATE_SELF_TEST ||
                        supervisor.state == QUIESCE_STATE_FAULT;
    TEST_ASSERT_FALSE(is_off && supervisor_allows_driver(&supervisor));
    TEST_ASSERT_TRUE(is_off || supervisor.state == QUIESCE_STATE_SAFE ||
                     supervisor_allows_driver(&supervisor));
    return (quiesce_state_t)supervisor.state;
}

#define STEP(...) step(&(supervisor_in_t){__VA_ARGS__})

// What happens in a tick, from a state, armed or not.
typedef struct {
    supervisor_in_t in;
    bool is_armed;
} event_t;

static const event_t events[] = {
    {{.is_ready = false}, false},
    {{.is_ready = true}, false},
    {{.is_ready = false, .enable = true}, true},
    {{.is_ready = true, .enable = true}, true},
    {{.is_ready = true, .is_limited = true, .enable = true}, true},
    {{.clearing_fault = LOST, .is_ready = true, .enable = true}, true},
    {{.latched_fault = ESTOP, .is_ready = true, .enable = true}, true},
};

static void test_supervisor_every_entry_of_its_table(void) {
    enum {
        I,
        D,
        R,
        S,
        F,
        A,
        G,
        T
    }; // init, idle (disarmed), run, safe, fault, armed, degraded, test
    static const uint8_t expected[QUIESCE_STATE_COUNT][7] = {
        [QUIESCE_STATE_INIT] = {T, T, T, T, T, S, F},
        [QUIESCE_STATE_SELF_TEST] = {T, D, T, A, A, S, F},
        [QUIESCE_STATE_IDLE] = {D, D, A, A, A, S, F},
        [QUIESCE_STATE_ARMED] = {D, D, A, R, G, S, F},
        [QUIESCE_STATE_RUN] = {D, D, R, R, G, S, F},
        [QUIESCE_STATE_DEGRADED] = {D, D, G, R, G, S, F},
        [QUIESCE_STATE_SAFE] = {S, D, S, A, A, S, F},
        [QUIESCE_STATE_FAULT] = {F, F, F, F, F, F, F}, // not acknowledged
    };
    for (uint32_t state = 0; state < QUIESCE_STATE_COUNT; state++) {
        for (uint32_t i = 0; i < 7; i++) {
            supervisor = (supervisor_t){.state = (uint8_t)state,
                                        .flags = SUPERVISOR_WAS_ENABLED |
                                                 (events[i].is_armed ? SUPERVISOR_ARMED : 0u)};
            TEST_ASSERT_EQUAL_MESSAGE(expected[state][i], step(&events[i].in), "next state");
        }
    }
}

static void test_supervisor_leaves_fault_disarmed_with_the_cause_gone(void) {
    enum { FIRST_ARMED = 2, FIRST_FAULT = 5 };
    static const uint8_t expected[] = {
        QUIESCE_STATE_INIT,  QUIESCE_STATE_INIT, QUIESCE_STATE_FAULT, QUIESCE_STATE_FAULT,
        QUIESCE_STATE_FAULT, QUIESCE_STATE_SAFE, QUIESCE_STATE_FAULT};
    for (uint32_t i = 0; i < 7; i++) {
        supervisor_in_t in = events[i].in;
        in.fault_reset = true;
        const bool is_armed = i >= FIRST_ARMED && i < FIRST_FAULT; // by a bit that flipped
        supervisor = (supervisor_t){
            .state = QUIESCE_STATE_FAULT,
            .fault = ESTOP,
            .flags = (uint8_t)(SUPERVISOR_WAS_ENABLED | (is_armed ? SUPERVISOR_ARMED : 0u))};
        TEST_ASSERT_EQUAL(expected[i], step(&in));
        TEST_ASSERT_FALSE(supervisor_is_armed(&supervisor));
    }
}

static void test_supervisor_of_an_unknown_state_is_in_fault(void) {
    supervisor.state = QUIESCE_STATE_COUNT;
    TEST_ASSERT_EQUAL(QUIESCE_STATE_FAULT, STEP(.is_ready = true));
}

static void go_to_run(void) {
    STEP(.is_ready = true);
    STEP(.is_ready = true);
    STEP(.is_ready = true, .enable = true);
    TEST_ASSERT_EQUAL(QUIESCE_STATE_RUN, STEP(.is_ready = true, .enable = true));
}

static void test_supervisor_way_from_init_to_run_and_back(void) {
    TEST_ASSERT_EQUAL(QUIESCE_STATE_INIT, supervisor.state);
    TEST_ASSERT_EQUAL(QUIESCE_STATE_SELF_TEST, STEP(.is_ready = true));
    TEST_ASSERT_EQUAL(QUIESCE_STATE_SELF_TEST, STEP(.is_ready = false));
    TEST_ASSERT_EQUAL(QUIESCE_STATE_IDLE, STEP(.is_ready = true));
    TEST_ASSERT_EQUAL(QUIESCE_STATE_ARMED, STEP(.is_ready = true, .enable = true));
    TEST_ASSERT_EQUAL(QUIESCE_STATE_RUN, STEP(.is_ready = true, .enable = true));
    TEST_ASSERT_EQUAL(QUIESCE_STATE_RUN, STEP(.enable = true));
    TEST_ASSERT_EQUAL(QUIESCE_STATE_IDLE, STEP(.enable = false));
}

static void test_supervisor_has_drivers_off_until_a_test_has_passed(void) {
    STEP(.is_ready = false);
    TEST_ASSERT_EQUAL(QUIESCE_STATE_SAFE, STEP(.clearing_fault = LOST, .is_ready = true));
    TEST_ASSERT_FALSE(supervisor_allows_driver(&supervisor));
    TEST_ASSERT_EQUAL(QUIESCE_STATE_SAFE, STEP(.is_ready = false));
    TEST_ASSERT_FALSE(supervisor_allows_driver(&supervisor));
    TEST_ASSERT_EQUAL(QUIESCE_STATE_IDLE, STEP(.is_ready = true));
    TEST_ASSERT_TRUE(supervisor_allows_driver(&supervisor));
    TEST_ASSERT_EQUAL(QUIESCE_STATE_SAFE, STEP(.clearing_fault = LOST));
    TEST_ASSERT_TRUE(supervisor_allows_driver(&supervisor)); // the safe current
    STEP(.latched_fault = ESTOP);
    STEP(.clearing_fault = LOST, .fault_reset = true);
    TEST_ASSERT_EQUAL(QUIESCE_STATE_SAFE, supervisor.state);
    TEST_ASSERT_FALSE(supervisor_allows_driver(&supervisor)); // to be tested anew
}

static void test_supervisor_starts_nothing_that_is_held_from_the_start(void) {
    for (uint32_t i = 0; i < 1000; i++) {
        STEP(.is_ready = i > 300, .enable = true, .fault_reset = true);
    }
    TEST_ASSERT_EQUAL(QUIESCE_STATE_IDLE, supervisor.state);
    STEP(.is_ready = true);
    TEST_ASSERT_EQUAL(QUIESCE_STATE_ARMED, STEP(.is_ready = true, .enable = true));
}

static void test_supervisor_pressed_while_it_starts_is_armed(void) {
    STEP(.is_ready = false);
    STEP(.enable = true);
    TEST_ASSERT_EQUAL(QUIESCE_STATE_ARMED, STEP(.is_ready = true, .enable = true));
}

static void test_supervisor_clearing_fault_returns_by_itself(void) {
    go_to_run();
    TEST_ASSERT_EQUAL(QUIESCE_STATE_SAFE, STEP(.clearing_fault = LOST, .enable = true));
    TEST_ASSERT_EQUAL(LOST, supervisor.fault);
    TEST_ASSERT_EQUAL(QUIESCE_STATE_SAFE,
                      STEP(.clearing_fault = QUIESCE_FAULT_TICK_LOST, .enable = true));
    TEST_ASSERT_EQUAL(LOST, supervisor.fault);
    TEST_ASSERT_EQUAL(QUIESCE_STATE_SAFE, STEP(.enable = true));
    TEST_ASSERT_EQUAL(QUIESCE_STATE_ARMED, STEP(.is_ready = true, .enable = true));
    TEST_ASSERT_EQUAL(NONE, supervisor.fault);
    TEST_ASSERT_EQUAL(QUIESCE_STATE_RUN, STEP(.is_ready = true, .enable = true));
    TEST_ASSERT_EQUAL_UINT32(1, supervisor.fault_count);
}

static void test_supervisor_pressed_in_safe_is_not_armed(void) {
    go_to_run();
    STEP(.clearing_fault = LOST, .enable = true);
    STEP(.clearing_fault = LOST);
    STEP(.clearing_fault = LOST, .enable = true);
    TEST_ASSERT_EQUAL(QUIESCE_STATE_IDLE, STEP(.is_ready = true, .enable = true));
    TEST_ASSERT_EQUAL(QUIESCE_STATE_IDLE, STEP(.is_ready = true, .enable = true));
}

static void test_supervisor_latched_fault_needs_an_edge_with_the_cause_gone(void) {
    go_to_run();
    TEST_ASSERT_EQUAL(QUIESCE_STATE_FAULT, STEP(.latched_fault = ESTOP, .enable = true));
    TEST_ASSERT_EQUAL(QUIESCE_STATE_FAULT, STEP(.latched_fault = ESTOP, .fault_reset = true));
    TEST_ASSERT_EQUAL(QUIESCE_STATE_FAULT, STEP(.fault_reset = true)); // no new edge
    TEST_ASSERT_EQUAL(QUIESCE_STATE_FAULT, STEP(.enable = true));
    TEST_ASSERT_TRUE(supervisor_step(
        &supervisor, &(supervisor_in_t){.is_ready = true, .enable = true, .fault_reset = true}));
    TEST_ASSERT_EQUAL(QUIESCE_STATE_INIT, supervisor.state);
    for (uint32_t i = 0; i < 100; i++) { // enable is still held
        STEP(.is_ready = true, .enable = true);
    }
    TEST_ASSERT_EQUAL(QUIESCE_STATE_IDLE, supervisor.state);
}

static void test_supervisor_latched_fault_outranks_a_clearing_one(void) {
    STEP(.clearing_fault = QUIESCE_FAULT_SENSOR_STUCK);
    TEST_ASSERT_EQUAL(QUIESCE_STATE_FAULT, STEP(.clearing_fault = QUIESCE_FAULT_SENSOR_STUCK,
                                                .latched_fault = QUIESCE_FAULT_COIL_OPEN));
    TEST_ASSERT_EQUAL(QUIESCE_FAULT_COIL_OPEN, supervisor.fault);
    TEST_ASSERT_EQUAL_UINT32(2, supervisor.fault_count);
}

static void test_supervisor_tells_an_emergency_stop_on_top_of_others(void) {
    STEP(.latched_fault = QUIESCE_FAULT_CURRENT_LOST);
    STEP(.latched_fault = QUIESCE_FAULT_DRIVER_FAILED);
    TEST_ASSERT_EQUAL(QUIESCE_FAULT_CURRENT_LOST, supervisor.fault);
    STEP(.latched_fault = ESTOP);
    STEP(.latched_fault = ESTOP);
    TEST_ASSERT_EQUAL(ESTOP, supervisor.fault);
    STEP(.latched_fault = QUIESCE_FAULT_DRIVER_FAILED);
    TEST_ASSERT_EQUAL(ESTOP, supervisor.fault);
    TEST_ASSERT_EQUAL_UINT32(2, supervisor.fault_count);
}

static void test_supervisor_final_faults_never_end(void) {
    static const quiesce_fault_t finals[] = {QUIESCE_FAULT_PARAMETER, QUIESCE_FAULT_MEMORY};
    for (uint32_t k = 0; k < 2; k++) {
        supervisor_init(&supervisor, finals[k]);
        TEST_ASSERT_EQUAL_UINT32(1, supervisor.fault_count);
        for (uint32_t i = 0; i < 20; i++) {
            TEST_ASSERT_EQUAL(QUIESCE_STATE_FAULT,
                              STEP(.latched_fault = i == 7 ? ESTOP : NONE, .is_ready = true,
                                   .enable = i % 3 != 0, .fault_reset = i % 2 != 0));
        }
        TEST_ASSERT_EQUAL(finals[k], supervisor.fault);
    }
}

static bool draw_one_in(uint32_t *seed, int32_t of) {
    return signal_noise(seed, 1 << 20) % of == 0;
}

// Off in the tick of a stop; running only after an edge since the last stop, and only while
// enabled.
static void test_supervisor_random_walks(void) {
    uint32_t seed = 2026;
    bool has_edge = false;
    bool was_enabled = true;
    uint32_t runs = 0;
    supervisor_in_t in = {.enable = true};
    for (uint32_t i = 0; i < 300000; i++) {
        in.enable = draw_one_in(&seed, 40) ? !in.enable : in.enable;
        in.fault_reset = draw_one_in(&seed, 30);
        in.is_ready = !draw_one_in(&seed, 8);
        in.is_limited = draw_one_in(&seed, 5);
        in.latched_fault = draw_one_in(&seed, 300) ? ESTOP : NONE;
        in.clearing_fault = draw_one_in(&seed, 60) ? LOST : NONE;
        has_edge = in.enable && (has_edge || !was_enabled);
        was_enabled = in.enable;
        step(&in);
        has_edge = has_edge && supervisor.state != QUIESCE_STATE_FAULT;
        runs += supervisor_allows_output(&supervisor) ? 1u : 0u;
        TEST_ASSERT_TRUE(in.latched_fault == NONE || supervisor.state == QUIESCE_STATE_FAULT);
        TEST_ASSERT_TRUE(!supervisor_allows_output(&supervisor) || (has_edge && in.enable));
        TEST_ASSERT_TRUE(in.clearing_fault == NONE || !supervisor_allows_output(&supervisor));
    }
    TEST_ASSERT_GREATER_THAN_UINT32(20000, runs);
}

// Each bit, and each pair of bits, of record and twin.
static void test_supervisor_record_shows_every_flip(void) {
    enum { WORDS = WORDS_OF(supervisor_t), BITS = 32 * (2 * WORDS + 1) };
    uint32_t word[2 * WORDS + 1] = {0x01010002, 7};
    twin_make(word, WORDS, &word[WORDS]);
    TEST_ASSERT_TRUE(twin_holds(word, WORDS, &word[WORDS]));
    for (uint32_t a = 0; a < BITS; a++) {
        word[a / 32] ^= UINT32_C(1) << a % 32;
        TEST_ASSERT_FALSE(twin_holds(word, WORDS, &word[WORDS]));
        for (uint32_t b = 0; b < a; b++) {
            word[b / 32] ^= UINT32_C(1) << b % 32;
            TEST_ASSERT_FALSE(twin_holds(word, WORDS, &word[WORDS]));
            word[b / 32] ^= UINT32_C(1) << b % 32;
        }
        word[a / 32] ^= UINT32_C(1) << a % 32;
    }
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(test_supervisor_every_entry_of_its_table);
    RUN_TEST(test_supervisor_leaves_fault_disarmed_with_the_cause_gone);
    RUN_TEST(test_supervisor_of_an_unknown_state_is_in_fault);
    RUN_TEST(test_supervisor_way_from_init_to_run_and_back);
    RUN_TEST(test_supervisor_has_drivers_off_until_a_test_has_passed);
    RUN_TEST(test_supervisor_starts_nothing_that_is_held_from_the_start);
    RUN_TEST(test_supervisor_pressed_while_it_starts_is_armed);
    RUN_TEST(test_supervisor_clearing_fault_returns_by_itself);
    RUN_TEST(test_supervisor_pressed_in_safe_is_not_armed);
    RUN_TEST(test_supervisor_latched_fault_needs_an_edge_with_the_cause_gone);
    RUN_TEST(test_supervisor_latched_fault_outranks_a_clearing_one);
    RUN_TEST(test_supervisor_tells_an_emergency_stop_on_top_of_others);
    RUN_TEST(test_supervisor_final_faults_never_end);
    RUN_TEST(test_supervisor_random_walks);
    RUN_TEST(test_supervisor_record_shows_every_flip);
    return UNITY_END();
}
