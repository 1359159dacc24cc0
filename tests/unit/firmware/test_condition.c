#include "condition.h"
#include "test_signal.h"
#include "unity.h"

static condition_t condition;
static condition_out_t out;

static const condition_cfg_t config = {
    .tick_rate_Hz = 1000,
    .scale = 57751,
    .limit = CONDITION_ACCEL_LIMIT_um_s2,
    .period_ticks = 1,
    .most_lost_q16 = 65536,
    .offset_counts = 0,
    .polarity = 1,
    .full_scale_counts = 8388607,
    .max_age_ticks = 10,
    .stuck_ticks = 50,
    .dc_cutoff_mHz = 200,
};

void setUp(void) {
    condition_init(&condition, &config);
}
void tearDown(void) {}

static void step(int32_t counts) {
    condition_step(&condition, &(condition_in_t){.counts = counts, .is_fresh = true}, &out);
}

// Good samples that are never equal twice in a row.
static void step_good(uint32_t ticks) {
    for (uint32_t i = 0; i < ticks; i++) {
        step(i % 2 ? 100 : -100);
    }
}

static void test_scale_and_polarity(void) {
    step(0);
    step(1000000);
    const int32_t plain_um_s2 = out.value;
    TEST_ASSERT_INT32_WITHIN(1, 57751000, plain_um_s2);

    condition_cfg_t inverted = config;
    inverted.polarity = -1;
    condition_init(&condition, &inverted);
    step(0);
    step(1000000);
    TEST_ASSERT_INT32_WITHIN(1, -plain_um_s2, out.value);
}

static void test_gravity_is_gone_from_the_second_sample_on(void) {
    for (uint32_t i = 0; i < 3000; i++) {
        step(170000 + (i % 2 ? 1 : -1)); // 1 g
        TEST_ASSERT_INT32_WITHIN(i == 0 ? 10000000 : 60000, 0, out.value);
    }
}

static void test_offset_follows_slowly_and_a_tone_passes(void) {
    int32_t peak = 0;
    for (uint32_t i = 0; i < 6000; i++) {
        step(signal_sine(100000, 5000, i, 1000) + 3000000);
        if (i > 4000 && out.value > peak) {
            peak = out.value;
        }
    }
    TEST_ASSERT_INT32_WITHIN(5775100 / 100, 5775100, peak);
}

static void test_full_scale_saturates_at_the_limit(void) {
    condition_cfg_t coarse = config;
    coarse.scale = 1000000000;
    condition_init(&condition, &coarse);
    step(0);
    step(8388606);
    TEST_ASSERT_EQUAL_INT32(CONDITION_ACCEL_LIMIT_um_s2, out.value);
    step(-8388606);
    TEST_ASSERT_EQUAL_INT32(-CONDITION_ACCEL_LIMIT_um_s2, out.value);
}

static void test_dropout_holds_the_last_sample_then_faults_after_the_age_limit(void) {
    step_good(1000);
    step(123456);
    for (uint32_t i = 1; i <= 12; i++) {
        condition_step(&condition, &(condition_in_t){.counts = 999999, .is_fresh = false}, &out);
        TEST_ASSERT_EQUAL(CONDITION_LOST, out.flag);
        TEST_ASSERT_EQUAL(i > config.max_age_ticks, out.is_fault);
        // Held without moving the DC part; nothing once it is a fault.
        TEST_ASSERT_INT32_WITHIN(30000, out.is_fault ? 0 : 7129707, out.value);
        TEST_ASSERT_EQUAL_UINT32(i == 1u ? 997 : 0, out.good_ticks);
    }
    step(1);
    TEST_ASSERT_EQUAL(CONDITION_GOOD, out.flag);
    TEST_ASSERT_FALSE(out.is_fault);
    TEST_ASSERT_EQUAL_UINT32(1, out.good_ticks);
}

// Good samples in a row after a second in which every period-th sample is missing.
static uint32_t good_after_slips(uint32_t period) {
    condition_init(&condition, &config);
    for (uint32_t i = 1; i <= 1000; i++) {
        condition_step(&condition,
                       &(condition_in_t){.counts = (int32_t)(i % 3u), .is_fresh = i % period != 0u},
                       &out);
        TEST_ASSERT_FALSE(out.is_fault);
    }
    return out.good_ticks;
}

