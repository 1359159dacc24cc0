#include "law.h"

#include <stddef.h>
#include <string.h>

#include "rest.h"
#include "selftune_state.h"
#include "unity.h"

static law_setup_t setup;
static quiesce_params_t *const params = &setup.params;
static selftune_t state;
static view_t view;
static int32_t base_mA; ///< what the rules say

extern const law_t law_off, law_constant, law_fuzzy, law_fuzzy_selftune;

void setUp(void) {
    quiesce_params_default(params);
    setup.table = rule_base_kind.shipped;
    memset(&state, 0, sizeof state);
    view = (view_t){
        .is_output_on = true,
        .valid = VIEW_RMS | VIEW_TONE | VIEW_VELOCITY,
        .body = {{.velocity_um_s = 1000, .accel_um_s2 = 20000}},
        .tone = {.freq_uHz = 5000000, .rms_um_s2 = 60000},
    };
    base_mA = 1000;
}
void tearDown(void) {}

static int32_t run(const law_t *law, uint32_t ticks) {
    law_demand_t demand = {{0}};
    state.rules = (rule_base_t){
        .is_known = true,
        .input = {view.tone.freq_uHz, view.tone.rms_um_s2},
        .current_mA = base_mA,
    };
    for (uint32_t i = 0; i < ticks; i++) {
        TEST_ASSERT_TRUE(law->step(&state, &setup, &view, &demand));
    }
    for (uint32_t i = 1; i < QUIESCE_DAMPERS; i++) {
        TEST_ASSERT_EQUAL_INT32(demand.value[0], demand.value[i]);
    }
    return demand.value[0];
}

static void test_every_label_has_its_law(void) {
    for (uint32_t i = 0; i < QUIESCE_PARAM_COUNT; i++) {
        const quiesce_param_info_t *info = quiesce_param_info(i);
        if (strcmp(info->name, "law") == 0) {
            TEST_ASSERT_EQUAL_INT32(QUIESCE_LAW_NETWORK, info->max);
            for (int32_t value = 0; value <= info->max; value++) {
                TEST_ASSERT_NOT_NULL(law_find(value));
                TEST_ASSERT_EQUAL_STRING(info->labels[value], law_find(value)->name);
            }
        }
    }
    TEST_ASSERT_NULL(law_find(-1));
    TEST_ASSERT_NULL(law_find(QUIESCE_LAW_NETWORK + 1));
}

static void test_plain_laws(void) {
    params->constant_current_mA = 1234;
    TEST_ASSERT_EQUAL_INT32(0, run(&law_off, 3));
    TEST_ASSERT_EQUAL_INT32(1234, run(&law_constant, 3));
    TEST_ASSERT_EQUAL_INT32(1000, run(&law_fuzzy, 3));
}

// Table X: rows of signs, printed polarity and reversed.
static void test_laws_without_a_frequency_are_at_the_safe_current_at_rest(void) {
    params->safe_current_mA = 300;
    view.valid = VIEW_RMS | VIEW_VELOCITY;
    TEST_ASSERT_EQUAL_INT32(5000, run(&law_fuzzy, 10));
    view.is_at_rest = true;
    TEST_ASSERT_EQUAL_INT32(300, run(&law_fuzzy, 10));
    TEST_ASSERT_EQUAL_INT32(300, run(&law_fuzzy_selftune, 10));
    TEST_ASSERT_EQUAL_INT32(params->constant_current_mA, run(&law_constant, 10));
}

static void test_rest_begins_after_its_time_and_ends_at_once(void) {
    rest_t rest = {0};
    params->rest_ms = 2000;
    view.tone.rms_um_s2 = params->rest_rms_um_s2 - 1;
    for (uint32_t i = 1; i < 2000; i++) {
        TEST_ASSERT_FALSE(rest_step(&rest, &view, params));
    }
    TEST_ASSERT_TRUE(rest_step(&rest, &view, params));
    view.valid = 0;
    TEST_ASSERT_FALSE(rest_step(&rest, &view, params)); // nothing is known
    view.valid = VIEW_RMS;
    for (uint32_t i = 0; i < 5000; i++) {
        TEST_ASSERT_EQUAL(i >= 1999, rest_step(&rest, &view, params));
    }
    view.tone.rms_um_s2++;
    TEST_ASSERT_FALSE(rest_step(&rest, &view, params));
    params->rest_rms_um_s2 = 0;
    view.tone.rms_um_s2 = 0;
    for (uint32_t i = 0; i < 5000; i++) {
        TEST_ASSERT_FALSE(rest_step(&rest, &view, params));
    }
}

static void test_selftune_follows_table_x(void) {
    const struct {
        int32_t accel_sign, velocity_sign, direction;
    } rows[] = {{1, 1, 1}, {1, -1, -1}, {-1, 1, -1}, {-1, -1, 1}, {0, 1, 0}, {1, 0, 0}};
    for (uint32_t i = 0; i < sizeof rows / sizeof rows[0]; i++) {
        for (int32_t polarity = -1; polarity <= 1; polarity += 2) {
            params->selftune_polarity = polarity;
            state.current_mA_q20 = INT64_C(2000) << 20;
            view.body[0].accel_um_s2 = 20000 * rows[i].accel_sign;
            view.body[0].velocity_um_s = 1 * rows[i].velocity_sign;
            // 200 A/s at 1 kHz is 200 mA a tick.
            TEST_ASSERT_EQUAL_INT32(2000 + 200 * rows[i].direction * polarity,
                                    run(&law_fuzzy_selftune, 1));
        }
    }
}

