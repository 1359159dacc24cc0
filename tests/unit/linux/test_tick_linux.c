#include "one_line.h"
#include "tick_linux.h"
#include "unity.h"

#include <sched.h>
#include <signal.h>
#include <stdlib.h>
#include <sys/mman.h>
#include <sys/time.h>
#include <sys/wait.h>
#include <unistd.h>

#define HOUR_NS INT64_C(3600000000000)

static hal_tick_t tick;
static linux_error_t error;

void setUp(void) {
    error.text[0] = '\0';
}

void tearDown(void) {}

static uint64_t sum(const tick_histogram_t *histogram) {
    uint64_t count = 0;
    for (uint32_t i = 0; i < TICK_HISTOGRAM_BINS; i++) {
        count += histogram->bins[i];
    }
    return count;
}

static void test_rates_that_are_not_exact_are_refused(void) {
    static const uint32_t refused[] = {0, 3, 7, 3000, 100001, 99999, UINT32_MAX};
    static const uint32_t taken[] = {1, 500, 1000, 2000, 4000, 100000};
    for (size_t i = 0; i < sizeof refused / sizeof refused[0]; i++) {
        TEST_ASSERT_FALSE(hal_tick_start(&tick, refused[i]));
    }
    for (size_t i = 0; i < sizeof taken / sizeof taken[0]; i++) {
        TEST_ASSERT_TRUE(hal_tick_start(&tick, taken[i]));
        TEST_ASSERT_EQUAL_UINT32(1000000000u / taken[i], tick.period_ns);
    }
}

static void test_ticks_are_never_early_and_all_are_accounted_for(void) {
    TEST_ASSERT_TRUE(hal_tick_start(&tick, 2000));
    const int64_t first_ns = tick.next_ns;
    uint64_t elapsed = 0;
    TEST_ASSERT_EQUAL_UINT32(0, hal_tick_elapsed(&tick));
    for (uint32_t i = 0; i < 200; i++) {
        const int64_t due_ns = tick.next_ns;
        tick_linux_wait(&tick);
        const uint32_t periods = hal_tick_elapsed(&tick);
        TEST_ASSERT_TRUE(tick.start_ns >= due_ns);
        TEST_ASSERT_TRUE(periods >= 1u);
        TEST_ASSERT_EQUAL_INT64(due_ns + (int64_t)periods * tick.period_ns, tick.next_ns);
        TEST_ASSERT_TRUE(tick.next_ns > tick.start_ns);
        TEST_ASSERT_EQUAL_INT64(tick.start_ns - due_ns, tick.lateness_ns);
        tick_linux_work_done(&tick);
        elapsed += periods;
    }
    TEST_ASSERT_EQUAL_UINT32(0, hal_tick_elapsed(&tick));
    TEST_ASSERT_EQUAL_INT64(first_ns + (int64_t)elapsed * tick.period_ns, tick.next_ns);
    TEST_ASSERT_EQUAL_UINT64(elapsed - 200u, tick.overruns);
    TEST_ASSERT_EQUAL_UINT64(200, tick.lateness.count);
    TEST_ASSERT_EQUAL_UINT64(200, sum(&tick.lateness));
    TEST_ASSERT_EQUAL_UINT64(200, tick.work.count);
    TEST_ASSERT_EQUAL_UINT64(200, sum(&tick.work));
    TEST_ASSERT_TRUE(tick.lateness.total_ns >= tick.lateness.worst_ns);
}

static void test_lost_ticks_are_skipped_and_counted(void) {
    TEST_ASSERT_TRUE(hal_tick_start(&tick, 10000));
    tick.next_ns -= 5 * (int64_t)tick.period_ns; // as if the thread had not run
    tick_linux_wait(&tick);
    const uint32_t periods = hal_tick_elapsed(&tick);
    TEST_ASSERT_TRUE(periods >= 5u);
    TEST_ASSERT_EQUAL_UINT32(periods - 1u, tick.overruns);
    TEST_ASSERT_TRUE(tick.next_ns > tick.start_ns);
}

static void test_overruns_and_lateness_saturate(void) {
    TEST_ASSERT_TRUE(hal_tick_start(&tick, 100000));
    tick.overruns = UINT32_MAX - 1u;
    tick.next_ns = 0; // since the machine has started: more than 4.3 s
    tick_linux_wait(&tick);
    TEST_ASSERT_EQUAL_UINT32(UINT32_MAX, tick.overruns);
    TEST_ASSERT_EQUAL_UINT32(UINT32_MAX, tick.lateness_ns);
    TEST_ASSERT_TRUE(hal_tick_elapsed(&tick) > 400000u);
    TEST_ASSERT_EQUAL_UINT32(1, tick.lateness.bins[23]);
    TEST_ASSERT_TRUE(tick.next_ns > tick.start_ns);
}