static void test_a_slip_now_and_then_does_not_end_a_run_of_good_samples(void) {
    TEST_ASSERT_EQUAL_UINT32(990 - 40, good_after_slips(100));
    TEST_ASSERT_EQUAL_UINT32(900 - 400, good_after_slips(10));
    TEST_ASSERT_LESS_THAN_UINT32(5, good_after_slips(5));
    TEST_ASSERT_LESS_THAN_UINT32(5, good_after_slips(2));
}

static void test_saturated_and_out_of_range_samples_are_told_apart(void) {
    step_good(4);
    step(8388607);
    TEST_ASSERT_EQUAL(CONDITION_SATURATED, out.flag);
    step(-8388607);
    TEST_ASSERT_EQUAL(CONDITION_SATURATED, out.flag);
    step(-8388608); // the negative rail of two's complement
    TEST_ASSERT_EQUAL(CONDITION_SATURATED, out.flag);
    step(-8388609);
    TEST_ASSERT_EQUAL(CONDITION_RANGE, out.flag);
    step(8388608);
    TEST_ASSERT_EQUAL(CONDITION_RANGE, out.flag);
    step(INT32_MIN);
    TEST_ASSERT_EQUAL(CONDITION_RANGE, out.flag);
    TEST_ASSERT_FALSE(out.is_fault);
}

static void test_a_sender_may_say_that_it_is_saturated(void) {
    step(1000);
    condition_step(&condition,
                   &(condition_in_t){.counts = 2000, .is_fresh = true, .is_saturated = true}, &out);
    TEST_ASSERT_EQUAL(CONDITION_SATURATED, out.flag);
    TEST_ASSERT_EQUAL_INT32(57751, out.raw); // of the sample before
}

static void test_stuck_is_a_fault_at_its_limit_and_can_be_switched_off(void) {
    for (uint32_t i = 0; i <= 60; i++) {
        step(777);
        TEST_ASSERT_EQUAL(i + 1 >= config.stuck_ticks, out.is_fault);
    }
    condition_cfg_t unchecked = config;
    unchecked.stuck_ticks = 0;
    condition_init(&condition, &unchecked);
    for (uint32_t i = 0; i <= 60; i++) {
        step(777);
        TEST_ASSERT_FALSE(out.is_fault);
    }
}

static void start_with_noise_check(uint32_t min_noise_counts, uint32_t rate_Hz) {
    condition_cfg_t checked = config;
    checked.min_noise_counts = min_noise_counts;
    checked.tick_rate_Hz = rate_Hz;
    condition_init(&condition, &checked);
}

// A 10 Hz vibration in uniform noise of RMS span / sqrt(3); returns the ticks that were faults.
static uint32_t step_noisy(int32_t span, uint32_t ticks) {
    static uint32_t seed = 5;
    uint32_t faults = 0;
    for (uint32_t i = 0; i < ticks; i++) {
        step(signal_sine(20000, 10000, i, 4000) + 170000 + signal_noise(&seed, span));
        faults += out.is_fault ? 1u : 0u;
    }
    return faults;
}

static void test_noise_is_judged_by_its_rms_at_every_rate(void) {
    static const uint32_t rates_Hz[] = {500, 1000, 2000, 4000};
    for (uint32_t i = 0; i < 4; i++) {
        start_with_noise_check(85, rates_Hz[i]);
        // RMS 104 passes, RMS 69 is a fault from the end of the first second on.
        TEST_ASSERT_EQUAL_UINT32(0, step_noisy(180, 5 * rates_Hz[i]));
        start_with_noise_check(85, rates_Hz[i]);
        TEST_ASSERT_EQUAL_UINT32(4 * rates_Hz[i] + 1, step_noisy(120, 5 * rates_Hz[i]));
    }
}

// What a dead analog path leaves: a few neighbouring values, never 50 times the same.
static void test_a_few_repeating_values_are_quiet_until_the_noise_is_back(void) {
    start_with_noise_check(20, 1000);
    TEST_ASSERT_EQUAL_UINT32(0, step_noisy(147, 3000));
    uint32_t first_fault = 0;
    for (uint32_t i = 1; i <= 3000; i++) {
        step(i % 40 < 20 ? 700 : 701);
        TEST_ASSERT_NOT_EQUAL(CONDITION_STUCK, out.flag);
        first_fault = first_fault == 0 && out.is_fault ? i : first_fault;
    }
    TEST_ASSERT_EQUAL_UINT32(1000, first_fault);
    TEST_ASSERT_EQUAL(CONDITION_QUIET, out.flag);
    TEST_ASSERT_EQUAL_INT32(0, out.value);
    TEST_ASSERT_EQUAL_UINT32(0, out.good_ticks);
    TEST_ASSERT_UINT32_WITHIN(60, 300, step_noisy(147, 900)); // each counts 2 to 4 limits
    TEST_ASSERT_FALSE(out.is_fault);
    TEST_ASSERT_EQUAL_UINT32(0, step_noisy(147, 5000));
}