static void test_selftune_stays_between_zero_and_the_limit(void) {
    TEST_ASSERT_EQUAL_INT32(5000, run(&law_fuzzy_selftune, 1000));
    view.body[0].accel_um_s2 = -view.body[0].accel_um_s2;
    TEST_ASSERT_EQUAL_INT32(0, run(&law_fuzzy_selftune, 1000));
}

static void test_selftune_leaves_the_base_alone_above_its_frequency_and_unlocked(void) {
    params->selftune_upper_mHz = 7500;
    view.tone.freq_uHz = 7500000;
    TEST_ASSERT_EQUAL_INT32(1000, run(&law_fuzzy_selftune, 5));
    view.tone.freq_uHz = 7499000;
    TEST_ASSERT_EQUAL_INT32(1200, run(&law_fuzzy_selftune, 1));
    view.valid &= ~VIEW_TONE;
    params->unlock_current_mA = 5000;
    TEST_ASSERT_EQUAL_INT32(5000, run(&law_fuzzy_selftune, 1));
}

static void test_selftune_without_the_motion_leaves_the_base(void) {
    const int32_t tuned_mA = run(&law_fuzzy_selftune, 200);
    TEST_ASSERT_GREATER_THAN_INT32(base_mA, tuned_mA);
    view.valid &= ~VIEW_VELOCITY;
    TEST_ASSERT_EQUAL_INT32(base_mA, run(&law_fuzzy_selftune, 1));
}

// Nothing answers to it: it must not wind up until the output is on.
static void test_selftune_waits_at_the_base_while_the_output_is_off(void) {
    view.is_output_on = false;
    TEST_ASSERT_EQUAL_INT32(1000, run(&law_fuzzy_selftune, 50));
    view.is_output_on = true;
    TEST_ASSERT_EQUAL_INT32(1200, run(&law_fuzzy_selftune, 1));
}

static void test_selftune_deadband_holds(void) {
    params->selftune_deadband_um_s2 = 30000;
    state.current_mA_q20 = INT64_C(1500) << 20;
    TEST_ASSERT_EQUAL_INT32(1500, run(&law_fuzzy_selftune, 100));
}

static void test_selftune_leak_returns_to_the_base(void) {
    params->selftune_leak_ms = 200;
    view.body[0].accel_um_s2 = 0; // no drive: pure decay from 3 A to 1 A
    state.current_mA_q20 = INT64_C(3000) << 20;
    TEST_ASSERT_INT32_WITHIN(5, 1000 + 735, run(&law_fuzzy_selftune, 200)); // e^-1 of 2 A
    TEST_ASSERT_INT32_WITHIN(1, 1000, run(&law_fuzzy_selftune, 3000));
}

// The longest and the shortest leak, at the fastest and the slowest tick, both arrive.
static void test_selftune_leak_arrives_at_both_ends(void) {
    view.body[0].accel_um_s2 = 0;
    params->selftune_leak_ms = 10000;
    params->tick_rate_Hz = 4000;
    state.current_mA_q20 = INT64_C(3000) << 20;
    TEST_ASSERT_INT32_WITHIN(1, 1000, run(&law_fuzzy_selftune, 400000));
    params->selftune_leak_ms = 1;
    params->tick_rate_Hz = 500;
    state.current_mA_q20 = INT64_C(3000) << 20;
    TEST_ASSERT_EQUAL_INT32(1666, run(&law_fuzzy_selftune, 1)); // a third left of 2 A
    TEST_ASSERT_EQUAL_INT32(1000, run(&law_fuzzy_selftune, 30));
}

static void test_selftune_slowest_rate_adds_up(void) {
    params->selftune_rate_mA_s = 3;
    params->tick_rate_Hz = 4000;
    state.current_mA_q20 = INT64_C(1000) << 20;
    TEST_ASSERT_INT32_WITHIN(1, 1030, run(&law_fuzzy_selftune, 40000));
}

static void test_selftune_survives_extreme_parameters(void) {
    params->selftune_rate_mA_s = 100000000;
    params->tick_rate_Hz = 500;
    params->max_current_mA = 20000;
    params->selftune_leak_ms = 1;
    base_mA = 20000;
    for (uint32_t i = 0; i < 100; i++) {
        view.body[0].accel_um_s2 = i % 3 ? INT32_MAX : INT32_MIN;
        const int32_t request_mA = run(&law_fuzzy_selftune, 1);
        TEST_ASSERT_TRUE(request_mA >= 0 && request_mA <= 20000);
    }
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(test_every_label_has_its_law);
    RUN_TEST(test_plain_laws);
    RUN_TEST(test_laws_without_a_frequency_are_at_the_safe_current_at_rest);
    RUN_TEST(test_rest_begins_after_its_time_and_ends_at_once);
    RUN_TEST(test_selftune_follows_table_x);
    RUN_TEST(test_selftune_stays_between_zero_and_the_limit);
    RUN_TEST(test_selftune_leaves_the_base_alone_above_its_frequency_and_unlocked);
    RUN_TEST(test_selftune_without_the_motion_leaves_the_base);
    RUN_TEST(test_selftune_waits_at_the_base_while_the_output_is_off);
    RUN_TEST(test_selftune_deadband_holds);
    RUN_TEST(test_selftune_leak_returns_to_the_base);
    RUN_TEST(test_selftune_leak_arrives_at_both_ends);
    RUN_TEST(test_selftune_slowest_rate_adds_up);
    RUN_TEST(test_selftune_survives_extreme_parameters);
    return UNITY_END();
}
