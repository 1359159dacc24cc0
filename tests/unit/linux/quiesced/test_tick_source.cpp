#include <gtest/gtest.h>

#include "emergency_stop.h"
#include "tick_source.h"

namespace quiesced {
namespace {

std::string taken(LogRing &log) {
    LogLine line{};
    return log.take(line) ? line.text.data() : "";
}

TEST(TickSource, the_timer_gives_ticks) {
    const auto log = std::make_unique<LogRing>();
    Replaceable<Line> none;
    TickSource source;
    source.start(1000, false);
    std::uint64_t ticks = 0;
    for (int i = 0; i < 20; ++i) {
        ticks += source.wait(none, *log);
        source.done();
    }
    EXPECT_GE(ticks, 20U);
    EXPECT_EQ(ticks - 20U, source.timing().overruns);
    EXPECT_EQ(source.timing().work.count, 20U);
}

TEST(TickSource, another_rate_keeps_what_was_counted) {
    const auto log = std::make_unique<LogRing>();
    Replaceable<Line> none;
    TickSource source;
    source.start(1000, false);
    (void)source.wait(none, *log);
    source.done();
    const std::uint32_t overruns = source.timing().overruns;
    source.change_rate(2000);
    EXPECT_EQ(source.timing().period_ns, 500'000U);
    EXPECT_EQ(source.timing().work.count, 1U);
    EXPECT_EQ(source.timing().overruns, overruns);
    EXPECT_GE(source.wait(none, *log), 1U);
}

/// The data-ready line is gone: ticks go on after two periods each, the lost ones counted.
TEST(TickSource, without_its_line_a_tick_is_lost_each_time) {
    const auto log = std::make_unique<LogRing>();
    Replaceable<Line> gone;
    TickSource source;
    source.start(1000, true);
    for (int i = 0; i < 5; ++i) {
        EXPECT_GE(source.wait(gone, *log), 2U);
    }
    EXPECT_GE(source.timing().overruns, 5U);
}

TEST(EmergencyStop, without_a_line_nothing_is_pressed) {
    const auto log = std::make_unique<LogRing>();
    Replaceable<Line> none;
    EmergencyStop stop(false);
    EXPECT_FALSE(stop.is_pressed(none, *log));
}

TEST(EmergencyStop, a_line_that_is_gone_counts_as_pressed) {
    const auto log = std::make_unique<LogRing>();
    Replaceable<Line> gone;
    EmergencyStop stop(true);
    EXPECT_TRUE(stop.is_pressed(gone, *log));
    stop.command_sent(true, 1, 1, *log); // there was no edge to report on
    EXPECT_EQ(taken(*log), "");
}

} // namespace
} // namespace quiesced
