#include "tick_linux.h"

#include <errno.h>
#include <sched.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <time.h>

#define NS_PER_S 1000000000
#define MAX_RATE_HZ 100000u
#define STACK_BYTES 65536u ///< touched in advance, so that no tick faults them in

int64_t tick_linux_now_ns(void) {
    struct timespec now;
    (void)clock_gettime(CLOCK_MONOTONIC, &now);
    return (int64_t)now.tv_sec * NS_PER_S + now.tv_nsec;
}

static void touch_stack(void) {
    volatile unsigned char bytes[STACK_BYTES];
    for (size_t i = 0; i < sizeof bytes; i += 1024u) {
        bytes[i] = 0;
    }
}

static bool lock_memory(linux_error_t *error) {
    if (mlockall(MCL_CURRENT | MCL_FUTURE) != 0) {
        return linux_fail(
            error,
            "lock memory: %s; it needs CAP_IPC_LOCK or a greater memlock limit (ulimit "
            "-l, LimitMEMLOCK=), or set lock_memory = false",
            strerror(errno));
    }
    touch_stack();
    return true;
}

static bool set_priority(int priority, linux_error_t *error) {
    const struct sched_param parameter = {.sched_priority = priority};
    if (priority < sched_get_priority_min(SCHED_FIFO) ||
        priority > sched_get_priority_max(SCHED_FIFO)) {
        return linux_fail(error, "priority %d: must be 1 .. 99, or 0 for normal scheduling",
                          priority);
    }
    if (sched_setscheduler(0, SCHED_FIFO | SCHED_RESET_ON_FORK, &parameter) != 0) {
        return linux_fail(
            error,
            "real-time priority %d: %s; it needs CAP_SYS_NICE or an rtprio limit (ulimit "
            "-r, LimitRTPRIO=), or set priority = 0",
            priority, strerror(errno));
    }
    return true;
}

static bool set_cpu(int cpu, linux_error_t *error) {
    cpu_set_t set;
    if (cpu >= CPU_SETSIZE) {
        return linux_fail(error, "cpu %d: there is no such CPU; or -1 for any", cpu);
    }
    CPU_ZERO(&set);
    CPU_SET((size_t)cpu, &set);
    if (sched_setaffinity(0, sizeof set, &set) != 0) {
        return linux_fail(error, "cpu %d: %s; choose one that is there (nproc), or -1 for any", cpu,
                          strerror(errno));
    }
    return true;
}

bool tick_linux_thread(const tick_thread_options_t *options, linux_error_t *error) {
    // Without it a thread of normal scheduling wakes up to 50 us late.
    if (prctl(PR_SET_TIMERSLACK, 1UL, 0UL, 0UL, 0UL) != 0) {
        return linux_fail(error, "timer slack: %s", strerror(errno));
    }
    return (!options->lock_memory || lock_memory(error)) &&
           (options->cpu < 0 || set_cpu(options->cpu, error)) &&
           (options->priority == 0 || set_priority(options->priority, error));
}

bool hal_tick_start(hal_tick_t *tick, uint32_t rate_Hz) {
    if (rate_Hz == 0u || rate_Hz > MAX_RATE_HZ || NS_PER_S % rate_Hz != 0u) {
        return false;
    }
    *tick = (hal_tick_t){.period_ns = NS_PER_S / rate_Hz};
    tick->start_ns = tick_linux_now_ns();
    tick->next_ns = tick->start_ns + tick->period_ns;
    return true;
}

uint32_t hal_tick_elapsed(hal_tick_t *tick) {
    const uint32_t elapsed = tick->elapsed;
    tick->elapsed = 0;
    return elapsed;
}

static uint32_t to_u32(int64_t value) {
    return value < 0 ? 0u : value > UINT32_MAX ? UINT32_MAX : (uint32_t)value;
}

static void add_up(uint32_t *sum, uint32_t by) {
    *sum = by > UINT32_MAX - *sum ? UINT32_MAX : *sum + by;
}

static void put(tick_histogram_t *histogram, uint32_t time_ns) {
    const uint32_t time_us = time_ns / 1000u;
    const uint32_t bin = time_us == 0u ? 0u : 32u - (uint32_t)__builtin_clz(time_us);
    histogram->count++;
    histogram->total_ns += time_ns;
    histogram->worst_ns = time_ns > histogram->worst_ns ? time_ns : histogram->worst_ns;
    histogram->bins[bin < TICK_HISTOGRAM_BINS ? bin : TICK_HISTOGRAM_BINS - 1u]++;
}

/// A tick begins that was due at due_ns, the given number of periods after the one before.
static void begin(hal_tick_t *tick, int64_t due_ns, int64_t now_ns, uint32_t periods) {
    tick->start_ns = now_ns;
    tick->lateness_ns = to_u32(now_ns - due_ns);
    put(&tick->lateness, tick->lateness_ns);
    add_up(&tick->elapsed, periods);
    add_up(&tick->overruns, periods - 1u);
}

void tick_linux_wait(hal_tick_t *tick) {
    const struct timespec due = {.tv_sec = tick->next_ns / NS_PER_S,
                                 .tv_nsec = tick->next_ns % NS_PER_S};
    if (clock_nanosleep(CLOCK_MONOTONIC, TIMER_ABSTIME, &due, NULL) != 0) {
        return;
    }
    const int64_t now_ns = tick_linux_now_ns();
    const int64_t lost = (now_ns - tick->next_ns) / tick->period_ns;
    begin(tick, tick->next_ns, now_ns, to_u32(1 + lost));
    tick->next_ns += (1 + lost) * tick->period_ns;
}

static int64_t within(int64_t value, int64_t limit) {
    return value < -limit ? -limit : value > limit ? limit : value;
}

bool tick_linux_begin(hal_tick_t *tick, int64_t due_ns) {
    const int64_t period_ns = tick->period_ns;
    const int64_t half_ns = period_ns / 2;
    const int64_t late_ns = due_ns - tick->next_ns;
    if (tick->has_begun && (due_ns - tick->last_ns < half_ns || late_ns < -half_ns)) {
        add_up(&tick->early, 1u);
        return false;
    }
    const int64_t lost = late_ns > 0 ? (late_ns + half_ns) / period_ns : 0;
    begin(tick, due_ns, tick_linux_now_ns(), to_u32(1 + lost));
    // The first start says where the grid is.
    const int64_t off_ns = late_ns - lost * period_ns;
    tick->next_ns += (1 + lost) * period_ns +
                     (tick->has_begun ? within(off_ns, period_ns / TICK_FOLLOWS) : off_ns);
    tick->last_ns = due_ns;
    tick->has_begun = true;
    return true;
}

void tick_linux_work_done(hal_tick_t *tick) {
    tick->work_ns = to_u32(tick_linux_now_ns() - tick->start_ns);
    put(&tick->work, tick->work_ns);
}
