#include "lock_in.h"

#include "test_signal.h"
#include "unity.h"

enum {
    AMP_um_s2 = 300000,
    NOISE_um_s2 = 4900, // 0.5 mg
    DEGREE_TURN = 11930465,
};

// What the sensor sees: a fundamental, its third harmonic, a ring that dies away, a constant.
typedef struct {
    uint32_t rate_Hz;
    uint32_t phase;
    uint32_t step;
    int32_t amp;
    int32_t third;
    uint32_t third_turn;
    int32_t constant;
    int32_t noise;
    int32_t ring;
    uint32_t ring_phase;
    uint32_t ring_step;
    uint32_t seed;
} motion_t;

static motion_t motion;
static lock_in_t lock;
static bool is_good;

static uint32_t step_of(uint32_t freq_mHz) {
    return (uint32_t)(((uint64_t)freq_mHz << 32) / (1000u * motion.rate_Hz));
}

static void start(uint32_t rate_Hz, uint32_t freq_mHz) {
    motion = (motion_t){
        .rate_Hz = rate_Hz, .amp = AMP_um_s2, .noise = NOISE_um_s2, .seed = 2, .phase = 987654321u};
    motion.step = step_of(freq_mHz);
    motion.ring_step = step_of(96000);
    is_good = true;
    lock_in_init(&lock);
}

static void acquire(void) {
    lock_in_acquire(&lock, motion.phase, motion.step, motion.constant);
}

void setUp(void) {
    start(1000, 10000);
}
void tearDown(void) {}

static int32_t sample(void) {
    motion.phase += motion.step;
    motion.ring_phase += motion.ring_step;
    motion.ring -= motion.ring / (int32_t)(motion.rate_Hz / 20u); // 50 ms
    return signal_cosine(motion.amp, motion.phase) +
           signal_cosine(motion.third, 3u * motion.phase + motion.third_turn) +
           signal_cosine(motion.ring, motion.ring_phase) + motion.constant +
           signal_normal(&motion.seed, motion.noise);
}

static void tick(void) {
    lock_in_step(&lock, sample(), is_good, true);
}

static uint32_t phase_error_turn(void) {
    return (uint32_t)abs_i32((int32_t)(lock.phase_turn - motion.phase));
}

// Runs on; the largest phase error, in thousandths of a degree; locked throughout.
static uint32_t worst_error_mdeg(uint32_t time_ms) {
    uint32_t worst = 0;
    for (uint32_t i = 0; i < time_ms * motion.rate_Hz / 1000u; i++) {
        tick();
        worst = phase_error_turn() > worst ? phase_error_turn() : worst;
    }
    TEST_ASSERT_TRUE(lock.is_locked);
    return worst / (DEGREE_TURN / 1000u);
}

// Ticks of half cycles at the frequency that the motion has.
static uint32_t half_cycles(uint32_t count) {
    return (uint32_t)(((uint64_t)count << 31) / motion.step);
}

static void run(uint32_t ticks) {
    for (; ticks > 0; ticks--) {
        tick();
    }
}

static void settle(void) {
    acquire();
    run(half_cycles(12));
    TEST_ASSERT_TRUE(lock.is_locked);
}

// Settled, then on by a part of a cycle: so many parts make a cycle.
enum { PARTS = 7 };
static void settle_to_part(uint32_t part) {
    settle();
    run(half_cycles(2u) * part / PARTS);
}

static uint32_t ticks_until_lost(uint32_t most_ticks) {
    uint32_t ticks = 0;
    for (; lock.is_locked && ticks < most_ticks; ticks++) {
        tick();
    }
    return ticks;
}

static const uint32_t rates_Hz[] = {500, 1000, 2000, 4000};
static const uint32_t freqs_mHz[] = {1000, 4000, 5000, 7300, 10000, 15000, 20000, 22000, 50000};

// --- holding on

