// A damper takes energy: force and stroke velocity that say otherwise have the wrong sense.
#include "energy.h"

#include "test_signal.h"
#include "unity.h"

static energy_t energy;
static uint32_t seed;

void setUp(void) {
    energy_init(&energy, 1000);
    seed = 5;
}
void tearDown(void) {}

// Share in percent of a viscous force, of an elastic one, and noise of either signal.
static bool run(int32_t viscous, int32_t elastic, int32_t noise, uint32_t ticks) {
    bool is_negative = false;
    for (uint32_t i = 0; i < ticks; i++) {
        const int32_t velocity = signal_sine(20000, 7000, i, 1000);
        const int32_t stroke = signal_sine(20000, 7000, i + 36u, 1000); // a quarter of a cycle
        const int32_t force = velocity / 100 * viscous + stroke / 100 * elastic;
        is_negative = energy_is_negative(&energy, force + signal_noise(&seed, noise),
                                         velocity + signal_noise(&seed, noise), true);
    }
    return is_negative;
}

static void test_energy_of_a_damper_that_damps_is_taken(void) {
    TEST_ASSERT_FALSE(run(100, 0, 1, 20000));
    TEST_ASSERT_FALSE(run(100, 500, 1, 20000));
    TEST_ASSERT_FALSE(run(0, 100, 1, 20000)); // a spring
}

static void test_energy_of_a_wrong_polarity_is_negative_after_some_seconds(void) {
    TEST_ASSERT_FALSE(run(-100, 0, 1, 4096));
    TEST_ASSERT_TRUE(run(-100, 0, 1, 30));
    setUp();
    TEST_ASSERT_TRUE(run(-100, 50, 5000, 5000));
    energy_init(&energy, 500);
    TEST_ASSERT_FALSE(run(-100, 0, 1, 2048));
    TEST_ASSERT_TRUE(run(-100, 0, 1, 30));
}

// A force that begins, and a constant one, against a slow motion.
static void test_energy_of_a_constant_force_is_none(void) {
    for (uint32_t i = 0; i < 60000; i++) {
        const int32_t velocity = -signal_sine(20000, 500, i, 1000);
        TEST_ASSERT_FALSE(energy_is_negative(&energy, i < 5000 ? 0 : 30000, velocity, true));
    }
}

static void test_energy_of_noise_and_of_rest_says_nothing(void) {
    for (uint32_t i = 0; i < 20000; i++) {
        TEST_ASSERT_FALSE(energy_is_negative(&energy, signal_noise(&seed, 1 << 20),
                                             signal_noise(&seed, 1 << 20), true));
    }
    setUp();
    for (uint32_t i = 0; i < 20000; i++) {
        TEST_ASSERT_FALSE(energy_is_negative(&energy, -1, 1, true));
    }
}

static void test_energy_begins_anew_after_a_gap(void) {
    TEST_ASSERT_TRUE(run(-100, 0, 1, 5000));
    TEST_ASSERT_FALSE(energy_is_negative(&energy, -1000000, 1000000, false));
    TEST_ASSERT_FALSE(run(-100, 0, 1, 4096));
    TEST_ASSERT_TRUE(run(-100, 0, 1, 30));
    energy_forget(&energy);
    TEST_ASSERT_FALSE(run(-100, 0, 1, 4096));
}

static void test_energy_forgets_all_of_it(void) {
    (void)run(-100, 0, 1, 3000);
    TEST_ASSERT_TRUE(energy.taken < 0 && energy.moved > 0 && energy.ticks > 0);
    TEST_ASSERT_FALSE(energy_is_negative(&energy, 0, 0, false));
    TEST_ASSERT_TRUE(energy.taken == 0 && energy.moved == 0 && energy.ticks == 0);
}

// The least power below zero is one, as that above is.
static void test_energy_of_the_least_power_counts_as_its_magnitude(void) {
    energy.moved = (1 << energy.shift) - 1;
    (void)energy_is_negative(&energy, -1, 1, true);
    TEST_ASSERT_TRUE(energy.moved == (1 << energy.shift) - 1);
}

static void test_energy_at_the_ends_of_its_numbers(void) {
    const int32_t most = (1 << 30) - 1;
    for (uint32_t i = 0; i < 10000; i++) {
        (void)energy_is_negative(&energy, most, -most, true);
    }
    TEST_ASSERT_TRUE(energy.taken < 0 && energy.moved > 0);
    TEST_ASSERT_TRUE(energy_is_negative(&energy, most, -most, true));
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(test_energy_of_a_damper_that_damps_is_taken);
    RUN_TEST(test_energy_of_a_wrong_polarity_is_negative_after_some_seconds);
    RUN_TEST(test_energy_of_a_constant_force_is_none);
    RUN_TEST(test_energy_of_noise_and_of_rest_says_nothing);
    RUN_TEST(test_energy_begins_anew_after_a_gap);
    RUN_TEST(test_energy_forgets_all_of_it);
    RUN_TEST(test_energy_of_the_least_power_counts_as_its_magnitude);
    RUN_TEST(test_energy_at_the_ends_of_its_numbers);
    return UNITY_END();
}
