#include "images.h"
#include "in_process_link.h"
#include "qemu_shm_link.h"

#include <cstring>

namespace quiesce {
namespace {

using std::chrono::steady_clock;

TEST(qemu_shm_link, answers_like_the_host_through_dropout_stop_and_restart) {
    InProcessLink host;
    QemuShmLink target(options_for(kShmImage));
    for (int run = 0; run < 2; ++run) {
        ASSERT_TRUE(host.start(nullptr, default_params(), {}));
        ASSERT_TRUE(target.start(nullptr, default_params(), {}));
        for (std::uint32_t tick = 0; tick < 2500; ++tick) {
            lockstep_reply_t expected, actual;
            host.exchange(varied_stimulus(tick), expected);
            target.exchange(varied_stimulus(tick), actual);
            ASSERT_EQ(std::memcmp(&expected, &actual, sizeof expected), 0) << "tick " << tick;
        }
    }
    const auto counts = target.finish();
    ASSERT_TRUE(counts);
    EXPECT_GE(counts->worst, counts->median);
    EXPECT_GT(counts->median, 100u);
}

TEST(qemu_shm_link, eight_sensors_and_four_dampers_answer_like_the_host) {
    const quiesce_board_t board = largest_board();
    InProcessLink host;
    QemuShmLink target(uncounted(kLargestImage));
    for (const std::int32_t law : {QUIESCE_LAW_CONSTANT, QUIESCE_LAW_FUZZY, QUIESCE_LAW_PHASE}) {
        quiesce_params_t params = default_params();
        params.law = law;
        ASSERT_TRUE(host.start(&board, params, {}));
        ASSERT_TRUE(target.start(&board, params, {}));
        for (std::uint32_t tick = 0; tick < 2500; ++tick) {
            lockstep_stimulus_t stimulus = varied_stimulus(tick);
            stimulus.flags |= tick % 7 != 0 ? LOCKSTEP_PICTURE : 0u;
            stimulus.flags |= tick % 211 == 210 ? LOCKSTEP_LOST : 0u;
            lockstep_reply_t expected, actual;
            host.exchange(stimulus, expected);
            target.exchange(stimulus, actual);
            ASSERT_EQ(std::memcmp(&expected, &actual, sizeof expected), 0) << "tick " << tick;
        }
    }
}

TEST(qemu_shm_link, small_build_refuses_a_large_board) {
    const quiesce_board_t board = largest_board();
    QemuShmLink target(uncounted(kShmImage));
    EXPECT_FALSE(target.start(&board, default_params(), {}));
    lockstep_reply_t reply;
    target.exchange(varied_stimulus(1), reply);
    EXPECT_EQ(reply.telemetry.fault, std::uint32_t{QUIESCE_FAULT_PARAMETER});
    EXPECT_EQ(reply.current_cmd_mA[0], 0);
    EXPECT_EQ(reply.drivers_enabled, 0u);
}

TEST(qemu_shm_link, refused_parameter_leaves_it_answering_like_the_host) {
    quiesce_params_t params = default_params();
    params.slew_mA_s = -1;
    InProcessLink host;
    QemuShmLink target(options_for(kShmImage));
    EXPECT_FALSE(host.start(nullptr, params, {}));
    EXPECT_FALSE(target.start(nullptr, params, {}));
    lockstep_reply_t expected, actual;
    host.exchange(varied_stimulus(1), expected);
    target.exchange(varied_stimulus(1), actual);
    EXPECT_EQ(actual.telemetry.fault, std::uint32_t{QUIESCE_FAULT_PARAMETER});
    EXPECT_EQ(std::memcmp(&expected, &actual, sizeof expected), 0);
}

TEST(qemu_shm_link, stack_use_is_reported_and_far_from_its_end) {
    QemuShmLink target(options_for(kShmImage));
    lockstep_reply_t reply;
    target.start(nullptr, default_params(), {});
    for (std::uint32_t tick = 0; tick < 2000; ++tick) {
        target.exchange(varied_stimulus(tick), reply);
    }
    target.finish();
    EXPECT_GT(target.stack_used_bytes(), 64u);
    EXPECT_LT(target.stack_used_bytes(), 4096u);
}

TEST(qemu_shm_link, missing_image_is_named) {
    expect_contains(error_of([] { QemuShmLink(options_for("no/such.elf")); }),
                    "image no/such.elf: cannot be read");
    // Where nothing counts, QEMU itself finds out.
    const std::string error = error_of(
        [] { QemuShmLink(uncounted("no/such.elf")).start(nullptr, default_params(), {}); });
    expect_contains(error, "image no/such.elf: qemu-system-arm ended with code 1: ");
}

TEST(qemu_shm_link, killed_emulator_is_noticed_at_once) {
    QemuShmLink target(options_for(kShmImage));
    lockstep_reply_t reply;
    target.start(nullptr, default_params(), {});
    target.exchange(varied_stimulus(0), reply);
    kill(target.process_id(), SIGKILL);
    const auto start = steady_clock::now();
    const std::string error = error_of([&] {
        for (std::uint32_t tick = 1; tick < 1000000; ++tick) {
            target.exchange(varied_stimulus(tick), reply);
        }
    });
    expect_contains(error, "was killed by signal 9");
    EXPECT_LT(steady_clock::now() - start, std::chrono::seconds(5));
}

TEST(qemu_shm_link, image_that_never_answers_is_given_up) {
    QemuShmLink target(impatient(kUartImage));
    expect_contains(error_of([&] { target.start(nullptr, default_params(), {}); }),
                    "no answer within 300 ms");
}

TEST(qemu_shm_link, halted_emulator_is_given_up_and_still_ended) {
    pid_t id = 0;
    {
        QemuOptions options = options_for(kShmImage);
        options.answer_time = std::chrono::milliseconds(2000);
        QemuShmLink target(options);
        lockstep_reply_t reply;
        target.start(nullptr, default_params(), {});
        id = target.process_id();
        kill(id, SIGSTOP);
        const std::string error = error_of([&] {
            for (std::uint32_t tick = 0; tick < 1000000; ++tick) { // the halt may take a moment
                target.exchange(varied_stimulus(tick), reply);
            }
        });
        expect_contains(error, "no answer within 2000 ms");
    }
    EXPECT_EQ(kill(id, 0), -1);
}

} // namespace
} // namespace quiesce
