#include "law_state.h"

#include <stddef.h>
#include <string.h>

#include "unity.h"

static quiesce_params_t params;
static law_state_t state;
static law_in_t in;

void setUp(void) {
    quiesce_params_default(&params);
    state = (law_state_t){0};
    in = (law_in_t){
        .velocity_um_s_q32 = INT64_C(1000) << 32,
        .accel_um_s2 = 20000,
        .freq_uHz = 5000000,
        .freq_is_valid = true,
        .base_mA = 1000,
    };
}
void tearDown(void) {}

static int32_t run(const law_t *law, uint32_t ticks) {
    int32_t request_mA = 0;
    for (uint32_t i = 0; i < ticks; i++) {
        request_mA = law->step(&state, &params, &in);
    }
    return request_mA;
}

static void test_every_label_has_its_law(void) {
    for (uint32_t i = 0; i < QUIESCE_PARAM_COUNT; i++) {
        const quiesce_param_info_t *info = quiesce_param_info(i);
        if (strcmp(info->name, "law") == 0) {
            TEST_ASSERT_EQUAL_INT32(QUIESCE_LAW_PHASE, info->max);
            for (int32_t value = 0; value <= info->max; value++) {
                TEST_ASSERT_NOT_NULL(law_find(value));
                TEST_ASSERT_EQUAL_STRING(info->labels[value], law_find(value)->name);
            }
        }
    }
    TEST_ASSERT_NULL(law_find(-1));
    TEST_ASSERT_NULL(law_find(QUIESCE_LAW_PHASE + 1));
}

static void test_plain_laws(void) {
    params.constant_current_mA = 1234;
    TEST_ASSERT_EQUAL_INT32(0, run(&law_off, 3));
    TEST_ASSERT_EQUAL_INT32(1234, run(&law_constant, 3));
    TEST_ASSERT_EQUAL_INT32(1000, run(&law_fuzzy, 3));
}

// Table X: rows of signs, printed polarity and reversed.
static void test_selftune_follows_table_x(void) {
    const struct {
        int32_t accel_sign, velocity_sign, direction;
    } rows[] = {{1, 1, 1}, {1, -1, -1}, {-1, 1, -1}, {-1, -1, 1}, {0, 1, 0}, {1, 0, 0}};
    for (uint32_t i = 0; i < sizeof rows / sizeof rows[0]; i++) {
        for (int32_t polarity = -1; polarity <= 1; polarity += 2) {
            params.selftune_polarity = polarity;
            state.selftune_mA_q20 = INT64_C(2000) << 20;
            in.accel_um_s2 = 20000 * rows[i].accel_sign;
            in.velocity_um_s_q32 = 1 * rows[i].velocity_sign;
            // 200 A/s at 1 kHz is 200 mA a tick.
            TEST_ASSERT_EQUAL_INT32(2000 + 200 * rows[i].direction * polarity,
                                    run(&law_fuzzy_selftune, 1));
        }
    }
}

static void test_selftune_stays_between_zero_and_the_limit(void) {
    TEST_ASSERT_EQUAL_INT32(5000, run(&law_fuzzy_selftune, 1000));
    in.accel_um_s2 = -in.accel_um_s2;
    TEST_ASSERT_EQUAL_INT32(0, run(&law_fuzzy_selftune, 1000));
}

static void test_selftune_leaves_the_base_alone_above_its_frequency_and_unlocked(void) {
    params.selftune_upper_mHz = 7500;
    in.freq_uHz = 7500000;
    TEST_ASSERT_EQUAL_INT32(1000, run(&law_fuzzy_selftune, 5));
    in.freq_uHz = 7499000;
    TEST_ASSERT_EQUAL_INT32(1200, run(&law_fuzzy_selftune, 1));
    in.freq_is_valid = false;
    in.base_mA = 5000;
    TEST_ASSERT_EQUAL_INT32(5000, run(&law_fuzzy_selftune, 1));
}

static void test_selftune_deadband_holds(void) {
    params.selftune_deadband_um_s2 = 30000;
    state.selftune_mA_q20 = INT64_C(1500) << 20;
    TEST_ASSERT_EQUAL_INT32(1500, run(&law_fuzzy_selftune, 100));
}

static void test_selftune_leak_returns_to_the_base(void) {
    params.selftune_leak_ms = 200;
    in.accel_um_s2 = 0; // no drive: pure decay from 3 A to 1 A
    state.selftune_mA_q20 = INT64_C(3000) << 20;
    TEST_ASSERT_INT32_WITHIN(5, 1000 + 735, run(&law_fuzzy_selftune, 200)); // e^-1 of 2 A
    TEST_ASSERT_INT32_WITHIN(1, 1000, run(&law_fuzzy_selftune, 3000));
}

// The longest and the shortest leak, at the fastest and the slowest tick, both arrive.
static void test_selftune_leak_arrives_at_both_ends(void) {
    in.accel_um_s2 = 0;
    params.selftune_leak_ms = 10000;
    params.tick_rate_Hz = 4000;
    state.selftune_mA_q20 = INT64_C(3000) << 20;
    TEST_ASSERT_INT32_WITHIN(1, 1000, run(&law_fuzzy_selftune, 400000));
    params.selftune_leak_ms = 1;
    params.tick_rate_Hz = 500;
    state.selftune_mA_q20 = INT64_C(3000) << 20;
    TEST_ASSERT_EQUAL_INT32(1666, run(&law_fuzzy_selftune, 1)); // a third left of 2 A
    TEST_ASSERT_EQUAL_INT32(1000, run(&law_fuzzy_selftune, 30));
}

static void test_selftune_slowest_rate_adds_up(void) {
    params.selftune_rate_mA_s = 3;
    params.tick_rate_Hz = 4000;
    state.selftune_mA_q20 = INT64_C(1000) << 20;
    TEST_ASSERT_INT32_WITHIN(1, 1030, run(&law_fuzzy_selftune, 40000));
}

static void test_selftune_survives_extreme_parameters(void) {
    params.selftune_rate_mA_s = 100000000;
    params.tick_rate_Hz = 500;
    params.max_current_mA = 20000;
    params.selftune_leak_ms = 1;
    in.base_mA = 20000;
    for (uint32_t i = 0; i < 100; i++) {
        in.accel_um_s2 = i % 3 ? INT32_MAX : INT32_MIN;
        const int32_t request_mA = run(&law_fuzzy_selftune, 1);
        TEST_ASSERT_TRUE(request_mA >= 0 && request_mA <= 20000);
    }
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(test_every_label_has_its_law);
    RUN_TEST(test_plain_laws);
    RUN_TEST(test_selftune_follows_table_x);
    RUN_TEST(test_selftune_stays_between_zero_and_the_limit);
    RUN_TEST(test_selftune_leaves_the_base_alone_above_its_frequency_and_unlocked);
    RUN_TEST(test_selftune_deadband_holds);
    RUN_TEST(test_selftune_leak_returns_to_the_base);
    RUN_TEST(test_selftune_leak_arrives_at_both_ends);
    RUN_TEST(test_selftune_slowest_rate_adds_up);
    RUN_TEST(test_selftune_survives_extreme_parameters);
    return UNITY_END();
}