static void on_signal(int number) {
    (void)number;
}

static void test_signal_ends_the_wait_without_a_tick(void) {
    const struct sigaction action = {.sa_handler = on_signal};
    const struct itimerval again = {{0, 2000}, {0, 2000}}; // again, should one come too early
    const struct itimerval none = {{0, 0}, {0, 0}};
    TEST_ASSERT_EQUAL_INT(0, sigaction(SIGALRM, &action, NULL));
    TEST_ASSERT_TRUE(hal_tick_start(&tick, 1));
    tick.next_ns += HOUR_NS;
    const int64_t due_ns = tick.next_ns;
    TEST_ASSERT_EQUAL_INT(0, setitimer(ITIMER_REAL, &again, NULL));
    tick_linux_wait(&tick);
    TEST_ASSERT_EQUAL_INT(0, setitimer(ITIMER_REAL, &none, NULL));
    TEST_ASSERT_EQUAL_UINT32(0, hal_tick_elapsed(&tick));
    TEST_ASSERT_EQUAL_INT64(due_ns, tick.next_ns);
    TEST_ASSERT_EQUAL_UINT64(0, tick.lateness.count);
}

static void test_edges_count_to_the_nearest_period(void) {
    TEST_ASSERT_TRUE(hal_tick_start(&tick, 1000));
    static const struct {
        int64_t after_ns; ///< the edge before, the first one the start
        uint32_t periods; ///< 0: no tick
        int64_t next_ns;  ///< after the edge
    } edges[] = {
        {400000, 1, 1000000}, {1000000, 1, 1000000}, {990000, 1, 1000000}, {1490000, 1, 530000},
        {510000, 1, 1000000}, {1510000, 2, 1470000}, {400000, 0, 1070000}, {560000, 0, 510000},
        {10000, 1, 1480000},  {6480000, 6, 1000000},
    };
    int64_t edge_ns = tick.next_ns - 1000000;
    uint32_t lost = 0;
    uint32_t early = 0;
    for (size_t i = 0; i < sizeof edges / sizeof edges[0]; i++) {
        edge_ns += edges[i].after_ns;
        TEST_ASSERT_EQUAL(edges[i].periods > 0u, tick_linux_begin(&tick, edge_ns));
        TEST_ASSERT_EQUAL_UINT32(edges[i].periods, hal_tick_elapsed(&tick));
        TEST_ASSERT_EQUAL_INT64(edges[i].next_ns, tick.next_ns - edge_ns);
        lost += edges[i].periods > 0u ? edges[i].periods - 1u : 0u;
        early += edges[i].periods == 0u ? 1u : 0u;
    }
    TEST_ASSERT_EQUAL_UINT32(lost, tick.overruns);
    TEST_ASSERT_EQUAL_UINT32(early, tick.early);
}

/// Whatever the line's rate, the ticks that are told are those of real time.
static void test_edges_of_any_rate_do_not_change_the_time_base(void) {
    static const uint32_t edge_ns[] = {100000,  333333,  500000,  510000,  700000,  980000, 990000,
                                       1000000, 1010000, 1020000, 1050000, 1400000, 2500000};
    for (size_t i = 0; i < sizeof edge_ns / sizeof edge_ns[0]; i++) {
        const uint32_t edges = 4000000000u / edge_ns[i]; // 4 s: 4000 ticks
        uint32_t elapsed = 0;
        uint32_t ticks = 0;
        TEST_ASSERT_TRUE(hal_tick_start(&tick, 1000));
        const int64_t first_ns = tick.next_ns;
        for (uint32_t edge = 0; edge < edges; edge++) {
            // The kernel stamps them up to 40 us late.
            const int64_t jitter_ns = (int64_t)(edge * 7919u % 40000u);
            ticks += tick_linux_begin(&tick, first_ns + (int64_t)edge * edge_ns[i] + jitter_ns);
            elapsed += hal_tick_elapsed(&tick);
        }
        TEST_ASSERT_UINT32_WITHIN(80 + 3, 4000, elapsed); // 2 %
        TEST_ASSERT_EQUAL_UINT32(edges - ticks, tick.early);
        TEST_ASSERT_EQUAL_UINT32(elapsed - ticks, tick.overruns);
        const bool is_tolerated = edge_ns[i] >= 980000u && edge_ns[i] <= 1020000u;
        TEST_ASSERT_EQUAL(is_tolerated, tick.early == 0u && tick.overruns == 0u);
    }
}

