#include <gtest/gtest.h>

#include "lost_ticks.h"

namespace quiesced {
namespace {

struct Loss {
    const char *name;
    std::uint32_t work_us;
    std::uint32_t lateness_us;
    bool has_line;
    ThreadState thread;
    LossCause cause;
};

/// Of ticks of a millisecond.
const Loss kLosses[] = {
    {"own work", 1500, 1200, false, {true, 0}, LossCause::work},
    {"own work without priority", 1500, 1200, false, {false, 0}, LossCause::work},
    {"preempted at work", 1500, 1200, false, {false, 3}, LossCause::no_priority},
    {"woken late", 100, 1200, false, {false, 0}, LossCause::no_priority},
    {"woken late in spite of it", 100, 1200, false, {true, 0}, LossCause::latency},
    {"no edge", 100, 20, true, {true, 0}, LossCause::line},
    {"late after the edge", 100, 1200, true, {true, 0}, LossCause::latency},
};

TEST(LostTicks, have_a_cause) {
    for (const Loss &row : kLosses) {
        LostTicks lost;
        hal_tick_t timing{};
        timing.period_ns = 1'000'000;
        timing.work_ns = row.work_us * 1000;
        timing.lateness_ns = row.lateness_us * 1000;
        lost.count(4, timing, row.has_line, row.thread);
        EXPECT_EQ(lost.last(), row.cause) << row.name;
        LossCounts expected{};
        expected[static_cast<std::size_t>(row.cause)] = 4;
        EXPECT_EQ(lost.counts(), expected) << row.name;
    }
}

TEST(LostTicks, saturate) {
    LostTicks lost;
    hal_tick_t timing{};
    timing.period_ns = 1'000'000;
    lost.count(UINT32_MAX - 1, timing, false, {true, 0});
    lost.count(5, timing, false, {true, 0});
    EXPECT_EQ(lost.counts()[static_cast<std::size_t>(LossCause::latency)], UINT32_MAX);
}

TEST(LostTicks, preemption_counts_once) {
    LostTicks lost;
    hal_tick_t timing{};
    timing.period_ns = 1'000'000;
    timing.work_ns = 2'000'000;
    lost.count(1, timing, false, {false, 7});
    EXPECT_EQ(lost.last(), LossCause::no_priority);
    lost.count(1, timing, false, {false, 7});
    EXPECT_EQ(lost.last(), LossCause::work);
}

TEST(LostTicks, a_thread_of_a_test_has_no_priority) {
    EXPECT_FALSE(this_thread().is_realtime);
}

} // namespace
} // namespace quiesced
