/// The control tick on Linux: clock_nanosleep to absolute times of CLOCK_MONOTONIC, and what a
/// real-time thread needs.
#ifndef TICK_LINUX_H
#define TICK_LINUX_H

#include "hal/tick.h"
#include "linux_error.h"

#define TICK_HISTOGRAM_BINS 24u ///< bin i: [2^(i-1), 2^i) us, bin 0: less than 1 us

typedef struct {
    uint64_t count;
    uint64_t total_ns;
    uint32_t worst_ns;
    uint32_t bins[TICK_HISTOGRAM_BINS];
} tick_histogram_t;

struct hal_tick {
    uint32_t period_ns;
    int64_t next_ns;      ///< due time of the next tick
    int64_t last_ns;      ///< tick_linux_begin: due time of the last tick
    bool has_begun;       ///< tick_linux_begin: there was one
    uint32_t elapsed;     ///< for hal_tick_elapsed
    uint32_t overruns;    ///< ticks lost since the start, saturating
    uint32_t early;       ///< starts that tick_linux_begin refused, saturating
    uint32_t lateness_ns; ///< of the last tick
    uint32_t work_ns;     ///< from the last tick's start to tick_linux_work_done
    int64_t start_ns;
    tick_histogram_t lateness;
    tick_histogram_t work;
};

typedef struct {
    int priority;     ///< SCHED_FIFO, 1 .. 99; 0: leave the scheduling as it is
    int cpu;          ///< pin to this one; -1: any
    bool lock_memory; ///< mlockall(MCL_CURRENT | MCL_FUTURE)
} tick_thread_options_t;

/// Makes the calling thread a real-time thread. Returns false iff the system refuses; the error
/// names the missing right (CAP_SYS_NICE, CAP_IPC_LOCK, rtprio limits).
bool tick_linux_thread(const tick_thread_options_t *options, linux_error_t *error);

/// Sleeps to the next tick's due time. Lost ticks (we are a period or more late) are skipped,
/// counted, and told by hal_tick_elapsed. Returns early with 0 elapsed on a signal.
void tick_linux_wait(hal_tick_t *tick);

/// How far tick_linux_begin follows another clock: 1 / this of the period.
#define TICK_FOLLOWS 50

/// Instead of tick_linux_wait where something else starts the ticks (a data-ready edge at due_ns,
/// CLOCK_MONOTONIC). Ticks stay tied to real time: they are due on a grid of periods, which the
/// starts move by 2 % of a period a tick at the most, so that another clock's tolerance is no
/// fault. A start half a period or more behind the grid tells lost ticks. Returns false, and counts
/// in tick->early, iff the start comes more than half a period before the grid or less than half a
/// period after the last one: it is no tick.
bool tick_linux_begin(hal_tick_t *tick, int64_t due_ns);

/// The tick's work is done: times it.
void tick_linux_work_done(hal_tick_t *tick);

/// CLOCK_MONOTONIC.
int64_t tick_linux_now_ns(void);

#endif
