// How many half cycles that are alike make a lock, and what it follows beside other components.
#include "dominant_lock.h"

#include "law.h"
#include "test_signal.h"
#include "unity.h"

enum { RATE_Hz = 1000, AMP_um_s2 = 300000, SHORT_ms = 130 };

static dominant_lock_state_t lock;
static uint32_t phase; // of the acceleration
static uint32_t freq_mHz;
static predictor_t known; // what the estimator knows
static uint32_t other_phase;
static uint32_t other_mHz;
static int32_t other_um_s2;

static uint32_t step_of(uint32_t mHz) {
    return (uint32_t)(((uint64_t)mHz << 32) / (1000u * RATE_Hz));
}

void setUp(void) {
    phase = 0;
    freq_mHz = 10000;
    known = (predictor_t){0};
    other_phase = 0;
    other_um_s2 = 0;
    dominant_lock.init(&lock, &(dominant_lock_cfg_t){.tick_rate_Hz = RATE_Hz,
                                                     .band_low_mHz = 2000,
                                                     .band_high_mHz = 40000,
                                                     .min_accel_um_s2 = 10000});
}
void tearDown(void) {}

static void step(uint32_t lost_ticks, bool is_published) {
    const int32_t accel_um_s2 =
        signal_cosine(AMP_um_s2, phase) + signal_cosine(other_um_s2, other_phase);
    const condition_out_t sample = {
        .raw = accel_um_s2, .value = accel_um_s2, .flag = CONDITION_GOOD};
    dominant_lock.step(
        &lock, &(dominant_lock_in_t){
                   .sample = &sample,
                   // amplitude / (2 pi f)
                   .velocity_um_s = signal_cosine((int32_t)(AMP_um_s2 * INT64_C(159) / freq_mHz),
                                                  phase - (1u << 30)),
                   .rms_um_s2 = AMP_um_s2 / 2,
                   .lost_ticks = lost_ticks,
                   .known = &known,
                   .has_published = is_published,
                   .is_valid = known.is_armed,
               });
}

// Components run on, the estimator's as the real ones.
static void run_on(uint32_t ticks) {
    phase += ticks * step_of(freq_mHz);
    other_phase += ticks * step_of(other_mHz);
    for (uint32_t i = 0; i < known.tones; i++) {
        known.tone[i].phase_turn += ticks * known.tone[i].step_turn;
    }
}

static void tick(void) {
    run_on(1);
    step(0, false);
}

// The estimator says what there is.
static void publish(uint32_t tones) {
    run_on(1);
    known.tone[0] = (predictor_tone_t){phase, step_of(freq_mHz), AMP_um_s2};
    known.tone[1] = (predictor_tone_t){other_phase, step_of(other_mHz), other_um_s2};
    known.tones = tones;
    known.is_armed = true;
    step(0, true);
    run_on(1);
    step(0, false);
}

// Ticks of a steady vibration until it is locked, or UINT32_MAX.
static uint32_t ticks_until_locked(uint32_t most) {
    for (uint32_t i = 1; i <= most; i++) {
        tick();
        if (lock.in.is_locked) {
            return i;
        }
    }
    return UINT32_MAX;
}

static void run(uint32_t ticks) {
    for (; ticks > 0; ticks--) {
        tick();
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
    publish(1);
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
        tick();
    }
    TEST_ASSERT_LESS_THAN_UINT32(5u * RATE_Hz * 500u / freq_mHz, ticks_until_locked(500));
}

// Ticks of the next n in which it is locked on to the vibration.
static uint32_t locked_ticks(uint32_t ticks) {
    uint32_t locked = 0;
    for (uint32_t i = 0; i < ticks; i++) {
        tick();
        const int32_t off = (int32_t)(lock.in.phase_turn - phase);
        locked += lock.in.is_locked && off < 1 << 28 && off > -(1 << 28) ? 1u : 0u;
    }
    return locked;
}

static void add_other(uint32_t mHz, int32_t um_s2) {
    other_mHz = mHz;
    other_um_s2 = um_s2;
}

