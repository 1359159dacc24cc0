/// uart-rate: lock-step exchanges a second over the UART, beside a raw echo of the same bytes.
#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <iostream>
#include <vector>

#include "arguments.h"
#include "commands.h"
#include "input_error.h"
#include "json.h"
#include "qemu_uart_link.h"

namespace quiesce {

namespace {

using Clock = std::chrono::steady_clock;
using Seconds = std::chrono::duration<double>;

/// The two take turns in blocks, so that a machine whose speed drifts favours neither.
constexpr std::int64_t kBlockExchanges = 200;
/// One telemetry frame every so many ticks.
constexpr std::uint16_t kTelemetryTicks = 20;

lockstep_stimulus_t stimulus_of(std::int64_t tick) {
    const double counts = 50000.0 * std::sin(0.0628 * static_cast<double>(tick)); // 10 Hz
    return {LOCKSTEP_FRESH | (tick > 0 ? LOCKSTEP_ENABLE : 0u),
            {static_cast<std::int32_t>(std::lround(counts))},
            {0}};
}

double run_protocol(QemuUartLink &link, std::int64_t first_tick, std::int64_t count) {
    const auto start = Clock::now();
    lockstep_reply_t reply;
    for (std::int64_t tick = first_tick; tick < first_tick + count; ++tick) {
        link.exchange(stimulus_of(tick), reply);
    }
    return Seconds(Clock::now() - start).count();
}

/// The bytes of one stimulus frame, there and back, count times.
double run_echo(QemuUart &uart, std::int64_t count) {
    static constexpr std::array<std::uint8_t, 14> kBytes = {'t', '6', '0', '3', '4', '0', '0',
                                                            '2', 'A', '0', '0', '0', '3', '\r'};
    const auto start = Clock::now();
    std::array<std::uint8_t, kBytes.size()> back;
    for (std::int64_t i = 0; i < count; ++i) {
        const auto deadline = uart.answer_deadline();
        uart.send(kBytes.data(), kBytes.size(), deadline);
        for (std::size_t received = 0; received < back.size();) {
            const std::size_t step =
                uart.receive(back.data() + received, back.size() - received, deadline);
            if (step == 0) {
                throw InputError(uart.name() + ": does not echo; is it uart_echo?");
            }
            received += step;
        }
    }
    return Seconds(Clock::now() - start).count();
}

struct BlockTimes {
    std::vector<double> protocol_s;
    std::vector<double> echo_s;
};

/// Only one emulator runs at a time: an idle image polls its UART and would take a processor.
BlockTimes run_blocks(QemuUartLink &link, QemuUart &echo, std::int64_t blocks) {
    BlockTimes times;
    echo.await_greeting();
    run_echo(echo, kBlockExchanges); // both are warm before the clock runs
    echo.pause();
    for (std::int64_t block = 0; block < blocks; ++block) {
        link.uart().resume();
        times.protocol_s.push_back(run_protocol(link, block * kBlockExchanges, kBlockExchanges));
        link.uart().pause();
        echo.resume();
        times.echo_s.push_back(run_echo(echo, kBlockExchanges));
        echo.pause();
    }
    link.uart().resume();
    return times;
}

/// Rate of the median block: a burst of other work on the machine does not count.
double median_per_s(std::vector<double> block_s) {
    const auto middle = block_s.begin() + static_cast<std::ptrdiff_t>(block_s.size() / 2);
    std::nth_element(block_s.begin(), middle, block_s.end());
    return static_cast<double>(kBlockExchanges) / *middle;
}

QemuOptions image(const Arguments &arguments, const char *option) {
    QemuOptions options;
    options.image_path = arguments.required(option);
    options.plugin_path = "none"; // the echo has no tick to count; neither side pays for counting
    return options;
}

} // namespace

int cmd_uart_rate(const std::vector<std::string> &words) {
    const Arguments arguments("uart-rate", words, {"image", "echo-image", "exchanges"});
    arguments.require_no_positional();
    const std::int64_t blocks =
        arguments.integer("exchanges", kBlockExchanges, 100000000).value_or(20000) /
        kBlockExchanges;
    const std::int64_t exchanges = blocks * kBlockExchanges;
    const QemuOptions echo_options = image(arguments, "echo-image");
    QemuUartLink link(image(arguments, "image"), {kTelemetryTicks, 1});
    quiesce_params_t params;
    quiesce_params_default(&params);
    link.start(nullptr, params, {});
    run_protocol(link, 0, kBlockExchanges);
    link.uart().pause();
    QemuUart echo(echo_options);
    const std::size_t sent_before = link.sent_bytes();
    const std::size_t received_before = link.received_bytes();
    const BlockTimes times = run_blocks(link, echo, blocks);

    const auto per_exchange = [&](std::size_t bytes) {
        return static_cast<double>(bytes) / static_cast<double>(exchanges);
    };
    const double protocol_per_s = median_per_s(times.protocol_s);
    const double echo_per_s = median_per_s(times.echo_s);
    const Json out = {{"exchanges", exchanges},
                      {"protocol_per_s", protocol_per_s},
                      {"echo_per_s", echo_per_s},
                      {"ratio", protocol_per_s / echo_per_s},
                      {"realtime_factor", protocol_per_s / params.tick_rate_Hz},
                      {"bytes_each_way", per_exchange(link.sent_bytes() - sent_before)},
                      {"reply_bytes", per_exchange(link.received_bytes() - received_before)}};
    link.finish();
    std::cout << out.dump() << '\n';
    return 0;
}

} // namespace quiesce
