#include "lost_ticks.h"

#include <algorithm>

#include <sched.h>
#include <sys/resource.h>

namespace quiesced {

namespace {

struct LossWords {
    const char *name;
    const char *text;
};

constexpr std::array<LossWords, kLossCauses> kWords = {{
    {"work", "the work of a tick took longer than a tick"},
    {"no_priority", "other processes had the CPU, and the loop has no real-time priority "
                    "(loop.priority)"},
    {"latency", "woken late in spite of its real-time priority: kernel, hypervisor, or another "
                "real-time process"},
    {"line", "data_ready_input had no edge in time"},
}};

const LossWords &words_of(LossCause cause) {
    return kWords[static_cast<std::size_t>(cause)];
}

} // namespace

const char *loss_name(LossCause cause) {
    return words_of(cause).name;
}

const char *loss_text(LossCause cause) {
    return words_of(cause).text;
}

ThreadState this_thread() {
    const int policy = sched_getscheduler(0) & ~SCHED_RESET_ON_FORK;
    struct rusage usage {};
    (void)getrusage(RUSAGE_THREAD, &usage);
    return {policy == SCHED_FIFO || policy == SCHED_RR,
            static_cast<std::uint32_t>(usage.ru_nivcsw)};
}

LossCause LostTicks::cause_of(const hal_tick_t &timing, bool has_line,
                              const ThreadState &thread) const {
    const bool was_preempted = thread.preemptions != preemptions_;
    if (timing.work_ns >= timing.period_ns && !was_preempted) {
        return LossCause::work;
    }
    if (has_line && timing.lateness_ns < timing.period_ns) {
        return LossCause::line;
    }
    return thread.is_realtime ? LossCause::latency : LossCause::no_priority;
}

void LostTicks::count(std::uint32_t lost, const hal_tick_t &timing, bool has_line,
                      const ThreadState &thread) {
    last_ = cause_of(timing, has_line, thread);
    preemptions_ = thread.preemptions;
    std::uint32_t &sum = counts_[static_cast<std::size_t>(last_)];
    sum += std::min(lost, UINT32_MAX - sum);
}

} // namespace quiesced
