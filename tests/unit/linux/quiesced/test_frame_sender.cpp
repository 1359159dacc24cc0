// What leaves on a line that does not take all.
#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <vector>

#include "frame_sender.h"

namespace quiesced {
namespace {

constexpr std::int64_t kTick_ns = 1'000'000;
constexpr std::uint32_t kDemandId = QUIESCE_CAN_CURRENT_DEMAND_FRAME_ID;
constexpr std::uint32_t kReplyId = QUIESCE_CAN_SERVICE_REPLY_FRAME_ID;

can_frame_t frame_of(std::uint32_t message, std::uint32_t number = 0) {
    const auto &row = quiesce_can_messages[message].e2e;
    can_frame_t frame{row.id, row.length, false, false, {}};
    frame.data[0] = static_cast<std::uint8_t>(number);
    frame.data[1] = static_cast<std::uint8_t>(number >> 8U);
    return frame;
}

/// A line that takes bytes at a rate, in SLCAN's characters.
class Line {
  public:
    explicit Line(double bytes_per_tick) : per_tick_(bytes_per_tick) {}

    static bool take(void *self, const can_frame_t *frame) {
        auto &line = *static_cast<Line *>(self);
        const double bytes = bytes_of(*frame);
        if (line.room_ < bytes) {
            return false;
        }
        line.room_ -= bytes;
        line.taken.push_back(*frame);
        return true;
    }

    static double bytes_of(const can_frame_t &frame) { return 6.0 + 2.0 * frame.length; }

    void pass() { room_ = std::min(room_ + per_tick_, 64.0); }

    std::vector<can_frame_t> taken;