static void test_glitches_do_not_pass_for_noise(void) {
    start_with_noise_check(20, 1000);
    for (uint32_t i = 1; i <= 4000; i++) {
        step(i % 20 == 0 ? 1000000 : i % 2 ? 700 : 701);
    }
    TEST_ASSERT_EQUAL(CONDITION_QUIET, out.flag);
}

static void test_noise_check_is_off_at_0_and_bounded_at_its_largest(void) {
    for (uint32_t i = 0; i < 5000; i++) {
        step(i % 2 ? 700 : 701);
        TEST_ASSERT_EQUAL(CONDITION_GOOD, out.flag);
    }
    start_with_noise_check(65535, 4000);
    for (uint32_t i = 0; i < 20000; i++) {
        step(i % 2 ? 8388606 : -8388606);
        TEST_ASSERT_EQUAL(CONDITION_GOOD, out.flag);
    }
}

static void test_offset_is_learnt_anew_after_a_fault(void) {
    step_good(2000);
    for (uint32_t i = 0; i < 5000; i++) {
        step(4000000); // stuck far off
    }
    TEST_ASSERT_TRUE(out.is_fault);
    for (uint32_t i = 0; i < 300; i++) {
        step(i % 2 ? 170100 : 169900); // back, with 1 g on it
        TEST_ASSERT_INT32_WITHIN(20000, 0, out.value);
    }
}

static void test_raw_keeps_the_dc_part_holds_and_saturates(void) {
    condition_step(&condition, &(condition_in_t){.counts = 5000, .is_fresh = false}, &out);
    TEST_ASSERT_EQUAL_INT32(0, out.raw); // nothing measured yet
    step(170000);
    TEST_ASSERT_EQUAL_INT32(9817670, out.raw); // 170000 x 57751 nm/s2
    for (uint32_t i = 0; i < 20; i++) {
        condition_step(&condition, &(condition_in_t){.counts = 5000, .is_fresh = i % 2 == 1}, &out);
        TEST_ASSERT_EQUAL_INT32(i == 0 ? 9817670 : 288755, out.raw);
    }
    step(8388607); // full scale: a bad sample
    TEST_ASSERT_EQUAL_INT32(288755, out.raw);

    condition_cfg_t inverted = config;
    inverted.polarity = -1;
    inverted.scale = 1000000000;
    condition_init(&condition, &inverted);
    step(8388606);
    TEST_ASSERT_EQUAL_INT32(-CONDITION_ACCEL_LIMIT_um_s2, out.raw);
}

static void test_silent_start_passes_nothing_on(void) {
    for (uint32_t i = 0; i < 500; i++) {
        condition_step(&condition, &(condition_in_t){.counts = 0, .is_fresh = false}, &out);
        TEST_ASSERT_EQUAL_INT32(0, out.value);
    }
    step(170000);
    TEST_ASSERT_EQUAL_INT32(0, out.value);
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(test_scale_and_polarity);
    RUN_TEST(test_gravity_is_gone_from_the_second_sample_on);
    RUN_TEST(test_offset_follows_slowly_and_a_tone_passes);
    RUN_TEST(test_full_scale_saturates_at_the_limit);
    RUN_TEST(test_dropout_holds_the_last_sample_then_faults_after_the_age_limit);
    RUN_TEST(test_a_slip_now_and_then_does_not_end_a_run_of_good_samples);
    RUN_TEST(test_saturated_and_out_of_range_samples_are_told_apart);
    RUN_TEST(test_a_sender_may_say_that_it_is_saturated);
    RUN_TEST(test_stuck_is_a_fault_at_its_limit_and_can_be_switched_off);
    RUN_TEST(test_noise_is_judged_by_its_rms_at_every_rate);
    RUN_TEST(test_a_few_repeating_values_are_quiet_until_the_noise_is_back);
    RUN_TEST(test_glitches_do_not_pass_for_noise);
    RUN_TEST(test_noise_check_is_off_at_0_and_bounded_at_its_largest);
    RUN_TEST(test_offset_is_learnt_anew_after_a_fault);
    RUN_TEST(test_raw_keeps_the_dc_part_holds_and_saturates);
    RUN_TEST(test_silent_start_passes_nothing_on);
    return UNITY_END();
}
