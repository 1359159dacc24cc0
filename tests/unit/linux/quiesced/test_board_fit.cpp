/// Parameters that the controller would take and the board cannot do: in a file, saved, on SIGHUP,
/// and with APPLY on the bus (a pty that speaks SLCAN).
#include <gtest/gtest.h>

#include <csignal>
#include <thread>

#include <fcntl.h>
#include <poll.h>
#include <termios.h>
#include <unistd.h>

#include "board_fit.h"
#include "bus.h"
#include "loop.h"
#include "read_config.h"
#include "service.h"
#include "signals.h"
#include "temporary_folder.h"

extern "C" {
#include "can_make.h"
}

#include "slcan.h"

namespace quiesced {
namespace {

constexpr std::uint64_t kTicks = 25; // enough for a reply, few enough for the pty
const std::string kEdges = "[accel]\nsource = \"adxl355\"\ndevice = \"/dev/spidev0.0\"\n"
                           "[gpio]\ndata_ready_input = { line = \"D\" }\n";
const std::string kPwm = "[current]\noutput = \"pwm\"\nchip = \"pwmchip0\"\nfull_scale_mA = 5000\n"
                         "period_ns = 50000\n";

std::uint32_t index_of(const std::string &name) {
    std::uint32_t index = 0;
    while (name != quiesce_param_info(index)->name) {
        ++index;
    }
    return index;
}

class BoardFit : public testing::Test {
  protected:
    void SetUp() override {
        master_ = posix_openpt(O_RDWR | O_NOCTTY | O_CLOEXEC | O_NONBLOCK);
        ASSERT_GE(master_, 0);
        ASSERT_EQ(grantpt(master_), 0);
        ASSERT_EQ(unlockpt(master_), 0);
        slcan_decoder_init(&decoder_);
        write_config("");
        config_ = require_config(file(), Needs::peripherals);
    }

    void TearDown() override { close(master_); }

    std::string file() const { return folder_ / "q.toml"; }

    /// On this bus, with its state and log in the folder.
    void write_config(const std::string &parameters) {
        write_text(file(), "[can]\ninterface = \"slcan:" + std::string(ptsname(master_)) +
                               "\"\n[state]\nfolder = \"" + folder_.path() + "\"\n[log]\nto = \"" +
                               folder_ / "log" + "\"\n" + kEdges + kPwm +
                               "[parameters]\nlaw = \"constant\"\n" + parameters);
    }

    void send(const can_frame_t &frame) const {
        std::array<std::uint8_t, SLCAN_MAX_BYTES> line{};
        const std::size_t bytes = slcan_encode(&frame, line.data());
        ASSERT_EQ(write(master_, line.data(), bytes), static_cast<ssize_t>(bytes));
    }

    /// The reply among all that the controller has sent.
    quiesce_can_service_reply_t reply() {
        quiesce_can_service_reply_t found{};
        std::uint8_t byte = 0;
        can_frame_t frame;
        int replies = 0;
        while (read(master_, &byte, 1) == 1) {
            if (slcan_decode(&decoder_, byte, &frame) &&
                frame.id == QUIESCE_CAN_SERVICE_REPLY_FRAME_ID) {
                quiesce_can_service_reply_unpack(&found, frame.data, frame.length);
                ++replies;
            }
        }
        EXPECT_EQ(replies, 1);
        return found;
    }

