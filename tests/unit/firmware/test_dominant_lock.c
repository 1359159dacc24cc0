// How many half cycles that are alike make a lock.
#include "dominant_lock.h"

#include <stddef.h>

#include "law.h"
#include "test_signal.h"
#include "unity.h"

enum { RATE_Hz = 1000, AMP_um_s2 = 300000, SHORT_ms = 130 };

static dominant_lock_state_t lock;
static uint32_t phase; // of the acceleration
static uint32_t freq_mHz;

static uint32_t step_of(uint32_t mHz) {
    return (uint32_t)(((uint64_t)mHz << 32) / (1000u * RATE_Hz));
}

void setUp(void) {
    phase = 0;
    freq_mHz = 10000;
    dominant_lock_init(&lock, RATE_Hz, step_of(2000), step_of(40000), 10000);
}
void tearDown(void) {}

static void tick(const predictor_tone_t *tone) {
    phase += step_of(freq_mHz);
    const condition_out_t sample = {.raw = signal_cosine(AMP_um_s2, phase),
                                    .value = signal_cosine(AMP_um_s2, phase),
                                    .flag = CONDITION_GOOD};
    dominant_lock.step(
        &lock, &(dominant_lock_in_t){
                   .sample = &sample,
                   // amplitude / (2 pi f)
                   .velocity_um_s = signal_cosine((int32_t)(AMP_um_s2 * INT64_C(159) / freq_mHz),
                                                  phase - (1u << 30)),
                   .rms_um_s2 = AMP_um_s2 / 2,
                   .tone = tone,
               });
}

// Ticks of a steady vibration until it is locked, or UINT32_MAX.
static uint32_t ticks_until_locked(uint32_t most) {
    for (uint32_t i = 1; i <= most; i++) {
        tick(NULL);
        if (lock.in.is_locked) {
            return i;
        }
    }
    return UINT32_MAX;
}

static void run(uint32_t ticks) {
    for (; ticks > 0; ticks--) {
        tick(NULL);
    }
}

// The vibration turns into another one: the phase jumps at once.
static void jump(uint32_t mHz) {
    freq_mHz = mHz;
    phase += 1u << 31;
}

static void lose_at_once(void) {
    TEST_ASSERT_LESS_THAN_UINT32(500, ticks_until_locked(500));
    run(SHORT_ms);
    jump(23000);
    run(SHORT_ms);
    TEST_ASSERT_FALSE(lock.in.is_locked);
}

static void test_the_first_lock_takes_five_half_cycles_that_are_alike(void) {
    const uint32_t half_ticks = RATE_Hz * 500u / freq_mHz;
    const uint32_t ticks = ticks_until_locked(1000);
    TEST_ASSERT_GREATER_THAN_UINT32(5u * half_ticks, ticks);
    TEST_ASSERT_LESS_THAN_UINT32(8u * half_ticks, ticks);
}

static void test_each_lock_that_does_not_last_makes_the_next_twice_as_hard(void) {
    lose_at_once();
    for (uint32_t alike = 6; alike <= 96; alike *= 2) {
        const uint32_t ticks =
            ticks_until_locked(20000) + SHORT_ms; // they are alike since the jump
        const uint32_t half_ticks = RATE_Hz * 500u / freq_mHz;
        TEST_ASSERT_GREATER_THAN_UINT32((alike + 1u) * half_ticks, ticks);
        TEST_ASSERT_LESS_THAN_UINT32((alike + 6u) * (half_ticks + 1u), ticks);
        run(SHORT_ms);
        jump(freq_mHz + 3000u);
        run(SHORT_ms);
        TEST_ASSERT_FALSE(lock.in.is_locked);
    }
}

static void test_the_estimator_locks_then_and_half_cycles_may_again(void) {
    lose_at_once();
    tick(&(predictor_tone_t){.phase_turn = phase + step_of(freq_mHz),
                             .step_turn = step_of(freq_mHz),
                             .amp_um_s2 = AMP_um_s2});
    TEST_ASSERT_TRUE(lock.in.is_locked);
    run(SHORT_ms);
    jump(10000);
    TEST_ASSERT_LESS_THAN_UINT32(500, ticks_until_locked(500));
}

static void test_after_a_lock_that_lasted_three_half_cycles_make_the_next(void) {
    TEST_ASSERT_LESS_THAN_UINT32(500, ticks_until_locked(500));
    run(2000);
    TEST_ASSERT_TRUE(lock.in.is_locked);
    jump(23000);
    while (lock.in.is_locked) {
        tick(NULL);
    }
    TEST_ASSERT_LESS_THAN_UINT32(5u * RATE_Hz * 500u / freq_mHz, ticks_until_locked(500));
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(test_the_first_lock_takes_five_half_cycles_that_are_alike);
    RUN_TEST(test_each_lock_that_does_not_last_makes_the_next_twice_as_hard);
    RUN_TEST(test_the_estimator_locks_then_and_half_cycles_may_again);
    RUN_TEST(test_after_a_lock_that_lasted_three_half_cycles_make_the_next);
    return UNITY_END();
}