static void test_lock_in_holds_a_component_at_every_rate(void) {
    for (uint32_t r = 0; r < 4u; r++) {
        for (uint32_t f = 0; f < 9u; f++) {
            start(rates_Hz[r], freqs_mHz[f]);
            settle();
            TEST_ASSERT_LESS_THAN_UINT32(4000, worst_error_mdeg(500));
            TEST_ASSERT_UINT32_WITHIN(motion.step / 200u, motion.step, lock.step_turn);
        }
    }
}

static void test_lock_in_pulls_in_a_rough_start(void) {
    for (int32_t degrees = -20; degrees <= 20; degrees += 10) {
        for (int32_t percent = -4; percent <= 4; percent += 4) {
            for (uint32_t f = 1; f < 7u; f++) {
                start(1000, freqs_mHz[f]);
                lock_in_acquire(&lock, motion.phase + (uint32_t)(degrees * DEGREE_TURN),
                                motion.step + (uint32_t)((int32_t)motion.step / 100 * percent), 0);
                run(half_cycles(16));
                TEST_ASSERT_LESS_THAN_UINT32(4000, worst_error_mdeg(300));
            }
        }
    }
}

static void test_lock_in_tells_each_half_cycle_once_and_what_it_held(void) {
    motion.third = AMP_um_s2 / 4;
    settle();
    uint32_t halves = 0;
    uint32_t ticks = 0;
    for (uint32_t i = 0; i < 1000u; i++) { // 20 half cycles
        tick();
        if (lock.has_half) {
            halves++;
            ticks += lock.last.ticks;
            const uint32_t amp = harmonic_amp_um_s2(harmonic_part_um_s2(&lock.last, HARMONIC_COS1),
                                                    harmonic_part_um_s2(&lock.last, HARMONIC_SIN1));
            TEST_ASSERT_UINT32_WITHIN(AMP_um_s2 / 25, AMP_um_s2, amp); // ends at a tick
            TEST_ASSERT_INT32_WITHIN(AMP_um_s2 / 25, AMP_um_s2 / 4,
                                     harmonic_part_um_s2(&lock.last, HARMONIC_COS3));
        }
    }
    TEST_ASSERT_EQUAL_UINT32(20, halves);
    TEST_ASSERT_UINT32_WITHIN(3, 1000, ticks);
}

// Smallest and largest: 300 um/s2 is a sixteenth of the noise that a sensor has.
static void test_lock_in_holds_any_size(void) {
    const int32_t amps[] = {300, 5000, 65535, 65536, 10000000, HARMONICS_LARGEST_um_s2 / 100 * 97};
    for (uint32_t i = 0; i < 6u; i++) {
        setUp();
        motion.amp = amps[i];
        motion.noise = amps[i] / 200;
        settle();
        TEST_ASSERT_LESS_THAN_UINT32(1500, worst_error_mdeg(500));
        TEST_ASSERT_UINT32_WITHIN((uint32_t)amps[i] / 50u, (uint32_t)amps[i], lock.amp_um_s2);
    }
}

// --- changes of amplitude and frequency

static void test_lock_in_follows_a_change_of_amplitude(void) {
    const int32_t percents[] = {70, 85, 115, 130};
    for (uint32_t i = 0; i < 4u; i++) {
        for (uint32_t part = 0; part < PARTS; part++) {
            setUp();
            settle_to_part(part);
            motion.amp = AMP_um_s2 / 100 * percents[i];
            TEST_ASSERT_LESS_THAN_UINT32(8000, worst_error_mdeg(500));
            TEST_ASSERT_LESS_THAN_UINT32(2500, worst_error_mdeg(300));
            TEST_ASSERT_UINT32_WITHIN((uint32_t)motion.amp / 50u, (uint32_t)motion.amp,
                                      lock.amp_um_s2);
        }
    }
}

