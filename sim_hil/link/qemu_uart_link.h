/// The uart image under QEMU, driven with SLCAN frames of the lock-step messages (quiesce.dbc): the
/// protocol that a real board speaks.
#ifndef QUIESCE_QEMU_UART_LINK_H
#define QUIESCE_QEMU_UART_LINK_H

#include <array>

#include "controller_link.h"
#include "firmware_comm.h"
#include "qemu_uart.h"

namespace quiesce {

/// How much telemetry the target sends: `frames` words in a burst, a burst every `every_ticks`.
struct TelemetryRate {
    std::uint16_t every_ticks;
    std::uint8_t frames;
};

/// Every word after every tick: replies are complete, as over the other links.
constexpr TelemetryRate kFullTelemetry{1, QUIESCE_CAN_TELEMETRY_WORDS};

class QemuUartLink final : public ControllerLink {
  public:
    /// With less than full telemetry a reply holds, of each word, the last value received; state,
    /// fault and command come every tick in any case.
    QemuUartLink(const QemuOptions &options, TelemetryRate telemetry);

    std::string target() const override { return "mps2-uart"; }

    /// Writes every parameter by its index, then starts.
    bool start(const quiesce_params_t &params) override;

    /// Throws InputError where a value does not fit its signal: counts and measured current have
    /// 24 bits.
    void exchange(const lockstep_stimulus_t &stimulus, lockstep_reply_t &reply) override;

    std::optional<InstructionCounts> finish() override;

    /// Index of the parameter that the last start refused. Only where it returned false.
    std::uint32_t refused_index() const { return refused_index_; }

    std::size_t sent_bytes() const { return sent_bytes_; }
    std::size_t received_bytes() const { return received_bytes_; }
    QemuUart &uart() { return uart_; }

  private:
    void queue(const can_frame_t &frame);
    void flush();
    can_frame_t receive();
    can_frame_t receive_id(std::uint32_t id);
    void write_parameter(std::uint32_t index, std::int32_t value);
    quiesce_can_lockstep_status_t control(std::uint8_t operation);
    void queue_stimulus(const lockstep_stimulus_t &stimulus);
    void take_command(const can_frame_t &frame);
    void take_telemetry(const can_frame_t &frame);

    QemuUart uart_;
    TelemetryRate telemetry_;
    bool is_greeted_ = false;
    slcan_decoder_t decoder_{};
    std::array<std::uint8_t, 4096> input_{};
    std::size_t input_begin_ = 0;
    std::size_t input_end_ = 0;
    std::array<std::uint8_t, 2 * SLCAN_MAX_BYTES> output_{};
    std::size_t output_count_ = 0;
    lockstep_reply_t reply_{};
    std::uint8_t sequence_ = 0;
    std::uint32_t refused_index_ = 0;
    std::size_t sent_bytes_ = 0;
    std::size_t received_bytes_ = 0;
};

} // namespace quiesce

#endif
