#include "qemu_uart_link.h"

namespace quiesce {

QemuUartLink::QemuUartLink(const QemuOptions &options, TelemetryRate telemetry)
    : uart_(options), channel_(uart_),
      client_(channel_, {telemetry, options.answer_time, kUartSilenceHint}),
      is_complete_(telemetry.is_full()) {}

StartAnswer QemuUartLink::start(const quiesce_board_t *board, const quiesce_params_t &params,
                                const Tables &tables) {
    if (!is_greeted_) {
        uart_.await_greeting();
        is_greeted_ = true;
    }
    return client_.start(board, params, tables);
}

void QemuUartLink::exchange(const lockstep_stimulus_t &stimulus, lockstep_reply_t &reply) {
    client_.exchange(stimulus, reply);
}

std::optional<InstructionCounts> QemuUartLink::finish() {
    client_.stop();
    return uart_.finish();
}

} // namespace quiesce