// Ten times in two seconds, up and down again.
static void test_lock_in_follows_a_growth_and_a_decay(void) {
    settle();
    for (uint32_t i = 0; i < 4000u; i++) {
        motion.amp = (int32_t)((int64_t)motion.amp * (i < 2000u ? 100115 : 99885) / 100000);
        tick();
        TEST_ASSERT_TRUE(lock.is_locked);
        TEST_ASSERT_LESS_THAN_UINT32(5u * DEGREE_TURN, phase_error_turn());
    }
}

static uint32_t kept_after_growth(int32_t amp) {
    uint32_t kept = 0;
    for (uint32_t part = 0; part < PARTS; part++) {
        for (int32_t percent = 120; percent <= 170; percent += 15) {
            setUp();
            motion.amp = amp;
            motion.noise = 0;
            settle_to_part(part);
            motion.amp = amp / 100 * percent;
            run(250);
            kept += lock.is_locked ? 1u : 0u;
        }
    }
    return kept;
}

// What it follows does not depend on the size: 2^16 and 2^17 lie between these.
static void test_lock_in_follows_growth_at_any_size_alike(void) {
    const uint32_t kept = kept_after_growth(38000);
    TEST_ASSERT_GREATER_THAN_UINT32(2 * PARTS, kept);
    for (int32_t amp = 46000; amp < 130000; amp += 12000) {
        TEST_ASSERT_UINT32_WITHIN(2, kept, kept_after_growth(amp));
    }
}

// 0.5 Hz/s. The error is what a half cycle's change of frequency makes: least at high frequencies.
static void test_lock_in_follows_a_sweep(void) {
    for (int32_t sign = -1; sign <= 1; sign += 2) {
        start(1000, sign > 0 ? 4000 : 22000);
        settle();
        for (uint32_t uHz = 0; uHz < 18000000u; uHz += 500u) {
            const uint32_t freq_mHz = sign > 0 ? 4000u + uHz / 1000u : 22000u - uHz / 1000u;
            motion.step = step_of(freq_mHz);
            tick();
            TEST_ASSERT_TRUE(lock.is_locked);
            TEST_ASSERT_LESS_THAN_UINT32((freq_mHz < 8000u ? 22u : 6u) * DEGREE_TURN,
                                         phase_error_turn());
        }
    }
}

// --- letting go

static void test_lock_in_lets_go_within_a_cycle_where_the_frequency_steps(void) {
    const uint32_t steps_mHz[][2] = {{5000, 10000}, {10000, 20000}, {20000, 5000}, {10000, 5000}};
    for (uint32_t i = 0; i < 4u; i++) {
        for (uint32_t r = 0; r < 4u; r++) {
            for (uint32_t part = 0; part < PARTS; part++) {
                start(rates_Hz[r], steps_mHz[i][0]);
                settle_to_part(part);
                const uint32_t cycle = half_cycles(2);
                motion.step = step_of(steps_mHz[i][1]);
                TEST_ASSERT_LESS_THAN_UINT32(cycle * 8u / 10u, ticks_until_lost(cycle));
            }
        }
    }
}

static void test_lock_in_lets_go_where_the_phase_jumps_or_the_motion_ends(void) {
    for (uint32_t part = 0; part < PARTS; part++) {
        for (uint32_t degrees = 90; degrees <= 180u; degrees += 30u) {
            setUp();
            settle_to_part(part);
            motion.phase += degrees * DEGREE_TURN;
            TEST_ASSERT_LESS_THAN_UINT32(half_cycles(2), ticks_until_lost(1000));
        }
        for (int32_t left = 0; left <= 20; left += 10) { // below a quarter
            setUp();
            settle_to_part(part);
            motion.amp = AMP_um_s2 / 100 * left;
            TEST_ASSERT_LESS_THAN_UINT32(half_cycles(3), ticks_until_lost(1000));
        }
    }
}

