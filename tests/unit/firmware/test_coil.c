// A coil by its voltage: short, open, and what is neither.
#include "coil.h"

#include "unity.h"

// 2.5 ohm: 1 A needs 2500 mV.
static coil_t coil;

void setUp(void) {
    coil_init(&coil, 2500, 100, 20);
}
void tearDown(void) {}

static bool run(int32_t command_mA, int32_t current_mA, int32_t voltage_mV, uint32_t ticks) {
    bool is_short = false;
    for (uint32_t i = 0; i < ticks; i++) {
        is_short = coil_is_short(&coil, command_mA, current_mA, voltage_mV);
    }
    return is_short;
}

static void test_coil_short_after_its_ticks(void) {
    TEST_ASSERT_FALSE(run(1000, 1000, 624, 19));
    TEST_ASSERT_TRUE(run(1000, 1000, 624, 1));
    setUp();
    TEST_ASSERT_TRUE(run(1000, 1000, -624, 20)); // a driver may be wired either way
    setUp();
    TEST_ASSERT_FALSE(run(1000, 1000, 625, 1000)); // a hot or a cold coil
    TEST_ASSERT_FALSE(run(1000, -1000, 0, 1000));  // not what is commanded: the monitor's
}

static void test_coil_with_little_current_is_not_judged(void) {
    TEST_ASSERT_FALSE(run(199, 199, 0, 1000));
    TEST_ASSERT_TRUE(run(200, 200, 0, 20));
}

static void test_coil_whose_current_moves_is_not_judged(void) {
    TEST_ASSERT_FALSE(run(0, 1000, 0, 1000)); // it falls, against a diode
    TEST_ASSERT_FALSE(run(1101, 1000, 0, 1000));
    TEST_ASSERT_TRUE(run(1100, 1000, 0, 20));
}

static void test_coil_forgets_at_a_quarter_of_the_speed(void) {
    for (uint32_t i = 0; i < 1000; i++) {
        TEST_ASSERT_FALSE(run(1000, 1000, i % 5u == 0 ? 0 : 2500, 1));
    }
    bool is_seen = false;
    for (uint32_t i = 0; i < 1000; i++) {
        is_seen = is_seen || run(1000, 1000, i % 4u == 0 ? 2500 : 0, 1);
    }
    TEST_ASSERT_TRUE(is_seen);
    TEST_ASSERT_FALSE(run(1000, 1000, 2500, 4)); // it has not counted beyond the limit
}

static void test_coil_without_a_resistance_is_never_short(void) {
    coil_init(&coil, 0, 100, 20);
    TEST_ASSERT_FALSE(run(1000, 1000, 0, 1000));
}

static void test_coil_open_has_the_voltage_and_no_current(void) {
    TEST_ASSERT_TRUE(coil_is_open(&coil, 2000, 2500));
    TEST_ASSERT_FALSE(coil_is_open(&coil, 2000, 2499));
    TEST_ASSERT_TRUE(coil_is_open(&coil, 2000, -24000));
}

static void test_coil_at_the_ends_of_its_numbers(void) {
    coil_init(&coil, 1000000, 1, 1);
    TEST_ASSERT_TRUE(run(INT32_MIN, INT32_MIN, 0, 1));
    TEST_ASSERT_FALSE(run(INT32_MIN, INT32_MAX, 0, 2));
    TEST_ASSERT_FALSE(coil_is_open(&coil, INT32_MIN, INT32_MIN));
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(test_coil_short_after_its_ticks);
    RUN_TEST(test_coil_with_little_current_is_not_judged);
    RUN_TEST(test_coil_whose_current_moves_is_not_judged);
    RUN_TEST(test_coil_forgets_at_a_quarter_of_the_speed);
    RUN_TEST(test_coil_without_a_resistance_is_never_short);
    RUN_TEST(test_coil_open_has_the_voltage_and_no_current);
    RUN_TEST(test_coil_at_the_ends_of_its_numbers);
    return UNITY_END();
}