    TemporaryFolder folder_;
    int master_ = -1;
    slcan_decoder_t decoder_{};
    Config config_;
};

TEST_F(BoardFit, the_configuration_fits_itself) {
    EXPECT_EQ(config_.sensors.front().rate_Hz, 1000U);
    EXPECT_FALSE(find_misfit(config_, config_.params));
}

TEST_F(BoardFit, the_ticks_must_be_as_fast_as_the_edges_that_start_them) {
    config_.params.tick_rate_Hz = 2000;
    const std::optional<Misfit> misfit = find_misfit(config_, config_.params);
    ASSERT_TRUE(misfit);
    EXPECT_EQ(misfit->index, index_of("tick_rate_Hz"));
    EXPECT_STREQ(misfit->reason.data(),
                 "accel.rate_Hz is 1000, tick_rate_Hz 2000; they must be the "
                 "same where data_ready_input starts the ticks");
    config_.gpio.data_ready_input.reset();
    EXPECT_FALSE(find_misfit(config_, config_.params));
}

TEST_F(BoardFit, the_current_must_be_within_the_output) {
    config_.params.max_current_mA = 5001;
    const std::optional<Misfit> misfit = find_misfit(config_, config_.params);
    ASSERT_TRUE(misfit);
    EXPECT_EQ(misfit->index, index_of("max_current_mA"));
    EXPECT_STREQ(misfit->reason.data(), "current.full_scale_mA is 5000, max_current_mA 5001; it "
                                        "must not be more than the output can give");
    config_.outputs.front().output = CurrentOutput::can;
    EXPECT_FALSE(find_misfit(config_, config_.params));
}

TEST_F(BoardFit, saved_parameters_that_do_not_fit_are_not_used) {
    StateStore store(folder_.path());
    std::string note;
    quiesce_params_t saved = config_.params;
    saved.constant_current_mA = 1234;
    ASSERT_EQ(store.save_params(config_.params, saved), "");
    EXPECT_EQ(start_params(config_, store, note).constant_current_mA, 1234);
    EXPECT_EQ(note, "saved parameters are used");
    saved.tick_rate_Hz = 500;
    ASSERT_EQ(store.save_params(config_.params, saved), "");
    const quiesce_params_t params = start_params(config_, store, note);
    EXPECT_EQ(params.tick_rate_Hz, 1000);
    EXPECT_EQ(can_node_param_hash(&params), can_node_param_hash(&config_.params));
    EXPECT_EQ(note.rfind("saved parameters are not used: accel.rate_Hz is 1000, ", 0), 0U) << note;
}

/// A driver that takes every command.
class WillingDriver final : public CurrentDevice {
  public:
    WillingDriver() {
        handle = {[](void *, std::int32_t, bool) {}, nullptr, nullptr};
    }
    std::uint32_t failures() const override { return 0; }
};

struct Staged {
    const char *name;
    std::int32_t value;
    std::uint8_t result;
    const char *log;
};

TEST_F(BoardFit, apply_refuses_what_the_board_cannot_do) {
    const Staged rows[] = {
        {"tick_rate_Hz", 2000, CAN_NODE_CONTRADICTION, "parameters stay: accel.rate_Hz is 1000, "},
        {"max_current_mA", 6000, CAN_NODE_CONTRADICTION, "parameters stay: current.full_scale_mA"},
        {"max_current_mA", 4000, CAN_NODE_CONTRADICTION, ""}, // the node's own: the law's is more
        {"constant_current_mA", 3000, CAN_NODE_DONE, "restarted with new parameters"},
    };
    for (const Staged &row : rows) {
        const auto exchange = std::make_unique<Exchange>();
        exchange->peripherals.outputs[0].start_with(std::make_unique<WillingDriver>());
        const Bus bus = open_bus(*config_.can, BusUse::controller);
        TickSource source;
        const auto loop =
            std::make_unique<Loop>(config_, config_.params, *exchange, source, bus.get(), nullptr);
        const std::uint32_t index = index_of(row.name);
        Snapshot ignored{};
        send(make_request(QUIESCE_CAN_SERVICE_REQUEST_OPERATION_STAGE_CHOICE,
                          static_cast<std::uint8_t>(index), row.value, 1));
        loop->run(kTicks);
        EXPECT_EQ(reply().result, CAN_NODE_DONE) << row.name;
        ASSERT_TRUE(exchange->snapshot.take(ignored));
        send(make_request(QUIESCE_CAN_SERVICE_REQUEST_OPERATION_APPLY_CHOICE, 0, 0, 2));
        loop->run(kTicks);
        const quiesce_can_service_reply_t answer = reply();
        EXPECT_EQ(answer.result, row.result) << row.name << row.value;
        EXPECT_TRUE(answer.result == CAN_NODE_DONE || answer.param_index > 0 || index == 0);
        std::string log;
        LogLine line{};
        while (exchange->log.take(line)) {
            log += line.text.data();
        }
        EXPECT_NE(log.find(row.log), std::string::npos) << log;
    }
}

TEST_F(BoardFit, reload_refuses_what_the_board_of_the_start_cannot_do) {
    install_signals();
    const auto exchange = std::make_unique<Exchange>();
    {
        LogSink sink(config_.log);
        FaultStore faults(folder_.path());
        RecordStore records(folder_.path());
        Caretaker caretaker(file(), folder_.path(), exchange->latched_fault);
        const Service service(config_, {}, *exchange, {faults, records, caretaker}, sink);
        write_config("tick_rate_Hz = 2000\n"); // right in itself: the default of rate_Hz follows
        EXPECT_TRUE(read_config(file(), Needs::peripherals).problems.empty());
        kill(getpid(), SIGHUP);
        while (read_text(folder_ / "log").find("tables stay: ") == std::string::npos) {
            std::this_thread::yield();
        }
    }
    EXPECT_NE(read_text(folder_ / "log").find("accel.rate_Hz is 1000, tick_rate_Hz 2000;"),
              std::string::npos);
    EXPECT_FALSE(exchange->new_params.is_full());
}

} // namespace
} // namespace quiesced