// More than 60 degrees off at once: the first half cycle tells.
static void test_lock_in_gives_a_wrong_start_up(void) {
    for (uint32_t degrees = 100; degrees <= 260u; degrees += 20u) {
        setUp();
        lock_in_acquire(&lock, motion.phase + degrees * DEGREE_TURN, motion.step, 0);
        TEST_ASSERT_LESS_THAN_UINT32(half_cycles(1) + 12u, ticks_until_lost(1000));
        TEST_ASSERT_FALSE(lock.has_half);
    }
}

// Rests until it is told what to hold; a release is at once.
static void test_lock_in_unlocked_does_nothing(void) {
    run(500);
    TEST_ASSERT_FALSE(lock.is_locked);
    TEST_ASSERT_FALSE(lock.has_half);
    settle();
    lock_in_release(&lock);
    TEST_ASSERT_FALSE(lock.is_locked);
    const uint32_t phase_turn = lock.phase_turn;
    for (uint32_t i = 0; i < 500u; i++) {
        tick();
        TEST_ASSERT_FALSE(lock.is_locked);
        TEST_ASSERT_FALSE(lock.has_half);
    }
    TEST_ASSERT_EQUAL_UINT32(phase_turn, lock.phase_turn);
    settle();
    TEST_ASSERT_LESS_THAN_UINT32(2500, worst_error_mdeg(300));
}

// --- what must not matter

static void test_lock_in_keeps_on_through_changes_of_the_third_harmonic(void) {
    for (int32_t tenths = 1; tenths <= 5; tenths++) {
        for (uint32_t part = 0; part < PARTS; part++) {
            start(1000, 5000);
            settle_to_part(part);
            motion.third = AMP_um_s2 / 10 * tenths;
            motion.third_turn = part * 77u * DEGREE_TURN;
            TEST_ASSERT_LESS_THAN_UINT32(2000u * (uint32_t)tenths, worst_error_mdeg(800));
            TEST_ASSERT_LESS_THAN_UINT32(2500, worst_error_mdeg(200));
        }
    }
}

// Of a higher mode, as large as the motion, dying away in 50 ms.
static void test_lock_in_keeps_on_through_a_ring_of_96_Hz(void) {
    for (uint32_t r = 0; r < 4u; r++) {
        for (uint32_t part = 0; part < PARTS; part++) {
            start(rates_Hz[r], 10000);
            settle_to_part(part);
            motion.ring = AMP_um_s2;
            motion.ring_phase = part * 50u * DEGREE_TURN;
            TEST_ASSERT_LESS_THAN_UINT32(7000, worst_error_mdeg(500));
            TEST_ASSERT_LESS_THAN_UINT32(2500, worst_error_mdeg(300));
        }
    }
}

// A held sample's value is not looked at.
static void test_lock_in_keeps_on_through_held_samples(void) {
    const uint32_t held[] = {1, 7, 50, 200};
    for (uint32_t i = 0; i < 4u; i++) {
        setUp();
        settle_to_part(i);
        for (uint32_t k = 0; k < held[i]; k++) {
            (void)sample();
            lock_in_step(&lock, HARMONICS_LARGEST_um_s2 - 1, false, true);
        }
        TEST_ASSERT_LESS_THAN_UINT32(3000, worst_error_mdeg(500));
    }
}

// Known: of any size. Known roughly: to 8 % of the amplitude; it is learnt.
// At any point of the cycle, in a row or one now and then.
static void test_lock_in_turns_on_through_lost_ticks(void) {
    for (uint32_t part = 0; part < PARTS; part++) {
        start(1000, 10000);
        settle_to_part(part);
        for (uint32_t i = 0; i < LOCK_IN_MOST_SKIPPED; i++) {
            (void)sample();
        }
        lock_in_skip(&lock, LOCK_IN_MOST_SKIPPED);
        TEST_ASSERT_LESS_THAN_UINT32(1500, worst_error_mdeg(1000));
        for (uint32_t i = 0; i < 30u; i++) {
            (void)sample();
            lock_in_skip(&lock, 1);
            TEST_ASSERT_LESS_THAN_UINT32(1500, worst_error_mdeg(37));
        }
    }
}

