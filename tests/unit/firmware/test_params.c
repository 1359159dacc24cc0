#include "quiesce.h"

#include <stddef.h>
#include <string.h>

#include "unity.h"

static quiesce_params_t params;
static quiesce_param_error_t error;

void setUp(void) {
    quiesce_params_default(&params);
}
void tearDown(void) {}

static void test_defaults_are_accepted(void) {
    TEST_ASSERT_TRUE(quiesce_params_check(&params, NULL));
}

static void test_each_value_outside_its_range_is_named(void) {
    for (uint32_t i = 0; i < QUIESCE_PARAM_COUNT; i++) {
        const quiesce_param_info_t *info = quiesce_param_info(i);
        const int64_t bad[] = {(int64_t)info->min - 1, (int64_t)info->max + 1};
        for (uint32_t k = 0; k < 2; k++) {
            quiesce_params_default(&params);
            TEST_ASSERT_TRUE(quiesce_param_set(&params, i, (int32_t)bad[k]));
            TEST_ASSERT_FALSE(quiesce_params_check(&params, &error));
            TEST_ASSERT_EQUAL_STRING(info->name, quiesce_param_info(error.index)->name);
            TEST_ASSERT_EQUAL_UINT32(i, error.index);
            TEST_ASSERT_EQUAL_STRING("out of range", error.reason);
        }
    }
}

static void test_values_between_the_choices_are_refused(void) {
    params.tick_rate_Hz = 1500;
    TEST_ASSERT_FALSE(quiesce_params_check(&params, &error));
    TEST_ASSERT_EQUAL_STRING("tick_rate_Hz", quiesce_param_info(error.index)->name);
    setUp();
    params.selftune_polarity = 0;
    TEST_ASSERT_FALSE(quiesce_params_check(&params, &error));
    TEST_ASSERT_EQUAL_STRING("selftune_polarity", quiesce_param_info(error.index)->name);
}

static void test_sensors_that_could_not_be_believed_are_refused(void) {
    params.accel_scale_nm_s2 = 59604; // 2^23 - 1 counts are 499.994 m/s2
    TEST_ASSERT_TRUE(quiesce_params_check(&params, &error));
    params.accel_scale_nm_s2 = 59605;
    TEST_ASSERT_FALSE(quiesce_params_check(&params, &error));
    TEST_ASSERT_EQUAL_STRING("accel_scale_nm_s2", quiesce_param_info(error.index)->name);
    setUp();
    params.sensor_stuck_ticks = 1;
    TEST_ASSERT_FALSE(quiesce_params_check(&params, &error));
    TEST_ASSERT_EQUAL_STRING("sensor_stuck_ticks", quiesce_param_info(error.index)->name);
    params.sensor_stuck_ticks = 2;
    TEST_ASSERT_TRUE(quiesce_params_check(&params, &error));
    params.sensor_stuck_ticks = 0;
    TEST_ASSERT_TRUE(quiesce_params_check(&params, &error));
}

static void test_contradictions_are_named(void) {
    params.band_low_mHz = params.band_high_mHz = 20000;
    TEST_ASSERT_FALSE(quiesce_params_check(&params, &error));
    TEST_ASSERT_EQUAL_STRING("band_high_mHz", quiesce_param_info(error.index)->name);
    setUp();
    params.narrow_low_mHz = 5000; // never used, as nothing is above it
    TEST_ASSERT_TRUE(quiesce_params_check(&params, &error));
    params.narrow_high_mHz = 5000;
    TEST_ASSERT_FALSE(quiesce_params_check(&params, &error));
    TEST_ASSERT_EQUAL_STRING("narrow_high_mHz", quiesce_param_info(error.index)->name);
    params.narrow_high_mHz = 5001;
    TEST_ASSERT_TRUE(quiesce_params_check(&params, &error));
    const size_t currents[] = {offsetof(quiesce_params_t, constant_current_mA),
                               offsetof(quiesce_params_t, safe_current_mA),
                               offsetof(quiesce_params_t, unlock_current_mA)};
    for (uint32_t i = 0; i < 3; i++) {
        setUp();
        const uint32_t index = (uint32_t)(currents[i] / sizeof(int32_t));
        TEST_ASSERT_TRUE(quiesce_param_set(&params, index, params.max_current_mA + 1));
        TEST_ASSERT_FALSE(quiesce_params_check(&params, &error));
        TEST_ASSERT_EQUAL_UINT32(index, error.index);
        TEST_ASSERT_EQUAL_STRING("above max_current_mA", error.reason);
    }
}

static void test_current_check_must_be_able_to_see_an_open_coil(void) {
    params.current_error_mA = params.max_current_mA / 2 + 1;
    TEST_ASSERT_TRUE(quiesce_params_check(&params, NULL));
    params.current_check = QUIESCE_CURRENT_CHECK_ON;
    TEST_ASSERT_FALSE(quiesce_params_check(&params, &error));
    TEST_ASSERT_EQUAL_STRING("current_error_mA", quiesce_param_info(error.index)->name);
}

static void test_safe_current_of_a_refused_set(void) {
    params.law = 99;
    params.safe_current_mA = 700;
    TEST_ASSERT_EQUAL_INT32(700, quiesce_params_safe_current_mA(&params));
    params.safe_current_mA = params.max_current_mA + 1;
    TEST_ASSERT_EQUAL_INT32(0, quiesce_params_safe_current_mA(&params));
    params.safe_current_mA = params.max_current_mA = 2000000000;
    TEST_ASSERT_EQUAL_INT32(0, quiesce_params_safe_current_mA(&params));
}

static void test_access_by_index(void) {
    int32_t value = -1;
    TEST_ASSERT_TRUE(quiesce_param_get(&params, 0, &value));
    TEST_ASSERT_EQUAL_INT32(params.tick_rate_Hz, value);
    TEST_ASSERT_FALSE(quiesce_param_get(&params, QUIESCE_PARAM_COUNT, &value));
    TEST_ASSERT_FALSE(quiesce_param_set(&params, QUIESCE_PARAM_COUNT, 0));
    TEST_ASSERT_NULL(quiesce_param_info(QUIESCE_PARAM_COUNT));
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(test_defaults_are_accepted);
    RUN_TEST(test_each_value_outside_its_range_is_named);
    RUN_TEST(test_values_between_the_choices_are_refused);
    RUN_TEST(test_sensors_that_could_not_be_believed_are_refused);
    RUN_TEST(test_contradictions_are_named);
    RUN_TEST(test_current_check_must_be_able_to_see_an_open_coil);
    RUN_TEST(test_safe_current_of_a_refused_set);
    RUN_TEST(test_access_by_index);
    return UNITY_END();
}
