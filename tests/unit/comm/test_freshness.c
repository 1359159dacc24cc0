// Which frames of a row count: repeated, delayed, inserted, reordered, lost and bursting ones, of a
// message of 10 ms with a timeout of 50 ms, like CurrentMeasured, in ticks of 1 ms.
#include "freshness.h"
#include "unity.h"

#define MS 1000
#define CYCLE_ms 10u
#define TIMEOUT_ms 50u

static freshness_t row;

void setUp(void) {
    row = (freshness_t){0};
    freshness_use(&row, 10 * MS, 50 * MS);
}

void tearDown(void) {}

static freshness_verdict_t take(uint32_t alive) {
    return freshness_judge(&row, (uint8_t)(alive % 16u), alive % 16u);
}

static freshness_verdict_t take_other(uint32_t alive) {
    return freshness_judge(&row, (uint8_t)(alive % 16u), 0xA5);
}

static void pass_ms(uint32_t time_ms) {
    for (uint32_t i = 0; i < time_ms; i++) {
        freshness_pass(&row, MS);
    }
}

// Frames 0 .. count - 1, each on time; the next one is `count`, a cycle later.
static void run(uint32_t count) {
    for (uint32_t i = 0; i < count; i++) {
        (void)take(i);
        pass_ms(CYCLE_ms);
    }
}

// Milliseconds until it is unknown.
static uint32_t known_ms(void) {
    uint32_t time_ms = 0;
    while (freshness_is_known(&row) && time_ms < 1000u) {
        freshness_pass(&row, MS);
        time_ms++;
    }
    return time_ms;
}

static void check_unknown(void) {
    TEST_ASSERT_FALSE(freshness_is_known(&row));
}

static void test_a_sender_counts_from_its_third_frame_on(void) {
    check_unknown();
    TEST_ASSERT_EQUAL(FRESHNESS_BEGINS, take(13));
    pass_ms(10);
    TEST_ASSERT_EQUAL(FRESHNESS_ON_TRIAL, take(14));
    check_unknown();
    pass_ms(10);
    TEST_ASSERT_EQUAL(FRESHNESS_COUNTS, take(15));
    for (uint32_t i = 16; i < 50; i++) {
        pass_ms(10);
        TEST_ASSERT_EQUAL(FRESHNESS_COUNTS, take(i));
    }
    TEST_ASSERT_EQUAL_UINT32(TIMEOUT_ms + 1u, known_ms());
}

static void test_a_repeated_frame_never_counts(void) {
    for (uint32_t pause_ms = 0; pause_ms < 120; pause_ms++) {
        setUp();
        for (uint32_t i = 0; i < 40; i++) {
            TEST_ASSERT_NOT_EQUAL(FRESHNESS_COUNTS, take(7));
            pass_ms(pause_ms);
            check_unknown();
        }
    }
}

static void test_a_known_sender_that_hangs_is_gone_after_its_timeout(void) {
    run(5);
    uint32_t time_ms = 10;
    for (; freshness_is_known(&row); time_ms++) {
        TEST_ASSERT_EQUAL(FRESHNESS_REFUSED, take(4));
        pass_ms(1);
    }
    TEST_ASSERT_EQUAL_UINT32(TIMEOUT_ms + 1u, time_ms);
    for (uint32_t i = 0; i < 1000; i++) {
        TEST_ASSERT_NOT_EQUAL(FRESHNESS_COUNTS, take(4));
        pass_ms(1);
        check_unknown();
    }
}

static void test_a_repetition_starts_the_trial_anew(void) {
    (void)take(0);
    pass_ms(10);
    TEST_ASSERT_EQUAL(FRESHNESS_ON_TRIAL, take(1));
    pass_ms(10);
    TEST_ASSERT_EQUAL(FRESHNESS_REFUSED, take(1));
    pass_ms(10);
    TEST_ASSERT_EQUAL(FRESHNESS_ON_TRIAL, take(2));
    pass_ms(10);
    TEST_ASSERT_EQUAL(FRESHNESS_COUNTS, take(3));
}