static void test_lock_in_lets_go_after_more_lost_ticks(void) {
    settle();
    lock_in_skip(&lock, LOCK_IN_MOST_SKIPPED + 1u);
    TEST_ASSERT_FALSE(lock.is_locked);
    settle();
    lock_in_skip(&lock, UINT32_MAX);
    TEST_ASSERT_FALSE(lock.is_locked);
}

static void test_lock_in_does_not_mind_a_constant(void) {
    for (int32_t sign = -1; sign <= 1; sign += 2) {
        setUp();
        motion.constant = sign * 9806650; // gravity
        settle();
        TEST_ASSERT_LESS_THAN_UINT32(2500, worst_error_mdeg(500));
        for (uint32_t part = 0; part < PARTS; part++) {
            setUp();
            motion.phase = part * (UINT32_MAX / PARTS);
            motion.constant = sign * (9806650 + AMP_um_s2 / 100 * 8);
            lock_in_acquire(&lock, motion.phase, motion.step, sign * 9806650);
            run(1500);
            TEST_ASSERT_LESS_THAN_UINT32(2500, worst_error_mdeg(300));
            TEST_ASSERT_INT32_WITHIN(AMP_um_s2 / 100, motion.constant, lock.mean_um_s2);
        }
    }
}

// Anything within its format, at any time: the sanitizers look on.
static void test_lock_in_survives_any_input(void) {
    uint32_t seed = 12;
    uint32_t locked = 0;
    for (uint32_t i = 0; i < 60000u; i++) {
        const int32_t kind = abs_i32(signal_noise(&seed, 999));
        if (kind < 5 || i % 15000u == 0) {
            const int32_t loud = kind * 10000 + 1;
            start(rates_Hz[i / 15000u], 1000u + 59u * (uint32_t)kind * 10u % 59000u);
            motion.amp = loud;
            acquire();
        }
        const int32_t any = signal_noise(&seed, HARMONICS_LARGEST_um_s2 - 1);
        const int32_t accel = kind < 20 ? any : sample();
        lock_in_step(&lock, accel, kind % 11 != 0, kind % 7 != 0);
        locked += lock.is_locked ? 1u : 0u;
    }
    TEST_ASSERT_GREATER_THAN_UINT32(1000, locked);
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(test_lock_in_holds_a_component_at_every_rate);
    RUN_TEST(test_lock_in_pulls_in_a_rough_start);
    RUN_TEST(test_lock_in_tells_each_half_cycle_once_and_what_it_held);
    RUN_TEST(test_lock_in_holds_any_size);
    RUN_TEST(test_lock_in_follows_a_change_of_amplitude);
    RUN_TEST(test_lock_in_follows_a_growth_and_a_decay);
    RUN_TEST(test_lock_in_follows_growth_at_any_size_alike);
    RUN_TEST(test_lock_in_follows_a_sweep);
    RUN_TEST(test_lock_in_lets_go_within_a_cycle_where_the_frequency_steps);
    RUN_TEST(test_lock_in_lets_go_where_the_phase_jumps_or_the_motion_ends);
    RUN_TEST(test_lock_in_gives_a_wrong_start_up);
    RUN_TEST(test_lock_in_unlocked_does_nothing);
    RUN_TEST(test_lock_in_keeps_on_through_changes_of_the_third_harmonic);
    RUN_TEST(test_lock_in_keeps_on_through_a_ring_of_96_Hz);
    RUN_TEST(test_lock_in_keeps_on_through_held_samples);
    RUN_TEST(test_lock_in_turns_on_through_lost_ticks);
    RUN_TEST(test_lock_in_lets_go_after_more_lost_ticks);
    RUN_TEST(test_lock_in_does_not_mind_a_constant);
    RUN_TEST(test_lock_in_survives_any_input);
    return UNITY_END();
}
