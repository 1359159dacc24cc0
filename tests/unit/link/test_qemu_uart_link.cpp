#include "images.h"
#include "in_process_link.h"
#include "qemu_uart_link.h"

#include <cstring>
#include <vector>

namespace quiesce {
namespace {

using std::chrono::steady_clock;

TEST(qemu_uart, echo_returns_every_byte_value) {
    QemuUart echo(uncounted(kEchoImage));
    std::vector<std::uint8_t> sent;
    for (int value = 0; value < 256; ++value) {
        sent.push_back(static_cast<std::uint8_t>(value));
    }
    sent.push_back('\r'); // ends the line that the echo waits for
    echo.await_greeting();
    echo.send(sent.data(), sent.size(), echo.answer_deadline());
    std::vector<std::uint8_t> back(sent.size());
    std::size_t step = 1;
    for (std::size_t count = 0; count < back.size() && step > 0; count += step) {
        step = echo.receive(back.data() + count, back.size() - count, echo.answer_deadline());
    }
    EXPECT_EQ(sent, back);
}

TEST(qemu_uart_link, full_telemetry_answers_like_the_host_through_stop_and_restart) {
    InProcessLink host;
    QemuUartLink target(options_for(kUartImage), kFullTelemetry);
    for (int run = 0; run < 2; ++run) {
        ASSERT_TRUE(host.start(nullptr, default_params(), {}));
        ASSERT_TRUE(target.start(nullptr, default_params(), {}));
        for (std::uint32_t tick = 1600; tick < 1900; ++tick) { // estop and reset are in here
            lockstep_reply_t expected, actual;
            host.exchange(varied_stimulus(tick), expected);
            target.exchange(varied_stimulus(tick), actual);
            ASSERT_EQ(std::memcmp(&expected, &actual, sizeof expected), 0) << "tick " << tick;
        }
    }
    EXPECT_TRUE(target.finish());
}

TEST(qemu_uart_link, decimated_telemetry_still_brings_every_command) {
    constexpr std::uint32_t kRound = 10 * QUIESCE_CAN_TELEMETRY_WORDS;
    InProcessLink host;
    QemuUartLink target(options_for(kUartImage), {10, 1});
    host.start(nullptr, default_params(), {});
    target.start(nullptr, default_params(), {});
    for (std::uint32_t tick = 0; tick < kRound + 200; ++tick) {
        lockstep_reply_t expected, actual;
        host.exchange(varied_stimulus(tick), expected);
        target.exchange(varied_stimulus(tick), actual);
        ASSERT_EQ(expected.current_cmd_mA[0], actual.current_cmd_mA[0]) << "tick " << tick;
        ASSERT_EQ(expected.drivers_enabled, actual.drivers_enabled) << "tick " << tick;
        ASSERT_EQ(expected.telemetry.state, actual.telemetry.state) << "tick " << tick;
        ASSERT_EQ(expected.telemetry.fault, actual.telemetry.fault) << "tick " << tick;
        if (tick % kRound == 9) { // words come in turn, word 0 after tick 9
            ASSERT_EQ(expected.telemetry.tick, actual.telemetry.tick);
        }
    }
}

TEST(qemu_uart_link, refused_parameter_is_named_by_its_index) {
    quiesce_params_t params = default_params();
    quiesce_param_set(&params, 7, -1);
    quiesce_param_error_t error;
    ASSERT_FALSE(quiesce_params_check(&params, &error));
    InProcessLink host;
    QemuUartLink target(options_for(kUartImage), kFullTelemetry);
    EXPECT_FALSE(host.start(nullptr, params, {}));
    const StartAnswer answer = target.start(nullptr, params, {});
    EXPECT_FALSE(answer);
    EXPECT_EQ(answer.param, error.index);
    lockstep_reply_t expected, actual;
    host.exchange(varied_stimulus(1), expected);
    target.exchange(varied_stimulus(1), actual);
    EXPECT_EQ(std::memcmp(&expected, &actual, sizeof expected), 0);
}

TEST(qemu_uart_link, rubbish_on_the_line_does_not_disturb_it) {
    InProcessLink host;
    QemuUartLink target(options_for(kUartImage), kFullTelemetry);
    host.start(nullptr, default_params(), {});
    target.start(nullptr, default_params(), {});
    for (std::uint32_t tick = 0; tick < 50; ++tick) {
        const std::string rubbish = "\rS6\rt603\rt6034ZZ\r\xFF\xFE\r";
        target.uart().send(reinterpret_cast<const std::uint8_t *>(rubbish.data()), rubbish.size(),
                           target.uart().answer_deadline());
        lockstep_reply_t expected, actual;
        host.exchange(varied_stimulus(tick), expected);
        target.exchange(varied_stimulus(tick), actual);
        ASSERT_EQ(std::memcmp(&expected, &actual, sizeof expected), 0) << "tick " << tick;
    }
}

TEST(qemu_uart_link, values_that_do_not_fit_their_signal_are_refused) {
    QemuUartLink target(options_for(kUartImage), kFullTelemetry);
    lockstep_reply_t reply;
    target.start(nullptr, default_params(), {});
    expect_contains(error_of([&] {
                        target.exchange({LOCKSTEP_FRESH, {1 << 23}, {0}}, reply);
                    }),
                    "counts 8388608: does not fit");
    target.exchange({LOCKSTEP_FRESH, {-(1 << 23)}, {0}}, reply);
    EXPECT_EQ(reply.telemetry.tick, 1u);
}

TEST(qemu_uart_link, missing_image_is_named) {
    expect_contains(error_of([] { QemuUartLink(options_for("no/such.elf"), kFullTelemetry); }),
                    "image no/such.elf: cannot be read");
    QemuUartLink target(uncounted("no/such.elf"), kFullTelemetry);
    expect_contains(error_of([&] { target.start(nullptr, default_params(), {}); }),
                    "image no/such.elf: qemu-system-arm ended with code 1: ");
}

TEST(qemu_uart_link, killed_emulator_is_noticed_at_once) {
    QemuUartLink target(options_for(kUartImage), {0, 0});
    lockstep_reply_t reply;
    target.start(nullptr, default_params(), {});
    target.exchange(varied_stimulus(0), reply);
    kill(target.uart().process_id(), SIGKILL);
    const auto start = steady_clock::now();
    const std::string error = error_of([&] {
        for (std::uint32_t tick = 1; tick < 100000; ++tick) {
            target.exchange(varied_stimulus(tick), reply);
        }
    });
    expect_contains(error, "was killed by signal 9");
    EXPECT_LT(steady_clock::now() - start, std::chrono::seconds(5));
}

TEST(qemu_uart_link, image_that_never_answers_is_given_up) {
    QemuUartLink target(impatient(kShmImage), kFullTelemetry);
    expect_contains(error_of([&] { target.start(nullptr, default_params(), {}); }),
                    "no answer within 300 ms");
}

TEST(qemu_uart_link, image_that_speaks_something_else_is_refused) {
    QemuUartLink target(uncounted(kEchoImage), kFullTelemetry);
    expect_contains(error_of([&] { target.start(nullptr, default_params(), {}); }),
                    "answers with message 0x601 of 6 bytes instead of 0x609");
}

} // namespace
} // namespace quiesce