static void test_a_frame_sent_twice_disturbs_nothing(void) {
    run(5);
    for (uint32_t i = 5; i < 40; i++) {
        TEST_ASSERT_EQUAL(FRESHNESS_COUNTS, take(i));
        TEST_ASSERT_EQUAL(FRESHNESS_REFUSED, take(i));
        pass_ms(CYCLE_ms);
    }
}

// Two senders: nobody knows which is the right one.
static void test_two_frames_of_one_counter_count_for_nobody(void) {
    run(5);
    TEST_ASSERT_EQUAL(FRESHNESS_COUNTS, take_other(5));
    TEST_ASSERT_EQUAL(FRESHNESS_REFUSED, take(5));
    check_unknown();
    pass_ms(10);
    TEST_ASSERT_EQUAL(FRESHNESS_BEGINS, take(6));
}

// Every counter at every time: what fits no time is refused and changes nothing.
static void test_an_inserted_frame_that_does_not_fit_changes_nothing(void) {
    for (uint32_t alive = 0; alive < 16; alive++) {
        for (uint32_t at_ms = 0; at_ms < 10; at_ms++) {
            setUp();
            run(5);
            TEST_ASSERT_EQUAL(FRESHNESS_COUNTS, take(5));
            pass_ms(at_ms);
            const freshness_t before = row;
            const freshness_verdict_t verdict = take_other(alive);
            row.has_jumped = false;            // forgiven by the next
            if (verdict == FRESHNESS_COUNTS) { // the next, two thirds of a cycle early at the most
                TEST_ASSERT_EQUAL_UINT32(6, alive);
                TEST_ASSERT_GREATER_OR_EQUAL_UINT32(2, at_ms);
            } else if (alive != 5u) {
                TEST_ASSERT_EQUAL_MEMORY(&before, &row, sizeof row);
                pass_ms(10 - at_ms);
                TEST_ASSERT_EQUAL(FRESHNESS_COUNTS, take(6));
            }
        }
    }
}

static void check_late(uint32_t late_ms, freshness_verdict_t expected) {
    setUp();
    run(5);
    pass_ms(late_ms);
    TEST_ASSERT_EQUAL(expected, take(5));
    pass_ms(10u - late_ms);
    TEST_ASSERT_EQUAL(FRESHNESS_COUNTS, take(6)); // whose time has not changed
}

// Three quarters of a cycle, and an eighth for the clocks.
static void test_a_delayed_frame_counts_within_the_tolerance(void) {
    for (uint32_t late_ms = 0; late_ms <= 8; late_ms++) {
        check_late(late_ms, FRESHNESS_COUNTS);
    }
    check_late(9, FRESHNESS_REFUSED);
    check_late(10, FRESHNESS_REFUSED);
}

static void test_a_delayed_frame_holds_no_longer(void) {
    for (uint32_t late_ms = 0; late_ms <= 8; late_ms++) {
        setUp();
        run(5);
        pass_ms(late_ms);
        (void)take(5);
        TEST_ASSERT_EQUAL_UINT32(TIMEOUT_ms + 1u - late_ms, known_ms());
    }
}

static void test_an_early_frame_counts_within_the_tolerance(void) {
    for (uint32_t at_ms = 0; at_ms <= 10; at_ms++) {
        setUp();
        run(5);
        (void)take(5);
        pass_ms(at_ms);
        TEST_ASSERT_EQUAL(at_ms >= 2 ? FRESHNESS_COUNTS : FRESHNESS_REFUSED, take(6));
    }
}

// They were sent in time and come together, when the last of them is due.
static void test_of_a_delayed_burst_the_last_one_counts(void) {
    run(5);
    pass_ms(30);
    TEST_ASSERT_EQUAL(FRESHNESS_REFUSED, take(5));
    TEST_ASSERT_EQUAL(FRESHNESS_REFUSED, take(6));
    TEST_ASSERT_EQUAL(FRESHNESS_REFUSED, take(7));
    TEST_ASSERT_EQUAL(FRESHNESS_COUNTS, take(8));
}

static void test_a_burst_makes_no_sender_known(void) {
    for (uint32_t i = 0; i < 100; i++) {
        TEST_ASSERT_NOT_EQUAL(FRESHNESS_COUNTS, take(i));
    }
    check_unknown();
    pass_ms(10);
    TEST_ASSERT_EQUAL(FRESHNESS_ON_TRIAL, take(100));
    pass_ms(10);
    TEST_ASSERT_EQUAL(FRESHNESS_COUNTS, take(101));
}

