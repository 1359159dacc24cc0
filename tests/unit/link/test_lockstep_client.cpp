/// The bench's side of the lock-step protocol, against the real server and against hostile ones.
#include "lockstep_client.h"

#include <atomic>
#include <cstring>
#include <sys/socket.h>

#include "can_link.h"
#include "comparing_link.h"
#include "descriptor_stream.h"
#include "images.h"
#include "in_process_link.h"
#include "lockstep_peer.h"
#include "slcan_channel.h"

namespace quiesce {
namespace {

using std::chrono::milliseconds;

constexpr std::uint32_t kControl = QUIESCE_CAN_LOCKSTEP_CONTROL_FRAME_ID;
constexpr std::uint32_t kStimulus = QUIESCE_CAN_LOCKSTEP_STIMULUS_FRAME_ID;
constexpr milliseconds kImpatient(150);

std::unique_ptr<FrameChannel> channel_on(FileDescriptor end) {
    return make_slcan_channel(std::make_unique<DescriptorStream>(std::move(end), "line"), 0);
}

/// A link to a peer in this process.
struct Rig {
    explicit Rig(Tamper tamper = {}, CanLinkOptions options = {})
        : Rig(socket_pair(SOCK_STREAM), std::move(tamper), options) {}

    std::unique_ptr<LockstepPeer> peer;
    std::unique_ptr<CanLink> link;

