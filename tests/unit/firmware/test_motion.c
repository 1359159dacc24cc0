#include "motion.h"
#include "test_signal.h"
#include "unity.h"

static motion_t motion;

void setUp(void) {}
void tearDown(void) {}

// a = A sin(wt) gives v = -(A/w) cos(wt), here with the leak's gain and phase.
static void test_velocity_of_a_sine_at_every_rate(void) {
    const uint32_t rates[] = {500, 1000, 2000, 4000};
    for (uint32_t r = 0; r < 4; r++) {
        const uint32_t rate_Hz = rates[r];
        motion_init(&motion, rate_Hz, 500);
        int32_t peak_um_s = 0;
        uint32_t peak_tick = 0;
        for (uint32_t i = 0; i < 4 * rate_Hz; i++) {
            const int64_t v = motion_step(&motion, signal_sine(1000000, 5000, i, rate_Hz));
            if (i >= 3 * rate_Hz + rate_Hz / 5 && i < 3 * rate_Hz + 2 * rate_Hz / 5 &&
                motion_velocity_um_s(v) > peak_um_s) {
                peak_um_s = motion_velocity_um_s(v);
                peak_tick = i % (rate_Hz / 5);
            }
        }
        // 1 m/s2 / (2 pi 5 Hz) = 31831 um/s, x 0.995 for the leak; peak half a period after t = 0,
        // 5.71 degrees (0.0159 of a period) and half a tick early.
        TEST_ASSERT_INT32_WITHIN(160, 31674, peak_um_s);
        TEST_ASSERT_INT32_WITHIN(rate_Hz / 500 + 1, (int32_t)(rate_Hz * 4841 / 50000),
                                 (int32_t)peak_tick);
    }
}

static void test_constant_acceleration_settles_at_a_over_w(void) {
    motion_init(&motion, 1000, 500);
    int64_t v = 0;
    for (uint32_t i = 0; i < 5000; i++) {
        v = motion_step(&motion, 1000000);
    }
    TEST_ASSERT_INT32_WITHIN(320, 318310, motion_velocity_um_s(v));
}

static void test_saturates_instead_of_wrapping(void) {
    motion_init(&motion, 500, 50);
    int64_t v = 0;
    for (uint32_t i = 0; i < 100000; i++) {
        v = motion_step(&motion, 500000000);
        TEST_ASSERT_TRUE(v >= 0);
    }
    TEST_ASSERT_TRUE(motion_velocity_um_s(v) <= 1073741823);
    TEST_ASSERT_TRUE(motion_velocity_um_s(v) > 1000000000);
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(test_velocity_of_a_sine_at_every_rate);
    RUN_TEST(test_constant_acceleration_settles_at_a_over_w);
    RUN_TEST(test_saturates_instead_of_wrapping);
    return UNITY_END();
}
