#include "position.h"

#include "motion.h"
#include "test_signal.h"
#include "unity.h"

void setUp(void) {}
void tearDown(void) {}

typedef struct {
    int32_t largest_nm;
    uint32_t rise_tick; ///< last rise through 0
} shape_t;

// Ten seconds of a sine velocity, its last second looked at.
static shape_t run(uint32_t rate_Hz, uint32_t freq_mHz, int32_t amp_um_s) {
    position_t position;
    shape_t shape = {0, 0};
    int32_t last_nm = 0;
    position_init(&position, rate_Hz, 500);
    for (uint32_t tick = 0; tick < 10u * rate_Hz; tick++) {
        const int64_t velocity_um_s = signal_sine(amp_um_s, freq_mHz, tick, rate_Hz);
        const int32_t nm = position_step(&position, velocity_um_s * (INT64_C(1) << 32));
        if (tick >= 9u * rate_Hz) {
            shape.largest_nm = nm > shape.largest_nm ? nm : shape.largest_nm;
            shape.rise_tick = last_nm < 0 && nm >= 0 ? tick : shape.rise_tick;
        }
        last_nm = nm;
    }
    return shape;
}

// 10 mm/s at 5 Hz are 318,310 nm, less what the cut-off at 0.5 Hz takes: 1/sqrt(1 + 0.01).
static void test_position_of_a_sine(void) {
    const uint32_t rates_Hz[] = {500, 1000, 2000, 4000};
    for (uint32_t i = 0; i < 4u; i++) {
        TEST_ASSERT_INT32_WITHIN(1500, 316730, run(rates_Hz[i], 5000, 10000).largest_nm);
    }
    TEST_ASSERT_INT32_WITHIN(200, 15914, run(4000, 50000, 5000).largest_nm);
}

// x = -X cos: it rises through 0 a quarter of a cycle after the velocity, earlier by
// atan(0.5 / 5) = 5.7 degrees and half a tick: 50 ms less 3.2 and 0.5 ms.
static void test_position_leads_by_what_it_says(void) {
    const uint32_t in_cycle = run(1000, 5000, 10000).rise_tick % 200u;
    TEST_ASSERT_UINT32_WITHIN(1, 47, in_cycle);
}

static void test_position_saturates_and_comes_back(void) {
    position_t position;
    position_init(&position, 1000, 50);
    for (int32_t sign = -1; sign <= 1; sign += 2) {
        const int64_t fast_q32 = sign * (INT64_C(1073741823) << 16) * (INT64_C(1) << 16);
        for (uint32_t tick = 0; tick < 2000u; tick++) {
            const int32_t nm = position_step(&position, fast_q32);
            TEST_ASSERT_TRUE(nm >= -1073741823 && nm <= 1073741823);
        }
        TEST_ASSERT_EQUAL_INT32(sign * 1073741823, position_step(&position, fast_q32));
    }
    for (uint32_t tick = 0; tick < 100000u; tick++) {
        position_step(&position, 0);
    }
    TEST_ASSERT_INT32_WITHIN(100, 0, position_step(&position, 0));
    position_reset(&position);
    TEST_ASSERT_EQUAL_INT32(0, position_step(&position, 0));
}

// What floors of the velocity add up to.
static void test_position_at_rest_stays_near_rest(void) {
    position_t position;
    position_init(&position, 4000, 500);
    for (uint32_t tick = 0; tick < 400000u; tick++) {
        position_step(&position, tick % 2u == 0 ? 1 : -1);
    }
    TEST_ASSERT_INT32_WITHIN(20, 0, position_step(&position, 0));
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(test_position_of_a_sine);
    RUN_TEST(test_position_leads_by_what_it_says);
    RUN_TEST(test_position_saturates_and_comes_back);
    RUN_TEST(test_position_at_rest_stays_near_rest);
    return UNITY_END();
}
