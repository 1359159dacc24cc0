/// `quiesced --lockstep` on a pty against the lock-step server of the host library: every frame of
/// every answer is the same, byte for byte.
#include <gtest/gtest.h>

#include <array>
#include <cerrno>
#include <csignal>
#include <cstring>
#include <deque>
#include <string>

#include <fcntl.h>
#include <poll.h>
#include <sys/wait.h>
#include <termios.h>
#include <unistd.h>

#include "temporary_folder.h"

extern "C" {
#include "lockstep_can.h"
}

#include "slcan.h"

namespace {

constexpr int kPatience_ms = 60000;

bool is_equal(const can_frame_t &a, const can_frame_t &b) {
    return a.id == b.id && a.length == b.length && std::memcmp(a.data, b.data, a.length) == 0;
}

class Lockstep : public testing::Test {
  protected:
    void SetUp() override {
        master_ = posix_openpt(O_RDWR | O_NOCTTY | O_CLOEXEC);
        ASSERT_GE(master_, 0);
        ASSERT_EQ(grantpt(master_), 0);
        ASSERT_EQ(unlockpt(master_), 0);
        slave_ = open(ptsname(master_), O_RDWR | O_NOCTTY | O_CLOEXEC);
        termios raw{};
        ASSERT_EQ(tcgetattr(slave_, &raw), 0);
        cfmakeraw(&raw);
        ASSERT_EQ(tcsetattr(slave_, TCSANOW, &raw), 0);
        const std::string config = folder_ / "q.toml";
        write_text(config, "[can]\ninterface = \"slcan:" + std::string(ptsname(master_)) + "\"\n");
        slcan_decoder_init(&decoder_);
        lockstep_can_init(&host_);
        pid_ = fork();
        if (pid_ == 0) {
            execl(QUIESCED_PROGRAM, "quiesced", "--config", config.c_str(), "--lockstep", nullptr);
            _exit(127);
        }
        can_frame_t greeting;
        lockstep_can_greet(&host_, &greeting);
        EXPECT_TRUE(is_equal(receive(), greeting));
    }

    void TearDown() override {
        if (pid_ > 0) {
            kill(pid_, SIGKILL);
            (void)wait_for_end();
        }
        close(slave_);
        close(master_);
    }

    int wait_for_end() {
        int status = 0;
        EXPECT_EQ(waitpid(pid_, &status, 0), pid_);
        pid_ = -1;
        return status;
    }

    can_frame_t receive() {
        can_frame_t frame{};
        for (;;) {
            while (!input_.empty()) {
                const auto byte = static_cast<std::uint8_t>(input_.front());
                input_.pop_front();
                if (slcan_decode(&decoder_, byte, &frame)) {
                    return frame;
                }
            }
            pollfd ready = {master_, POLLIN, 0};
            std::array<char, 4096> bytes;
            const ssize_t count =
                poll(&ready, 1, kPatience_ms) == 1 ? read(master_, bytes.data(), bytes.size()) : -1;
            if (count <= 0) {
                ADD_FAILURE() << "the program does not answer";
                return frame;
            }
            input_.insert(input_.end(), bytes.begin(), bytes.begin() + count);
        }
    }

    void send(const can_frame_t &frame) {
        std::array<std::uint8_t, SLCAN_MAX_BYTES> line;
        const std::size_t length = slcan_encode(&frame, line.data());
        ASSERT_EQ(write(master_, line.data(), length), static_cast<ssize_t>(length));
    }

    /// Both take the frame. Returns the number of replies, all of them equal.
    std::uint32_t exchange(const can_frame_t &frame) {
        std::array<can_frame_t, LOCKSTEP_CAN_MAX_REPLIES> replies;
        const std::uint32_t count = lockstep_can_receive(&host_, &frame, replies.data());
        send(frame);
        for (std::uint32_t i = 0; i < count; ++i) {
            EXPECT_TRUE(is_equal(receive(), replies[i])) << "reply " << i;
        }
        return count;
    }