// A recording that is played too fast or too slowly.
static void test_only_the_cycle_makes_a_sender_known(void) {
    for (uint32_t pause_ms = 1; pause_ms <= 40; pause_ms++) {
        uint32_t counted = 0;
        setUp();
        for (uint32_t i = 0; i < 400; i++) {
            counted += take(i) == FRESHNESS_COUNTS ? 1u : 0u;
            pass_ms(pause_ms);
        }
        if (pause_ms == 9 || pause_ms == 10 || pause_ms == 11) {
            TEST_ASSERT_EQUAL_UINT32(398, counted);
        } else if (pause_ms < 5 || pause_ms > 18) {
            TEST_ASSERT_EQUAL_UINT32(0, counted);
        } else {
            TEST_ASSERT_LESS_THAN_UINT32(300, counted);
        }
    }
}

static void test_clocks_may_differ_and_times_may_jitter(void) {
    uint32_t seed = 1;
    for (uint32_t cycle_us = 9000; cycle_us <= 11000; cycle_us += 250) {
        setUp();
        uint32_t now_us = 0;
        for (uint32_t i = 0; i < 2000; i++) {
            seed = seed * 1664525u + 1013904223u;
            const uint32_t at_us = i * cycle_us + (seed >> 16) % 4000u;
            for (; now_us + MS <= at_us; now_us += MS) {
                freshness_pass(&row, MS);
            }
            const freshness_verdict_t verdict = take(i);
            TEST_ASSERT_EQUAL(i >= 2 ? FRESHNESS_COUNTS : verdict, verdict);
        }
    }
}

static void test_lost_frames_are_missed_and_the_next_one_counts(void) {
    for (uint32_t lost = 1; lost <= 4; lost++) {
        setUp();
        run(5);
        pass_ms(lost * CYCLE_ms);
        TEST_ASSERT_EQUAL(FRESHNESS_COUNTS, take(5 + lost));
        pass_ms(10);
        TEST_ASSERT_EQUAL(FRESHNESS_COUNTS, take(6 + lost));
        TEST_ASSERT_EQUAL_UINT32(TIMEOUT_ms + 1u, known_ms());
    }
    setUp();
    run(5);
    pass_ms(50);
    check_unknown();
    TEST_ASSERT_EQUAL(FRESHNESS_BEGINS, take(10));
}

// A single frame after the sender has died, whatever its counter and whenever it comes.
static void test_no_single_frame_holds_for_more_than_a_cycle_longer(void) {
    for (uint32_t alive = 0; alive < 16; alive++) {
        for (uint32_t at_ms = 0; at_ms <= TIMEOUT_ms; at_ms++) {
            setUp();
            run(5);
            (void)take(5);
            pass_ms(at_ms);
            (void)take_other(alive);
            TEST_ASSERT_LESS_OR_EQUAL_UINT32(TIMEOUT_ms + CYCLE_ms + 1u, at_ms + known_ms());
        }
    }
}

static void test_a_reordered_frame_is_refused_and_its_successors_count(void) {
    run(5);
    pass_ms(9);
    TEST_ASSERT_EQUAL(FRESHNESS_COUNTS, take(6)); // 19 ms after frame 4
    TEST_ASSERT_EQUAL(FRESHNESS_REFUSED, take(5));
    pass_ms(11);
    TEST_ASSERT_EQUAL(FRESHNESS_COUNTS, take(7));
}

static void test_a_sender_that_jumped_is_on_trial_again(void) {
    run(5);
    TEST_ASSERT_EQUAL(FRESHNESS_REFUSED, take(11)); // it was started again
    TEST_ASSERT_TRUE(freshness_is_known(&row));
    pass_ms(10);
    TEST_ASSERT_EQUAL(FRESHNESS_REFUSED, take(12));
    check_unknown();
    pass_ms(10);
    TEST_ASSERT_EQUAL(FRESHNESS_BEGINS, take(13));
    pass_ms(10);
    TEST_ASSERT_EQUAL(FRESHNESS_ON_TRIAL, take(14));
    pass_ms(10);
    TEST_ASSERT_EQUAL(FRESHNESS_COUNTS, take(15));
}

