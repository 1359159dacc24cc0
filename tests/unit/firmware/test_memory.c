// The controller's records of state and limits: a bit that flips is a fault in the next tick, with
// the driver off, and stays one; of what it only reads, within a second. It sees the inside of the
// controller, whose source is a part of it.
#include "controller.c" // NOLINT(bugprone-suspicious-include)

#include <string.h>

#include "test_signal.h"
#include "unity.h"

static quiesce_t running;
static quiesce_t damaged;
static quiesce_in_t in;
static quiesce_out_t out;
static uint32_t seed;

static void tick(quiesce_t *controller) {
    in.tick++;
    in.enable = in.tick > 1; // its edge arms
    in.sensor[0] = (quiesce_sample_t){
        .counts = signal_sine(5195, 10000, in.tick, 1000) + signal_noise(&seed, 147),
        .is_fresh = true,
    };
    quiesce_step(controller, &in, &out);
}

void setUp(void) {
    quiesce_params_t params;
    quiesce_params_default(&params);
    params.law = QUIESCE_LAW_CONSTANT;
    TEST_ASSERT_TRUE(quiesce_init(&running, &params));
    in = (quiesce_in_t){0};
    seed = 3;
    while (in.tick < 500) {
        tick(&running);
    }
    TEST_ASSERT_EQUAL_UINT32(QUIESCE_STATE_RUN, out.telemetry.state);
    TEST_ASSERT_EQUAL_INT32(5000, out.damper[0].current_cmd_mA);
}
void tearDown(void) {}

static void assert_shut(void) {
    TEST_ASSERT_EQUAL_UINT32(QUIESCE_STATE_FAULT, out.telemetry.state);
    TEST_ASSERT_EQUAL_UINT32(QUIESCE_FAULT_MEMORY, out.telemetry.fault);
    TEST_ASSERT_EQUAL_INT32(0, out.damper[0].current_cmd_mA);
    TEST_ASSERT_FALSE(out.damper[0].driver_enable);
}

static void flip_each_bit(size_t offset, size_t bytes) {
    for (size_t bit = 8 * offset; bit < 8 * (offset + bytes); bit++) {
        damaged = running;
        ((uint8_t *)damaged.opaque)[bit / 8] ^= (uint8_t)(1u << bit % 8);
        tick(&damaged);
        assert_shut();
    }
}

static void test_memory_every_bit_of_the_supervisor(void) {
    flip_each_bit(offsetof(controller_t, supervisor), sizeof(supervisor_t));
    flip_each_bit(offsetof(controller_t, supervisor_twin),
                  sizeof((controller_t *)NULL)->supervisor_twin);
}

static void test_memory_every_bit_of_guard_and_ceiling(void) {
    const size_t drive = offsetof(controller_t, drive);
    flip_each_bit(drive + offsetof(drive_t, limits), sizeof(drive_limits_t));
    flip_each_bit(drive + offsetof(drive_t, twin), sizeof((drive_t *)NULL)->twin);
}

static void test_memory_that_has_changed_stays_a_fault(void) {
    damaged = running;
    ((controller_t *)(void *)damaged.opaque)->drive[0].limits.ceiling_mA--;
    for (uint32_t i = 0; i < 2000; i++) {
        in.fault_reset = i % 100 < 50;
        tick(&damaged);
        assert_shut();
        TEST_ASSERT_EQUAL_UINT32(1, out.telemetry.fault_count);
    }
}

// Ticks until the fault, at the most 1001.
static uint32_t ticks_until_shut(void) {
    uint32_t ticks = 0;
    do {
        tick(&damaged);
        ticks++;
    } while (out.telemetry.fault != QUIESCE_FAULT_MEMORY && ticks <= 1000);
    return ticks;
}

// words: of the copy that runs, or of the caller; every_words apart.
static void flip_now_and_then(uint32_t *words, uint32_t count, uint32_t every_words) {
    const quiesce_in_t before = in;
    for (uint32_t i = 0; i < count; i += every_words) {
        damaged = running;
        in = before;
        words[i] ^= UINT32_C(1) << i % 32;
        const uint32_t ticks = ticks_until_shut();
        words[i] ^= UINT32_C(1) << i % 32;
        TEST_ASSERT_LESS_OR_EQUAL_UINT32(1000, ticks);
        assert_shut();
    }
    in = before;
}

static void assert_runs_on(uint32_t ticks) {
    while (ticks-- > 0) {
        tick(&running);
        TEST_ASSERT_EQUAL_UINT32(QUIESCE_FAULT_NONE, out.telemetry.fault);
    }
}