  private:
    Rig(std::pair<FileDescriptor, FileDescriptor> ends, Tamper tamper,
        const CanLinkOptions &options)
        : peer(std::make_unique<LockstepPeer>(std::move(ends.second), std::move(tamper))),
          link(std::make_unique<CanLink>(channel_on(std::move(ends.first)), options)) {}
};

CanLinkOptions impatient_options() {
    CanLinkOptions options;
    options.greeting_time = kImpatient;
    options.answer_time = kImpatient;
    return options;
}

/// The error of a link whose answers to stimuli are tampered with from the third tick on.
std::string error_on_third_tick(const Tamper &tamper) {
    int ticks = 0;
    const Rig rig(
        [&](const can_frame_t &request, std::vector<can_frame_t> &replies) {
            return request.id == kStimulus && ++ticks >= 3 ? tamper(request, replies)
                                                           : std::optional<std::string>("");
        },
        impatient_options());
    rig.link->start(nullptr, default_params(), {});
    lockstep_reply_t reply;
    rig.link->exchange(varied_stimulus(0), reply);
    rig.link->exchange(varied_stimulus(1), reply);
    return error_of([&] { rig.link->exchange(varied_stimulus(2), reply); });
}

void expect_equal_to_host(CanLink &link, const std::string &rubbish_name = "") {
    InProcessLink host;
    ComparingLink comparing(host, link);
    ASSERT_TRUE(comparing.start(nullptr, default_params(), {})) << rubbish_name;
    lockstep_reply_t reply;
    for (std::uint32_t tick = 1600; tick < 1900; ++tick) { // estop and reset are in here
        comparing.exchange(varied_stimulus(tick), reply);
    }
    EXPECT_EQ(comparing.mismatches(), 0u) << rubbish_name;
    EXPECT_GE(comparing.compared_words(), 300u * kCommandWords);
}

TEST(lockstep_client, full_telemetry_equals_the_host_through_a_restart) {
    const Rig rig;
    expect_equal_to_host(*rig.link);
    expect_equal_to_host(*rig.link);
    EXPECT_EQ(rig.link->received().count(), kWordsOverCan);
    EXPECT_TRUE(rig.link->is_complete());
}

TEST(lockstep_client, eight_sensors_and_four_dampers_equal_the_host) {
    const quiesce_board_t board = largest_board();
    const Rig rig;
    InProcessLink host;
    ComparingLink comparing(host, *rig.link);
    ASSERT_TRUE(comparing.start(&board, default_params(), {}));
    lockstep_reply_t reply;
    for (std::uint32_t tick = 1000; tick < 1900; ++tick) {
        comparing.exchange(varied_stimulus(tick), reply);
    }
    EXPECT_EQ(comparing.mismatches(), 0u);
    EXPECT_EQ(comparing.compared_words(), 900u * kWordsOverCan);
    // And back to one of each.
    expect_equal_to_host(*rig.link);
}

TEST(lockstep_client, refused_board_is_refused_on_both_sides) {
    quiesce_board_t board = largest_board();
    board.damper[3].safe_mA = 20001;
    const Rig rig;
    InProcessLink host;
    ComparingLink comparing(host, *rig.link);
    EXPECT_FALSE(comparing.start(&board, default_params(), {}));
}

TEST(lockstep_client, less_telemetry_says_which_words_are_of_this_tick) {
    CanLinkOptions options;
    options.telemetry.every_ticks = 10;
    const Rig rig({}, options);
    EXPECT_FALSE(rig.link->is_complete());
    InProcessLink host;
    ComparingLink comparing(host, *rig.link);
    comparing.start(nullptr, default_params(), {});
    lockstep_reply_t reply;
    for (std::uint32_t tick = 0; tick < 100; ++tick) {
        comparing.exchange(varied_stimulus(tick), reply);
        EXPECT_EQ(rig.link->received().count(), tick % 10 == 9 ? kWordsOverCan : kCommandWords);
    }
    EXPECT_EQ(comparing.mismatches(), 0u);
    EXPECT_EQ(comparing.compared_words(), 90u * kCommandWords + 10u * kWordsOverCan);
}

TEST(lockstep_client, refused_parameter_is_named_by_its_index) {
    quiesce_params_t params = default_params();
    quiesce_param_set(&params, 7, -1);
    quiesce_param_error_t error;
    ASSERT_FALSE(quiesce_params_check(&params, &error));
    auto ends = socket_pair(SOCK_STREAM);
    const LockstepPeer peer(std::move(ends.second));
    const auto channel = channel_on(std::move(ends.first));
    LockstepClient client(*channel, {});
    const StartAnswer answer = client.start(nullptr, params, {});
    EXPECT_FALSE(answer);
    EXPECT_EQ(answer.param, error.index);
}

TEST(lockstep_client, target_that_starts_late_is_asked_until_it_answers) {
    int questions = 0; // the first three find nobody
    const Rig rig([&](const can_frame_t &request, std::vector<can_frame_t> &replies) {
        if (request.id == kControl && ++questions <= 3) {
            replies.clear();
        }
        return std::optional<std::string>("");
    });
    expect_equal_to_host(*rig.link);
    EXPECT_GT(questions, 3);
}

TEST(lockstep_client, late_answers_to_many_questions_are_not_mistaken_for_others) {
    const Rig rig([&](const can_frame_t &, std::vector<can_frame_t> &replies) {
        if (!replies.empty() && replies[0].id == QUIESCE_CAN_LOCKSTEP_STATUS_FRAME_ID &&
            (replies[0].data[0] & 1u) == 0) { // before the start
            const can_frame_t status = replies[0];
            replies.insert(replies.end(), 5, status);
        }
        return std::optional<std::string>("");
    });
    expect_equal_to_host(*rig.link);
}

TEST(lockstep_client, what_an_earlier_bench_left_under_way_does_not_disturb) {
    auto ends = socket_pair(SOCK_STREAM);
    const LockstepPeer peer(std::move(ends.second));
    const int number = dup(ends.first.number());
    {
        const auto channel = channel_on(std::move(ends.first));
        LockstepClient earlier(*channel, {});
        ASSERT_TRUE(earlier.start(nullptr, default_params(), {}));
        lockstep_reply_t reply;
        earlier.exchange(varied_stimulus(0), reply);
        const std::string last = "t60340000001F\rt60140"; // a tick nobody waits for, half a line
        ASSERT_EQ(write(number, last.data(), last.size()), static_cast<ssize_t>(last.size()));
    }
    CanLink link(channel_on(FileDescriptor(number)), {});
    expect_equal_to_host(link);
}

TEST(lockstep_client, rubbish_and_other_traffic_between_the_answers_are_passed_over) {
    const std::vector<std::pair<const char *, std::string>> kRubbish = {
        {"broken lines", "\rt603\rt6034ZZ\r\r\r"},
        {"long line", std::string(10000, 'A') + "\r"},
        {"other bytes", "\xFF\xFE\r"},
        {"zeros", std::string(300, '\0') + "\n"},
        {"an adapter's answers", "z\rZ\r\aV1013\rF00\r"},
        {"other messages", "t0108000102030405060 7\rt1008FFFFFFFFFFFFFFFF\rt7FF0\rt5FF0\rt6800\r"},
        {"extended and remote frames of the same ids", "T0000060A400000000\rr60A4\rR000006084\r"},
    };
    for (const auto &[name, bytes] : kRubbish) {
        const std::string before = bytes;
        const Rig rig([before](const can_frame_t &, std::vector<can_frame_t> &) {
            return std::optional(before);
        });
        expect_equal_to_host(*rig.link, name);
    }
}

TEST(lockstep_client, nobody_answers) {
    auto ends = socket_pair(SOCK_STREAM);
    CanLink link(channel_on(std::move(ends.first)), impatient_options());
    EXPECT_EQ(error_of([&] { link.start(nullptr, default_params(), {}); }),
              "line: no target answers within 150 ms; is quiesced --lockstep running at the other "
              "end?");
}

TEST(lockstep_client, target_that_falls_silent) {
    expect_contains(error_on_third_tick([](const can_frame_t &, std::vector<can_frame_t> &replies) {
                        replies.clear();
                        return std::optional<std::string>("");
                    }),
                    "line: no answer within 150 ms; is quiesced");
}

TEST(lockstep_client, line_that_closes_in_mid_run) {
    EXPECT_EQ(error_on_third_tick([](const can_frame_t &, std::vector<can_frame_t> &) {
                  return std::optional<std::string>();
              }),
              "line: the other side has closed the line");
}

TEST(lockstep_client, lost_telemetry_is_no_error_but_a_lost_command_is_a_silence) {
    expect_contains(error_on_third_tick([](const can_frame_t &, std::vector<can_frame_t> &replies) {
                        replies.pop_back();
                        return std::optional<std::string>("");
                    }),
                    "no answer within");
}

TEST(lockstep_client, wrong_sequence_number) {
    expect_contains(error_on_third_tick([](const can_frame_t &, std::vector<can_frame_t> &replies) {
                        replies.back().data[3] ^= 0x10;
                        return std::optional<std::string>("");
                    }),
                    "line: answers out of sequence");
}

TEST(lockstep_client, command_of_wrong_length) {
    expect_contains(error_on_third_tick([](const can_frame_t &, std::vector<can_frame_t> &replies) {
                        replies.back().length = 3;
                        return std::optional<std::string>("");
                    }),
                    "line: answers out of sequence");
}

TEST(lockstep_client, unexpected_message_in_a_tick) {
    expect_contains(error_on_third_tick([](const can_frame_t &, std::vector<can_frame_t> &replies) {
                        replies[0].id = QUIESCE_CAN_LOCKSTEP_STATUS_FRAME_ID;
                        return std::optional<std::string>("");
                    }),
                    "line: answers a stimulus with an unexpected message, 0x608");
}

TEST(lockstep_client, telemetry_without_end) {
    expect_contains(error_on_third_tick([](const can_frame_t &, std::vector<can_frame_t> &replies) {
                        replies.insert(replies.begin(), 1000, replies[0]);
                        return std::optional<std::string>("");
                    }),
                    "line: answers a stimulus with more telemetry than there is");
}

TEST(lockstep_client, other_traffic_without_end_is_no_answer) {
    auto ends = socket_pair(SOCK_STREAM);
    std::atomic<bool> is_over = false;
    std::thread flood([&] {
        const std::string lines = "t0108000102030405060A\rrubbish\r";
        while (!is_over &&
               send(ends.second.number(), lines.data(), lines.size(), MSG_NOSIGNAL) > 0) {
        }
    });
    {
        CanLink link(channel_on(std::move(ends.first)), impatient_options());
        expect_contains(error_of([&] { link.start(nullptr, default_params(), {}); }),
                        "no target answers");
        is_over = true;
    }
    flood.join();
}

TEST(lockstep_client, bench_that_hears_itself) {
    const Rig rig([](const can_frame_t &request, std::vector<can_frame_t> &replies) {
        if (request.id == QUIESCE_CAN_LOCKSTEP_PARAM_WRITE_FRAME_ID && request.data[1] != 0xFF) {
            replies = {request};
        }
        return std::optional<std::string>("");
    });
    expect_contains(error_of([&] { rig.link->start(nullptr, default_params(), {}); }),
                    "line: answers with message 0x601 of 6 bytes instead of 0x609");
}

TEST(lockstep_client, target_that_was_built_from_other_sources) {
    const Rig rig([](const can_frame_t &, std::vector<can_frame_t> &replies) {
        if (!replies.empty() && replies[0].id == QUIESCE_CAN_LOCKSTEP_STATUS_FRAME_ID) {
            replies[0].data[3]++; // telemetry words
        }
        return std::optional<std::string>("");
    });
    expect_contains(error_of([&] { rig.link->start(nullptr, default_params(), {}); }),
                    "line: the target was built from other sources");
}

TEST(lockstep_client, target_that_stores_another_value) {
    const Rig rig([](const can_frame_t &, std::vector<can_frame_t> &replies) {
        if (!replies.empty() && replies[0].id == QUIESCE_CAN_LOCKSTEP_PARAM_ACK_FRAME_ID) {
            replies[0].data[2] ^= 1u;
        }
        return std::optional<std::string>("");
    });
    expect_contains(error_of([&] { rig.link->start(nullptr, default_params(), {}); }),
                    "line: the target does not store parameter 0; rebuild it");
}

TEST(lockstep_client, mismatch_in_a_word_of_the_tick_is_found_and_an_older_word_is_none) {
    CanLinkOptions options;
    options.telemetry.every_ticks = 10;
    const Rig rig(
        [ticks = 0](const can_frame_t &request, std::vector<can_frame_t> &replies) mutable {
            if (request.id == kStimulus && ++ticks == 20) {
                replies[5].data[0] ^= 1u; // word 5 of the burst
            }
            return std::optional<std::string>("");
        },
        options);
    InProcessLink host;
    ComparingLink comparing(host, *rig.link, Answer::Checked);
    comparing.start(nullptr, default_params(), {});
    for (std::uint32_t tick = 0; tick < 30; ++tick) {
        lockstep_reply_t reply;
        comparing.exchange(varied_stimulus(tick), reply);
        EXPECT_EQ(reply.telemetry.tick, tick + 1) << "older words are the host's";
    }
    EXPECT_EQ(comparing.mismatches(), 1u);
    ASSERT_TRUE(comparing.first_mismatch());
    EXPECT_EQ(comparing.first_mismatch()->tick, 19);
    EXPECT_EQ(comparing.first_mismatch()->field, "accel_um_s2");
}

TEST(lockstep_client, values_that_do_not_fit_their_signal_are_refused) {
    const Rig rig;
    lockstep_reply_t reply;
    rig.link->start(nullptr, default_params(), {});
    expect_contains(error_of([&] {
                        rig.link->exchange({LOCKSTEP_FRESH, {1 << 23}, {0}}, reply);
                    }),
                    "counts 8388608: does not fit");
    expect_contains(error_of([&] {
                        rig.link->exchange({LOCKSTEP_HAS_CURRENT, {0}, {-(1 << 23) - 1}}, reply);
                    }),
                    "current_meas_mA -8388609: does not fit");
    expect_contains(error_of([&] {
                        rig.link->exchange({LOCKSTEP_LOST, {0}, {0}}, reply);
                    }),
                    "fault lost_tick: there is no CAN message for it");
    rig.link->exchange({LOCKSTEP_FRESH, {-(1 << 23)}, {0}}, reply);
    EXPECT_EQ(reply.telemetry.tick, 1u);
}

} // namespace
} // namespace quiesce