static void test_a_jump_is_forgiven_by_a_frame_that_fits(void) {
    run(5);
    for (uint32_t i = 5; i < 30; i++) {
        TEST_ASSERT_EQUAL(FRESHNESS_REFUSED, take_other(i + 8));
        TEST_ASSERT_EQUAL(FRESHNESS_COUNTS, take(i));
        pass_ms(10);
    }
}

static void test_a_trial_with_a_gap_begins_anew(void) {
    (void)take(0);
    pass_ms(10);
    (void)take(1);
    pass_ms(20);
    TEST_ASSERT_EQUAL(FRESHNESS_REFUSED, take(3));
    pass_ms(10);
    TEST_ASSERT_EQUAL(FRESHNESS_ON_TRIAL, take(4));
    pass_ms(60); // and one that is given up is forgotten
    TEST_ASSERT_EQUAL(FRESHNESS_BEGINS, take(5));
}

// An adapter that hands over every fourth frame's time: 2 ms of cycle, 8 ms of latency.
static void test_frames_in_packets_make_a_sender_known(void) {
    freshness_use(&row, 2 * MS, 10 * MS);
    uint32_t counted = 0;
    for (uint32_t i = 0; i < 400; i++) {
        counted += take(i) == FRESHNESS_COUNTS ? 1u : 0u;
        pass_ms(i % 4u == 3u ? 8 : 0);
    }
    TEST_ASSERT_GREATER_OR_EQUAL_UINT32(195, counted);
}

static void test_time_saturates(void) {
    run(5);
    freshness_pass(&row, INT32_MAX);
    freshness_pass(&row, INT32_MAX);
    check_unknown();
    TEST_ASSERT_EQUAL(FRESHNESS_BEGINS, take(5));
    pass_ms(10);
    TEST_ASSERT_EQUAL(FRESHNESS_ON_TRIAL, take(6));
}

static void test_a_known_sender_stays_known_at_another_rate(void) {
    run(5);
    freshness_use(&row, 10 * MS, 50 * MS);
    TEST_ASSERT_TRUE(freshness_is_known(&row));
    TEST_ASSERT_EQUAL(FRESHNESS_COUNTS, take(5));
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(test_a_sender_counts_from_its_third_frame_on);
    RUN_TEST(test_a_repeated_frame_never_counts);
    RUN_TEST(test_a_known_sender_that_hangs_is_gone_after_its_timeout);
    RUN_TEST(test_a_repetition_starts_the_trial_anew);
    RUN_TEST(test_a_frame_sent_twice_disturbs_nothing);
    RUN_TEST(test_two_frames_of_one_counter_count_for_nobody);
    RUN_TEST(test_an_inserted_frame_that_does_not_fit_changes_nothing);
    RUN_TEST(test_a_delayed_frame_counts_within_the_tolerance);
    RUN_TEST(test_a_delayed_frame_holds_no_longer);
    RUN_TEST(test_an_early_frame_counts_within_the_tolerance);
    RUN_TEST(test_of_a_delayed_burst_the_last_one_counts);
    RUN_TEST(test_a_burst_makes_no_sender_known);
    RUN_TEST(test_only_the_cycle_makes_a_sender_known);
    RUN_TEST(test_clocks_may_differ_and_times_may_jitter);
    RUN_TEST(test_lost_frames_are_missed_and_the_next_one_counts);
    RUN_TEST(test_no_single_frame_holds_for_more_than_a_cycle_longer);
    RUN_TEST(test_a_reordered_frame_is_refused_and_its_successors_count);
    RUN_TEST(test_a_sender_that_jumped_is_on_trial_again);
    RUN_TEST(test_a_jump_is_forgiven_by_a_frame_that_fits);
    RUN_TEST(test_a_trial_with_a_gap_begins_anew);
    RUN_TEST(test_frames_in_packets_make_a_sender_known);
    RUN_TEST(test_time_saturates);
    RUN_TEST(test_a_known_sender_stays_known_at_another_rate);
    return UNITY_END();
}