static void test_memory_parameters(void) {
    quiesce_params_t *used = &((controller_t *)(void *)damaged.opaque)->control.setup.params;
    quiesce_params_t other =
        ((const controller_t *)(const void *)running.opaque)->control.setup.params;
    flip_now_and_then((uint32_t *)(void *)used, QUIESCE_PARAM_COUNT, 5);
    other.constant_current_mA = 4000;
    TEST_ASSERT_TRUE(quiesce_params_use(&running, &other));
    assert_runs_on(2000);
    flip_now_and_then((uint32_t *)(void *)used, QUIESCE_PARAM_COUNT, 20);
}

static void test_memory_rules(void) {
    static uint32_t rules[QUIESCE_TABLE_WORDS];
    quiesce_params_t params;
    quiesce_params_default(&params);
    params.law = QUIESCE_LAW_FUZZY;
    TEST_ASSERT_TRUE(quiesce_init(&running, &params));
    const uint32_t *shipped =
        ((const controller_t *)(const void *)running.opaque)->control.setup.table;
    memcpy(rules, shipped, shipped[2] * sizeof(uint32_t));
    TEST_ASSERT_EQUAL(QUIESCE_TABLE_OK, quiesce_table_use(&running, rules, shipped[2]));
    assert_runs_on(1500);
    flip_now_and_then(rules, shipped[2], shipped[2] / 13);
    rules[5] ^= 1;
    TEST_ASSERT_TRUE(quiesce_table_drop(&running, QUIESCE_OF_LAW));
    assert_runs_on(2000);
}

// What came to nothing does not make right what has flipped meanwhile.
static void test_memory_rules_that_are_refused(void) {
    static uint32_t rules[QUIESCE_TABLE_WORDS];
    static const uint32_t nonsense[3] = {1, 2, 3};
    quiesce_params_t params;
    quiesce_params_default(&params);
    params.law = QUIESCE_LAW_FUZZY;
    TEST_ASSERT_TRUE(quiesce_init(&running, &params));
    const uint32_t *shipped =
        ((const controller_t *)(const void *)running.opaque)->control.setup.table;
    const uint32_t count = shipped[2];
    memcpy(rules, shipped, count * sizeof(uint32_t));
    TEST_ASSERT_EQUAL(QUIESCE_TABLE_OK, quiesce_table_use(&running, rules, count));
    assert_runs_on(1500);
    const quiesce_in_t before = in;
    damaged = running;
    rules[count / 2] ^= 16u;
    TEST_ASSERT_NOT_EQUAL(QUIESCE_TABLE_OK, quiesce_table_use(&damaged, nonsense, 3));
    TEST_ASSERT_EQUAL(QUIESCE_TABLE_CRC, quiesce_table_use(&damaged, rules, count));
    TEST_ASSERT_FALSE(quiesce_table_drop(&damaged, QUIESCE_OF_TRACKER));
    TEST_ASSERT_LESS_OR_EQUAL_UINT32(1000, ticks_until_shut());
    // The same words, checked again, are what is to be watched.
    in = before;
    rules[count / 2] ^= 16u;
    TEST_ASSERT_EQUAL(QUIESCE_TABLE_OK, quiesce_table_use(&running, rules, count));
    assert_runs_on(2000);
}

static void test_memory_words_of_the_caller(void) {
    static uint32_t program[20000];
    for (uint32_t i = 0; i < 20000; i++) {
        program[i] = i * i;
    }
    quiesce_watch(&running, QUIESCE_WATCHES, program, 0x7FFFFFFF); // no such number
    quiesce_watch(&running, QUIESCE_WATCHES - 1, program, 20000);
    assert_runs_on(2000);
    flip_now_and_then(program, 20000, 1999);
    quiesce_params_t params =
        ((const controller_t *)(const void *)running.opaque)->control.setup.params;
    TEST_ASSERT_TRUE(quiesce_restart(&running, NULL, &params));
    assert_runs_on(2000);
    flip_now_and_then(program, 20000, 9999);
    quiesce_watch(&running, QUIESCE_WATCHES - 1, NULL, 0);
    program[77]++;
    assert_runs_on(2000);
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(test_memory_every_bit_of_the_supervisor);
    RUN_TEST(test_memory_every_bit_of_guard_and_ceiling);
    RUN_TEST(test_memory_parameters);
    RUN_TEST(test_memory_rules);
    RUN_TEST(test_memory_rules_that_are_refused);
    RUN_TEST(test_memory_words_of_the_caller);
    RUN_TEST(test_memory_that_has_changed_stays_a_fault);
    return UNITY_END();
}
