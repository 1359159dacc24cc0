/// The uart image under QEMU, driven with SLCAN frames of the lock-step messages (quiesce.dbc): the
/// protocol that a real board speaks.
#ifndef QUIESCE_QEMU_UART_LINK_H
#define QUIESCE_QEMU_UART_LINK_H

#include "lockstep_client.h"
#include "qemu_uart.h"
#include "slcan_channel.h"

namespace quiesce {

class QemuUartLink final : public ControllerLink {
  public:
    QemuUartLink(const QemuOptions &options, TelemetryRate telemetry);

    std::string target() const override { return "mps2-uart"; }
    StartAnswer start(const quiesce_board_t *board, const quiesce_params_t &params,
                      const Tables &tables) override;
    void exchange(const lockstep_stimulus_t &stimulus, lockstep_reply_t &reply) override;
    bool is_complete() const override { return is_complete_; }
    bool has_picture() const override { return false; }
    ReplyWords received() const override { return client_.received(); }
    std::optional<InstructionCounts> finish() override;

    std::size_t sent_bytes() const { return channel_.sent_bytes(); }
    std::size_t received_bytes() const { return channel_.received_bytes(); }
    QemuUart &uart() { return uart_; }

  private:
    QemuUart uart_;
    SlcanChannel channel_;
    LockstepClient client_;
    bool is_complete_;
    bool is_greeted_ = false;
};

} // namespace quiesce

#endif