static void test_bins_are_powers_of_two_us(void) {
    static const struct {
        int64_t late_ns;
        uint32_t bin;
    } cases[] = {{-50000000, 0}, {HOUR_NS, 23}};
    TEST_ASSERT_TRUE(hal_tick_start(&tick, 1000));
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        const int64_t due_ns = tick_linux_now_ns() - cases[i].late_ns;
        TEST_ASSERT_TRUE(hal_tick_start(&tick, 1000));
        TEST_ASSERT_TRUE(tick_linux_begin(&tick, due_ns));
        TEST_ASSERT_EQUAL_UINT32(1, tick.lateness.bins[cases[i].bin]);
    }
    for (uint32_t bin = 1; bin < 23u; bin++) { // the bin fits the time that was measured
        tick.work = (tick_histogram_t){0};
        tick.start_ns = tick_linux_now_ns() - (INT64_C(1000) << (bin - 1u));
        tick_linux_work_done(&tick);
        uint32_t filled = 0;
        while (tick.work.bins[filled] == 0u) {
            filled++;
        }
        TEST_ASSERT_TRUE(filled >= bin);
        TEST_ASSERT_TRUE(filled == 23u || tick.work_ns / 1000u < 1u << filled);
        TEST_ASSERT_TRUE(tick.work_ns / 1000u >= 1u << (filled - 1u));
    }
}

static void test_wrong_thread_options_are_one_line(void) {
    static const struct {
        tick_thread_options_t options;
        const char *text;
    } cases[] = {
        {{.priority = 100, .cpu = -1}, "priority 100: must be 1 .. 99"},
        {{.priority = -1, .cpu = -1}, "priority -1"},
        {{.cpu = 1 << 20}, "there is no such CPU"},
        {{.cpu = 1023}, "cpu 1023: "},
    };
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        TEST_ASSERT_FALSE(tick_linux_thread(&cases[i].options, &error));
        assert_one_line(&error, cases[i].text);
    }
}

/// In a child, so that the tests' own thread stays as it is. 0: done, 1: refused with a hint.
static int in_child(int (*body)(void)) {
    int status;
    const pid_t child = fork();
    TEST_ASSERT_NOT_EQUAL(-1, child);
    if (child == 0) {
        _exit(body());
    }
    TEST_ASSERT_EQUAL_INT(child, waitpid(child, &status, 0));
    TEST_ASSERT_TRUE(WIFEXITED(status));
    return WEXITSTATUS(status);
}

static int pin(void) {
    cpu_set_t set;
    const int cpu = sched_getcpu();
    const tick_thread_options_t options = {.cpu = cpu};
    return tick_linux_thread(&options, &error) && sched_getaffinity(0, sizeof set, &set) == 0 &&
                   CPU_COUNT(&set) == 1 && CPU_ISSET((size_t)cpu, &set)
               ? 0
               : 2;
}

static int become_real_time(void) {
    struct sched_param parameter;
    const tick_thread_options_t options = {.priority = 1, .cpu = -1};
    if (!tick_linux_thread(&options, &error)) {
        return strstr(error.text, "CAP_SYS_NICE") != NULL ? 1 : 2;
    }
    return sched_getparam(0, &parameter) == 0 && parameter.sched_priority == 1 &&
                   sched_getscheduler(0) == (SCHED_FIFO | SCHED_RESET_ON_FORK)
               ? 0
               : 2;
}

static int lock(void) {
    const tick_thread_options_t options = {.cpu = -1, .lock_memory = true};
    if (!tick_linux_thread(&options, &error)) {
        return strstr(error.text, "CAP_IPC_LOCK") != NULL ? 1 : 2;
    }
    return 0;
}

static void test_thread_is_what_was_asked_for_or_names_the_missing_right(void) {
    TEST_ASSERT_EQUAL_INT(0, in_child(pin));
    TEST_ASSERT_LESS_THAN_INT(2, in_child(become_real_time));
    TEST_ASSERT_LESS_THAN_INT(2, in_child(lock));
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(test_rates_that_are_not_exact_are_refused);
    RUN_TEST(test_ticks_are_never_early_and_all_are_accounted_for);
    RUN_TEST(test_lost_ticks_are_skipped_and_counted);
    RUN_TEST(test_overruns_and_lateness_saturate);
    RUN_TEST(test_signal_ends_the_wait_without_a_tick);
    RUN_TEST(test_edges_count_to_the_nearest_period);
    RUN_TEST(test_edges_of_any_rate_do_not_change_the_time_base);
    RUN_TEST(test_bins_are_powers_of_two_us);
    RUN_TEST(test_wrong_thread_options_are_one_line);
    RUN_TEST(test_thread_is_what_was_asked_for_or_names_the_missing_right);
    return UNITY_END();
}
