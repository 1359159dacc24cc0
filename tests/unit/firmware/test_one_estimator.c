// A build that holds one estimator: it is the default there, and the other one is refused.
#include "quiesce.h"
#include "test_signal.h"
#include "unity.h"

#if QUIESCE_WITH_FIT == QUIESCE_WITH_FFT
#error "for builds with one estimator"
#endif
#define OWN (QUIESCE_WITH_FIT ? QUIESCE_ESTIMATOR_FIT : QUIESCE_ESTIMATOR_FFT)
#define OTHER (QUIESCE_WITH_FIT ? QUIESCE_ESTIMATOR_FFT : QUIESCE_ESTIMATOR_FIT)

static quiesce_t controller;
static quiesce_params_t params;

void setUp(void) {
    quiesce_params_default(&params);
}
void tearDown(void) {}

static void test_one_estimator_is_the_default(void) {
    TEST_ASSERT_EQUAL_INT32(OWN, params.estimator);
    TEST_ASSERT_TRUE(quiesce_params_check(&params, NULL));
}

static void test_one_estimator_finds_a_tone(void) {
    quiesce_out_t out = {0};
    TEST_ASSERT_TRUE(quiesce_init(&controller, &params));
    for (uint32_t tick = 0; tick < 1500; tick++) {
        quiesce_in_t in = {.tick = tick, .sensor[0].is_fresh = true};
        in.sensor[0].counts = signal_sine(20000, 12000, tick, 1000);
        quiesce_step(&controller, &in, &out);
    }
    TEST_ASSERT_EQUAL_UINT32(1, out.telemetry.freq_is_valid);
    TEST_ASSERT_INT32_WITHIN(1000, 12000000, out.telemetry.freq_uHz);
}

static void test_one_estimator_refuses_the_other(void) {
    quiesce_param_error_t error;
    params.estimator = OTHER;
    TEST_ASSERT_FALSE(quiesce_params_check(&params, &error));
    TEST_ASSERT_EQUAL_STRING("estimator", quiesce_param_info(error.index)->name);
    TEST_ASSERT_EQUAL_STRING("not in this build", error.reason);
    // On defaults, as with any parameters that are refused.
    TEST_ASSERT_FALSE(quiesce_init(&controller, &params));
    quiesce_out_t out = {0};
    quiesce_step(&controller, &(quiesce_in_t){.sensor[0].is_fresh = true}, &out);
    TEST_ASSERT_EQUAL_UINT32(QUIESCE_FAULT_PARAMETER, out.telemetry.fault);
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(test_one_estimator_is_the_default);
    RUN_TEST(test_one_estimator_finds_a_tone);
    RUN_TEST(test_one_estimator_refuses_the_other);
    return UNITY_END();
}
