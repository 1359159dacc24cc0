#include <gtest/gtest.h>

#include <atomic>
#include <csignal>
#include <thread>

#include <sys/resource.h>

#include "change_log.h"
#include "input_error.h"
#include "log_ring.h"
#include "log_sink.h"
#include "temporary_folder.h"

namespace quiesced {
namespace {

TEST(LogRing, gives_lines_back_in_their_order) {
    LogRing ring;
    LogLine line{};
    EXPECT_FALSE(ring.take(line));
    ring.log(LogLevel::warning, "%d and %s", 1, "one");
    ring.log(LogLevel::info, "two");
    ASSERT_TRUE(ring.take(line));
    EXPECT_STREQ(line.text.data(), "1 and one");
    EXPECT_EQ(line.level, LogLevel::warning);
    ASSERT_TRUE(ring.take(line));
    EXPECT_STREQ(line.text.data(), "two");
    EXPECT_FALSE(ring.take(line));
}

TEST(LogRing, cuts_a_line_that_is_too_long) {
    LogRing ring;
    ring.log(LogLevel::info, "%s", std::string(1000, 'x').c_str());
    LogLine line{};
    ASSERT_TRUE(ring.take(line));
    EXPECT_EQ(std::string(line.text.data()), std::string(LogLine::kBytes - 1, 'x'));
}

TEST(LogRing, drops_and_counts_what_does_not_fit) {
    LogRing ring;
    for (unsigned i = 0; i < LogRing::kLines + 3; ++i) {
        ring.log(LogLevel::info, "%u", i);
    }
    EXPECT_EQ(ring.dropped(), 3U);
    LogLine line{};
    for (unsigned i = 0; i < LogRing::kLines; ++i) {
        ASSERT_TRUE(ring.take(line));
        EXPECT_EQ(line.text.data(), std::to_string(i));
    }
    EXPECT_FALSE(ring.take(line));
    ring.log(LogLevel::info, "again");
    EXPECT_TRUE(ring.take(line));
}

TEST(LogRing, every_line_arrives_whole_or_is_counted_between_two_threads) {
    constexpr unsigned lines = 200'000;
    const auto ring = std::make_unique<LogRing>();
    std::atomic<bool> is_done{false};
    std::thread writer([&] {
        for (unsigned i = 0; i < lines; ++i) {
            ring->log(LogLevel::info, "%u", i);
        }
        is_done = true;
    });
    LogLine line{};
    unsigned taken = 0;
    long last = -1;
    for (bool is_last = false; !is_last;) {
        is_last = is_done;
        while (ring->take(line)) {
            const long number = std::stol(line.text.data());
            EXPECT_GT(number, last);
            last = number;
            ++taken;
        }
    }
    writer.join();
    EXPECT_EQ(taken + ring->dropped(), lines);
}

/// What a piece of code writes to stderr.
template <typename Code>
std::string stderr_of(Code &&code) {
    testing::internal::CaptureStderr();
    code();
    return testing::internal::GetCapturedStderr();
}

TEST(LogSink, journal_lines_begin_with_their_priority) {
    const std::string text = stderr_of([] {
        LogSink sink({"journal", LogLevel::info});
        sink.write(LogLevel::error, "a");
        sink.write(LogLevel::warning, "b");
        sink.write(LogLevel::info, "c");
        sink.write(LogLevel::debug, "d"); // below the level
    });
    EXPECT_EQ(text, "<3>a\n<4>b\n<6>c\n");
}

TEST(LogSink, people_read_levels_as_words) {
    const std::string text = stderr_of([] {
        LogSink sink({"stderr", LogLevel::warning});
        sink.write(LogLevel::error, "a");
        sink.write(LogLevel::info, "b");
    });
    EXPECT_EQ(text, "quiesced: error: a\n");
}

TEST(LogSink, a_file_is_appended_to_with_times) {
    const TemporaryFolder folder;
    for (const char *text : {"one", "two"}) {
        LogSink sink({folder / "log", LogLevel::info});
        sink.write(LogLevel::info, text);
    }
    const std::string text = read_text(folder / "log");
    EXPECT_NE(text.find("Z one\n"), std::string::npos) << text;
    EXPECT_NE(text.find("Z two\n"), std::string::npos) << text;
}

TEST(LogSink, a_file_that_cannot_be_opened_is_refused) {
    EXPECT_THROW(LogSink({"/no/such/folder/log", LogLevel::info}), quiesce::InputError);
}

TEST(LogSink, a_full_disk_is_told_once_and_counted) {
    std::uint32_t lost = 0;
    const std::string text = stderr_of([&] {
        LogSink sink({"/dev/full", LogLevel::info});
        for (int i = 0; i < 5; ++i) {
            sink.write(LogLevel::info, "line");
        }
        lost = sink.lost();
    });
    EXPECT_EQ(lost, 5U);
    EXPECT_EQ(text, "quiesced: error: log file /dev/full: No space left on device; lines are "
                    "dropped until it takes them\n");
}

/// A limit on the file's size stands for the disk's end: write() fails with EFBIG, then works.
TEST(LogSink, a_disk_that_takes_lines_again_is_told_once) {
    const TemporaryFolder folder;
    std::signal(SIGXFSZ, SIG_IGN);
    rlimit before{};
    getrlimit(RLIMIT_FSIZE, &before);
    const std::string text = stderr_of([&] {
        LogSink sink({folder / "log", LogLevel::info});
        sink.write(LogLevel::info, "before" + std::string(150, '.')); // more than stderr gets
        const rlimit none = {std::filesystem::file_size(folder / "log"), before.rlim_max};
        setrlimit(RLIMIT_FSIZE, &none);
        sink.write(LogLevel::info, "lost");
        sink.write(LogLevel::info, "lost");
        setrlimit(RLIMIT_FSIZE, &before);
        sink.write(LogLevel::info, "after");
        sink.write(LogLevel::info, "later");
        EXPECT_EQ(sink.lost(), 2U);
    });
    EXPECT_NE(text.find("takes lines again; 2 are missing\n"), std::string::npos) << text;
    const std::string log = read_text(folder / "log");
    EXPECT_NE(log.find("before"), std::string::npos);
    EXPECT_EQ(log.find("lost"), std::string::npos);
    EXPECT_NE(log.find("later\n"), std::string::npos);
}

/// What a controller says of a fault in its first tick and of none in the next.
void enter_and_heal(ChangeLog &changes, std::uint32_t fault, std::uint32_t tick) {
    quiesce_telemetry_t telemetry{};
    telemetry.tick = tick;
    telemetry.state = QUIESCE_STATE_SAFE;
    telemetry.fault = fault;
    changes.control(telemetry);
    telemetry.state = QUIESCE_STATE_IDLE;
    telemetry.fault = QUIESCE_FAULT_NONE;
    changes.control(telemetry);
}

TEST(ChangeLog, a_fault_that_comes_again_and_again_leaves_the_others) {
    LogRing ring;
    ChangeLog changes(ring);
    enter_and_heal(changes, QUIESCE_FAULT_ESTOP, 1);
    for (std::uint32_t i = 0; i < 2 * Snapshot::kFaults; ++i) {
        enter_and_heal(changes, QUIESCE_FAULT_TICK_LOST, 10 + i);
    }
    EXPECT_EQ(changes.faults()[0].fault, static_cast<std::uint32_t>(QUIESCE_FAULT_TICK_LOST));
    EXPECT_EQ(changes.faults()[0].tick, 9 + 2 * Snapshot::kFaults);
    EXPECT_EQ(changes.faults()[0].times, 2 * Snapshot::kFaults);
    EXPECT_EQ(changes.faults()[1].fault, static_cast<std::uint32_t>(QUIESCE_FAULT_ESTOP));
    EXPECT_EQ(changes.faults()[1].tick, 1U);
    EXPECT_EQ(changes.faults()[1].times, 1U);
    EXPECT_EQ(changes.faults()[2].fault, static_cast<std::uint32_t>(QUIESCE_FAULT_NONE));
}

TEST(ChangeLog, the_newest_is_first_and_the_oldest_goes) {
    LogRing ring;
    ChangeLog changes(ring);
    for (std::uint32_t fault = 1; fault <= Snapshot::kFaults + 1; ++fault) {
        enter_and_heal(changes, fault, fault);
    }
    enter_and_heal(changes, 3, 100);
    EXPECT_EQ(changes.faults()[0].fault, 3U);
    EXPECT_EQ(changes.faults()[0].times, 2U);
    EXPECT_EQ(changes.faults()[1].fault, Snapshot::kFaults + 1);
    EXPECT_EQ(changes.faults()[Snapshot::kFaults - 1].fault, 2U);
}

} // namespace
} // namespace quiesced
