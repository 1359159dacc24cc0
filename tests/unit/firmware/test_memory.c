// The controller's records of state and limits: a bit that flips is a fault in the next tick, with
// the driver off, and stays one. It sees the inside of the controller, whose source is a part of
// it.
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
        signal_sine(5195, 10000, in.tick, 1000) + signal_noise(&seed, 147), true};
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

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(test_memory_every_bit_of_the_supervisor);
    RUN_TEST(test_memory_every_bit_of_guard_and_ceiling);
    RUN_TEST(test_memory_that_has_changed_stays_a_fault);
    return UNITY_END();
}