  private:
    double per_tick_;
    double room_ = 0.0;
};

std::vector<std::uint32_t> ids(const Line &line) {
    std::vector<std::uint32_t> found;
    for (const can_frame_t &frame : line.taken) {
        found.push_back(frame.id);
    }
    return found;
}

std::int64_t send(FrameSender &sender, Line &line, const std::vector<can_frame_t> &frames,
                  std::int64_t now_ns = kTick_ns) {
    return sender.send(Line::take, &line, frames.data(), static_cast<std::uint32_t>(frames.size()),
                       now_ns);
}

TEST(FrameSender, knows_whether_the_demand_has_left) {
    FrameSender sender;
    Line full(0);
    Line idle(1000);
    idle.pass();
    EXPECT_EQ(send(sender, idle, {frame_of(QUIESCE_CAN_AT_SERVICE_REPLY)}), 0);
    EXPECT_EQ(send(sender, idle, {}), 0);
    EXPECT_EQ(send(sender, full, {frame_of(QUIESCE_CAN_AT_CURRENT_DEMAND)}), 0);
    idle.pass();
    EXPECT_EQ(send(sender, idle, {frame_of(QUIESCE_CAN_AT_CURRENT_DEMAND)}), kTick_ns);
    EXPECT_EQ(sender.counters().refused, 1U);
}

TEST(FrameSender, goes_by_class) {
    FrameSender sender;
    Line line(64);
    line.pass();
    (void)send(sender, line,
               {frame_of(QUIESCE_CAN_AT_RAW_SAMPLE), frame_of(QUIESCE_CAN_AT_FAULT_FREEZE),
                frame_of(QUIESCE_CAN_AT_SERVICE_REPLY), frame_of(QUIESCE_CAN_AT_CURRENT_DEMAND)});
    line.pass();
    (void)send(sender, line, {});
    EXPECT_EQ(ids(line),
              (std::vector<std::uint32_t>{kDemandId, kReplyId, QUIESCE_CAN_FAULT_FREEZE_FRAME_ID,
                                          QUIESCE_CAN_RAW_SAMPLE_FRAME_ID}));
    EXPECT_EQ(sender.counters().unsent.telemetry, 0U);
    EXPECT_EQ(sender.counters().unsent.demands, 0U);
}

TEST(FrameSender, a_newer_frame_replaces_the_one_that_waits) {
    FrameSender sender;
    Line line(0);
    for (std::uint32_t i = 0; i < 10; ++i) {
        (void)send(
            sender, line,
            {frame_of(QUIESCE_CAN_AT_CURRENT_DEMAND, i), frame_of(QUIESCE_CAN_AT_MOTION, i)});
    }
    EXPECT_EQ(sender.counters().unsent.demands, 9U);
    EXPECT_EQ(sender.counters().unsent.telemetry, 9U);
    Line idle(64);
    idle.pass();
    (void)send(sender, idle, {});
    ASSERT_EQ(idle.taken.size(), 2U);
    EXPECT_EQ(idle.taken[0].data[0], 9);
    EXPECT_EQ(idle.taken[1].data[0], 9);
}

TEST(FrameSender, replies_wait_in_their_order_and_what_has_no_room_is_lost) {
    FrameSender sender;
    Line line(0);
    for (std::uint32_t i = 0; i < 6; ++i) {
        (void)send(sender, line, {frame_of(QUIESCE_CAN_AT_SERVICE_REPLY, i)});
    }
    EXPECT_EQ(sender.counters().unsent.answers, 2U);
    Line idle(64);
    for (int i = 0; i < 2; ++i) {
        idle.pass();
        (void)send(sender, idle, {});
    }
    ASSERT_EQ(idle.taken.size(), 4U);
    for (std::uint8_t i = 0; i < 4; ++i) {
        EXPECT_EQ(idle.taken[i].data[0], i);
    }
}

TEST(FrameSender, frames_of_a_transfer_wait_in_their_order_behind_replies) {
    FrameSender sender;
    Line line(0);
    for (std::uint32_t i = 0; i < 10; ++i) {
        (void)send(sender, line, {frame_of(QUIESCE_CAN_AT_TABLE_FLOW, i)});
    }
    (void)send(sender, line, {frame_of(QUIESCE_CAN_AT_SERVICE_REPLY)});
    EXPECT_EQ(sender.counters().unsent.answers, 2U);
    EXPECT_EQ(sender.counters().unsent.telemetry, 0U);
    Line idle(64);
    for (int i = 0; i < 5; ++i) {
        idle.pass();
        (void)send(sender, idle, {});
    }
    ASSERT_EQ(idle.taken.size(), 9U);
    EXPECT_EQ(idle.taken[0].id, kReplyId);
    for (std::uint8_t i = 0; i < 8; ++i) {
        EXPECT_EQ(idle.taken[i + 1U].id, std::uint32_t{QUIESCE_CAN_TABLE_FLOW_FRAME_ID});
        EXPECT_EQ(idle.taken[i + 1U].data[0], i);
    }
}

TEST(FrameSender, a_change_of_the_output_stage_goes_before_what_waits) {
    FrameSender sender;
    Line line(22);
    line.pass();
    (void)send(sender, line, {frame_of(QUIESCE_CAN_AT_CURRENT_DEMAND)});
    (void)send(sender, line,
               {frame_of(QUIESCE_CAN_AT_CURRENT_DEMAND), frame_of(QUIESCE_CAN_AT_SERVICE_REPLY)});
    can_frame_t off = frame_of(QUIESCE_CAN_AT_CURRENT_DEMAND, 7);
    off.data[2] = 1;
    line.pass();
    (void)send(sender, line, {off});
    EXPECT_EQ(line.taken.back().data[0], 7);
}

/// Half a minute of a controller that streams raw samples, answers a request every 10 ms and sends
/// freeze frames, on a line with half of the rate that all of it needs.
struct Congestion {
    std::uint32_t replies = 0;
    std::uint32_t answered = 0;     ///< within a second
    std::int64_t demand_gap_ns = 0; ///< the longest
    std::uint32_t demands_late = 0; ///< gaps beyond the driver's timeout
    std::uint32_t demands = 0;
    std::uint32_t statuses = 0;
    SendCounters counters{};
};

std::vector<can_frame_t> frames_of_tick(std::uint32_t tick, std::uint32_t &replies) {
    std::vector<can_frame_t> frames{frame_of(QUIESCE_CAN_AT_CURRENT_DEMAND, tick)};
    for (std::uint32_t message = 0; message < QUIESCE_CAN_MESSAGES; ++message) {
        const auto &row = quiesce_can_messages[message];
        if (row.e2e.id >= QUIESCE_CAN_STATUS_FRAME_ID && row.cycle_ms != 0 &&
            tick % row.cycle_ms == row.start_ms) {
            frames.push_back(frame_of(message, tick));
        }
    }
    if (tick % 10 == 5) {
        frames.push_back(frame_of(QUIESCE_CAN_AT_SERVICE_REPLY, replies++));
    }
    return frames;
}

double bytes_per_tick() {
    double bytes = 0.0;
    std::uint32_t replies = 0;
    for (std::uint32_t tick = 0; tick < 1000; ++tick) {
        for (const can_frame_t &frame : frames_of_tick(tick, replies)) {
            bytes += Line::bytes_of(frame);
        }
    }
    return bytes / 1000.0;
}

Congestion run(double share, std::uint32_t ticks) {
    Congestion found;
    FrameSender sender;
    Line line(share * bytes_per_tick());
    std::map<std::uint32_t, std::uint32_t> asked;
    std::int64_t last_demand_ns = 0;
    for (std::uint32_t tick = 0; tick < ticks; ++tick) {
        const std::int64_t now_ns = tick * kTick_ns;
        const std::uint32_t before = found.replies;
        const std::vector<can_frame_t> frames = frames_of_tick(tick, found.replies);
        if (found.replies != before) {
            asked[before & 0xFFFFU] = tick;
        }
        line.pass();
        line.taken.clear();
        (void)send(sender, line, frames, now_ns);
        for (const can_frame_t &frame : line.taken) {
            const std::uint32_t number = frame.data[0] | static_cast<std::uint32_t>(frame.data[1])
                                                             << 8U;
            if (frame.id == kReplyId) {
                found.answered += tick - asked.at(number) <= 1000 ? 1U : 0U;
            } else if (frame.id == kDemandId) {
                found.demand_gap_ns = std::max(found.demand_gap_ns, now_ns - last_demand_ns);
                found.demands_late += now_ns - last_demand_ns >= 10 * kTick_ns ? 1U : 0U;
                ++found.demands;
                last_demand_ns = now_ns;
            }
            found.statuses += frame.id == QUIESCE_CAN_STATUS_FRAME_ID ? 1U : 0U;
        }
    }
    found.counters = sender.counters();
    return found;
}

TEST(FrameSender, half_a_line_loses_no_demand_and_answers_all) {
    const std::uint32_t ticks = 30000;
    const Congestion found = run(0.5, ticks);
    RecordProperty("congested_demand_lost", static_cast<int>(found.demands_late));
    RecordProperty("congested_demand_replaced", static_cast<int>(ticks - found.demands));
    RecordProperty("congested_replies", static_cast<int>(found.replies));
    RecordProperty("congested_answered", static_cast<int>(found.answered));
    RecordProperty("longest_demand_gap_us", static_cast<int>(found.demand_gap_ns / 1000));
    EXPECT_GE(found.answered * 100, found.replies * 99);
    EXPECT_EQ(found.counters.unsent.answers, 0U);
    EXPECT_LT(found.demand_gap_ns, 10 * kTick_ns); // CurrentDemand's timeout
    EXPECT_GE(found.statuses, ticks / 10 * 99 / 100);
    EXPECT_GT(found.counters.unsent.telemetry, 1000U);
}

std::uint32_t said_telemetry(const SendCounters &counters) {
    can_frame_t frame{};
    struct quiesce_can_can_shed_t said {};
    can_pack_shed(&counters.unsent, &frame);
    (void)quiesce_can_can_shed_unpack(&said, frame.data, sizeof frame.data);
    return said.unsent_telemetry;
}

/// CanShed has the same numbers, and they still move in the last second of a minute.
TEST(FrameSender, what_is_shed_in_a_congested_minute_is_said_to_the_end) {
    const Congestion almost = run(0.5, 59000);
    const Congestion minute = run(0.5, 60000);
    EXPECT_GT(minute.counters.unsent.telemetry, 10000U);
    EXPECT_EQ(said_telemetry(minute.counters), minute.counters.unsent.telemetry);
    EXPECT_GT(said_telemetry(minute.counters), said_telemetry(almost.counters));
}

TEST(FrameSender, a_whole_line_sheds_nothing) {
    const Congestion found = run(1.6, 5000);
    EXPECT_EQ(found.counters.unsent.telemetry, 0U);
    EXPECT_EQ(found.counters.unsent.demands, 0U);
    EXPECT_EQ(found.answered, found.replies);
    EXPECT_LE(found.demand_gap_ns, kTick_ns);
}

} // namespace
} // namespace quiesced