// The last two have nine tenths of its acceleration.
static void test_another_component_does_not_end_it(void) {
    static const uint32_t others_mHz[] = {3700, 8100, 13300, 17000};
    static const int32_t tenths[] = {1, 5, 9, 9};
    for (uint32_t i = 0; i < sizeof others_mHz / sizeof *others_mHz; i++) {
        setUp();
        add_other(others_mHz[i], AMP_um_s2 * tenths[i] / 10);
        publish(2);
        TEST_ASSERT_EQUAL_UINT32(4000, locked_ticks(4000));
    }
}

// At 8.1 Hz it displaces 1.524 times as much for its acceleration: 1.31, 1.17, 1.10 and 1.17 times
// what the dominant one does.
static void test_one_that_displaces_more_leaves_no_lock(void) {
    static const int32_t percents[] = {86, 77, 72, 77};
    static const uint32_t locked[] = {0, 0, 1000, 1000};
    for (uint32_t i = 0; i < sizeof percents / sizeof *percents; i++) {
        add_other(8100, AMP_um_s2 / 100 * percents[i]);
        publish(2);
        TEST_ASSERT_EQUAL_UINT32(locked[i], locked_ticks(1000));
    }
}

static void test_without_knowing_it_the_lock_is_lost(void) {
    add_other(8100, AMP_um_s2 * 9 / 10);
    publish(1);
    TEST_ASSERT_LESS_THAN_UINT32(3000, locked_ticks(4000));
}

static void test_what_is_not_known_any_more_is_not_taken_off(void) {
    add_other(8100, AMP_um_s2 * 6 / 10);
    publish(2);
    other_um_s2 = 0; // it ends, and the estimator has seen it
    known.is_armed = false;
    TEST_ASSERT_EQUAL_UINT32(4000, locked_ticks(4000));
}

static void test_the_third_harmonic_is_the_components_own(void) {
    add_other(30000, AMP_um_s2 / 3);
    publish(2);
    TEST_ASSERT_EQUAL_UINT32(2000, locked_ticks(2000));
    const int32_t third_um_s2 = lock.in.found.um_s2[HARMONIC_COS3];
    const int32_t across_um_s2 = lock.in.found.um_s2[HARMONIC_SIN3];
    const uint32_t amp_um_s2 = harmonic_amp_um_s2(third_um_s2, across_um_s2);
    TEST_ASSERT_UINT32_WITHIN(AMP_um_s2 / 60, AMP_um_s2 / 3, amp_um_s2);
}

static void test_one_lost_tick_in_a_hundred_ends_nothing(void) {
    publish(1);
    for (uint32_t i = 0; i < 40; i++) {
        TEST_ASSERT_EQUAL_UINT32(97, locked_ticks(97));
        run_on(2);
        step(1, false);
    }
}

static void test_half_cycles_make_a_lock_through_lost_ticks(void) {
    uint32_t ticks = 0;
    while (!lock.in.is_locked && ticks < 1000) {
        run_on(2);
        step(1, false);
        ticks += 2;
        for (uint32_t i = 0; i < 30 && !lock.in.is_locked; i++, ticks++) {
            tick();
        }
    }
    TEST_ASSERT_LESS_THAN_UINT32(1000, ticks);
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(test_the_first_lock_takes_five_half_cycles_that_are_alike);
    RUN_TEST(test_each_lock_that_does_not_last_makes_the_next_twice_as_hard);
    RUN_TEST(test_the_estimator_locks_then_and_half_cycles_may_again);
    RUN_TEST(test_after_a_lock_that_lasted_three_half_cycles_make_the_next);
    RUN_TEST(test_another_component_does_not_end_it);
    RUN_TEST(test_one_that_displaces_more_leaves_no_lock);
    RUN_TEST(test_without_knowing_it_the_lock_is_lost);
    RUN_TEST(test_what_is_not_known_any_more_is_not_taken_off);
    RUN_TEST(test_the_third_harmonic_is_the_components_own);
    RUN_TEST(test_one_lost_tick_in_a_hundred_ends_nothing);
    RUN_TEST(test_half_cycles_make_a_lock_through_lost_ticks);
    return UNITY_END();
}