    void control(std::uint8_t operation, std::uint8_t telemetry_frames) {
        quiesce_can_lockstep_control_t message{};
        message.operation = operation;
        message.telemetry_frames = telemetry_frames;
        message.telemetry_every_ticks = 1;
        can_frame_t frame{};
        frame.id = QUIESCE_CAN_LOCKSTEP_CONTROL_FRAME_ID;
        frame.length = QUIESCE_CAN_LOCKSTEP_CONTROL_LENGTH;
        quiesce_can_lockstep_control_pack(frame.data, &message, sizeof frame.data);
        EXPECT_EQ(exchange(frame), 1U);
    }

    void set_law(std::int32_t law) {
        quiesce_can_lockstep_param_write_t message{};
        message.param_index = 15;
        message.param_value = law;
        can_frame_t frame{};
        frame.id = QUIESCE_CAN_LOCKSTEP_PARAM_WRITE_FRAME_ID;
        frame.length = QUIESCE_CAN_LOCKSTEP_PARAM_WRITE_LENGTH;
        quiesce_can_lockstep_param_write_pack(frame.data, &message, sizeof frame.data);
        EXPECT_EQ(exchange(frame), 1U);
    }

    void stimulus(std::int32_t counts, bool is_fresh) {
        quiesce_can_lockstep_stimulus_t message{};
        message.accel_counts = counts;
        message.accel_is_fresh = is_fresh;
        message.enable = 1;
        message.sequence = sequence_;
        sequence_ = static_cast<std::uint8_t>((sequence_ + 1) % LOCKSTEP_CAN_SEQUENCE_PERIOD);
        can_frame_t frame{};
        frame.id = QUIESCE_CAN_LOCKSTEP_STIMULUS_FRAME_ID;
        frame.length = QUIESCE_CAN_LOCKSTEP_STIMULUS_LENGTH;
        quiesce_can_lockstep_stimulus_pack(frame.data, &message, sizeof frame.data);
        EXPECT_EQ(exchange(frame), QUIESCE_CAN_TELEMETRY_WORDS + 1U);
    }

    const TemporaryFolder folder_;
    int master_ = -1;
    int slave_ = -1;
    pid_t pid_ = -1;
    slcan_decoder_t decoder_{};
    std::deque<char> input_;
    lockstep_can_t host_{};
    std::uint8_t sequence_ = 0;
};

TEST_F(Lockstep, answers_like_the_host_library_and_ends_on_stop) {
    set_law(QUIESCE_LAW_PHASE);
    control(QUIESCE_CAN_LOCKSTEP_CONTROL_OPERATION_START_CHOICE, QUIESCE_CAN_TELEMETRY_WORDS);
    std::uint32_t random = 1;
    for (int tick = 0; tick < 2000 && !HasFailure(); ++tick) {
        random = random * 1664525U + 1013904223U;
        // A triangle of 10 Hz and noise; every 64th sample is missing.
        const std::int32_t phase = tick % 100;
        const std::int32_t counts = (phase < 50 ? phase : 100 - phase) * 3000 - 75000;
        stimulus(counts + static_cast<std::int32_t>(random >> 24U), tick % 64 != 63);
    }
    control(QUIESCE_CAN_LOCKSTEP_CONTROL_OPERATION_STOP_CHOICE, 0);
    EXPECT_EQ(wait_for_end(), 0);
}

TEST_F(Lockstep, counts_what_it_does_not_understand) {
    can_frame_t frame{};
    frame.id = QUIESCE_CAN_LOCKSTEP_STIMULUS_FRAME_ID;
    frame.length = 3;
    EXPECT_EQ(exchange(frame), 0U);
    const std::string noise = "\xfft60\rxyz\rt6034DEAD\r";
    ASSERT_EQ(write(master_, noise.data(), noise.size()), static_cast<ssize_t>(noise.size()));
    control(QUIESCE_CAN_LOCKSTEP_CONTROL_OPERATION_STATUS_CHOICE, 0);
}

TEST_F(Lockstep, ends_on_a_signal) {
    kill(pid_, SIGTERM);
    EXPECT_EQ(wait_for_end(), 0);
}

} // namespace
