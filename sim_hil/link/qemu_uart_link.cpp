#include "qemu_uart_link.h"

#include <cstring>
#include <string>

#include "input_error.h"

namespace quiesce {

namespace {

constexpr std::int32_t kMax24Bit = 0x7FFFFF;
constexpr std::uint8_t kSequenceMask = 15;

can_frame_t make_frame(std::uint32_t id, std::uint32_t length) {
    can_frame_t frame{};
    frame.id = id;
    frame.length = static_cast<std::uint8_t>(length);
    return frame;
}

void require_24_bit(std::int32_t value, const char *name) {
    if (value < -kMax24Bit - 1 || value > kMax24Bit) {
        throw InputError(std::string(name) + " " + std::to_string(value) +
                         ": does not fit the 24 bits that it has on the UART");
    }
}

bool has_flag(const lockstep_stimulus_t &stimulus, std::uint32_t flag) {
    return (stimulus.flags & flag) != 0;
}

bool is_telemetry(const can_frame_t &frame) {
    return frame.id >= QUIESCE_CAN_TELEMETRY_FIRST_ID &&
           frame.id < QUIESCE_CAN_TELEMETRY_FIRST_ID + QUIESCE_CAN_TELEMETRY_WORDS &&
           frame.length == 4;
}

} // namespace

QemuUartLink::QemuUartLink(const QemuOptions &options, TelemetryRate telemetry)
    : uart_(options), telemetry_(telemetry) {
    slcan_decoder_init(&decoder_);
}

bool QemuUartLink::start(const quiesce_params_t &params) {
    if (!is_greeted_) {
        uart_.await_greeting();
        is_greeted_ = true;
    }
    for (std::uint32_t index = 0; index < QUIESCE_PARAM_COUNT; ++index) {
        std::int32_t value = 0;
        quiesce_param_get(&params, index, &value);
        write_parameter(index, value);
    }
    const auto status = control(QUIESCE_CAN_LOCKSTEP_CONTROL_OPERATION_START_CHOICE);
    if (status.param_count != QUIESCE_PARAM_COUNT ||
        status.telemetry_words != QUIESCE_CAN_TELEMETRY_WORDS) {
        throw InputError("image: was built from other sources than this bench; rebuild it");
    }
    sequence_ = 0;
    reply_ = lockstep_reply_t{};
    refused_index_ = status.refused_index;
    return status.param_is_refused == 0;
}

void QemuUartLink::exchange(const lockstep_stimulus_t &stimulus, lockstep_reply_t &reply) {
    queue_stimulus(stimulus);
    flush();
    for (;;) {
        const can_frame_t frame = receive();
        if (frame.id == QUIESCE_CAN_LOCKSTEP_COMMAND_FRAME_ID) {
            take_command(frame);
            reply = reply_;
            return;
        }
        if (!is_telemetry(frame)) {
            throw InputError("target: answers a stimulus with an unexpected message");
        }
        take_telemetry(frame);
    }
}

std::optional<InstructionCounts> QemuUartLink::finish() {
    control(QUIESCE_CAN_LOCKSTEP_CONTROL_OPERATION_STOP_CHOICE);
    return uart_.finish();
}

void QemuUartLink::queue(const can_frame_t &frame) {
    output_count_ += slcan_encode(&frame, output_.data() + output_count_);
}

void QemuUartLink::flush() {
    uart_.send(output_.data(), output_count_);
    sent_bytes_ += output_count_;
    output_count_ = 0;
}

can_frame_t QemuUartLink::receive() {
    can_frame_t frame;
    for (;;) {
        while (input_begin_ < input_end_) {
            if (slcan_decode(&decoder_, input_[input_begin_++], &frame)) {
                return frame;
            }
        }
        input_begin_ = 0;
        input_end_ = uart_.receive(input_.data(), input_.size());
        received_bytes_ += input_end_;
    }
}

can_frame_t QemuUartLink::receive_id(std::uint32_t id) {
    const can_frame_t frame = receive();
    if (frame.id != id) {
        throw InputError("target: answers with message " + std::to_string(frame.id) +
                         " instead of " + std::to_string(id));
    }
    return frame;
}

void QemuUartLink::write_parameter(std::uint32_t index, std::int32_t value) {
    quiesce_can_lockstep_param_write_t write{};
    write.param_index = static_cast<std::uint16_t>(index);
    write.param_value = value;
    can_frame_t frame = make_frame(QUIESCE_CAN_LOCKSTEP_PARAM_WRITE_FRAME_ID,
                                   QUIESCE_CAN_LOCKSTEP_PARAM_WRITE_LENGTH);
    quiesce_can_lockstep_param_write_pack(frame.data, &write, sizeof frame.data);
    queue(frame);
    flush();
    const can_frame_t answer = receive_id(QUIESCE_CAN_LOCKSTEP_PARAM_ACK_FRAME_ID);
    quiesce_can_lockstep_param_ack_t ack{};
    quiesce_can_lockstep_param_ack_unpack(&ack, answer.data, answer.length);
    if (ack.is_stored == 0 || ack.param_index != index || ack.param_value != value) {
        throw InputError("target: does not store parameter " + std::to_string(index) +
                         "; rebuild its image");
    }
}

quiesce_can_lockstep_status_t QemuUartLink::control(std::uint8_t operation) {
    quiesce_can_lockstep_control_t message{};
    message.operation = operation;
    message.telemetry_frames = telemetry_.frames;
    message.telemetry_every_ticks = telemetry_.every_ticks;
    can_frame_t frame =
        make_frame(QUIESCE_CAN_LOCKSTEP_CONTROL_FRAME_ID, QUIESCE_CAN_LOCKSTEP_CONTROL_LENGTH);
    quiesce_can_lockstep_control_pack(frame.data, &message, sizeof frame.data);
    queue(frame);
    flush();
    const can_frame_t answer = receive_id(QUIESCE_CAN_LOCKSTEP_STATUS_FRAME_ID);
    quiesce_can_lockstep_status_t status{};
    quiesce_can_lockstep_status_unpack(&status, answer.data, answer.length);
    return status;
}

void QemuUartLink::queue_stimulus(const lockstep_stimulus_t &stimulus) {
    require_24_bit(stimulus.accel_counts, "accel_counts");
    if (has_flag(stimulus, LOCKSTEP_HAS_CURRENT)) {
        require_24_bit(stimulus.current_meas_mA, "current_meas_mA");
        quiesce_can_lockstep_current_t current{};
        current.current_meas_mA = stimulus.current_meas_mA;
        current.sequence = sequence_;
        can_frame_t frame =
            make_frame(QUIESCE_CAN_LOCKSTEP_CURRENT_FRAME_ID, QUIESCE_CAN_LOCKSTEP_CURRENT_LENGTH);
        quiesce_can_lockstep_current_pack(frame.data, &current, sizeof frame.data);
        queue(frame);
    }
    quiesce_can_lockstep_stimulus_t message{};
    message.accel_counts = stimulus.accel_counts;
    message.accel_is_fresh = has_flag(stimulus, LOCKSTEP_FRESH);
    message.enable = has_flag(stimulus, LOCKSTEP_ENABLE);
    message.estop = has_flag(stimulus, LOCKSTEP_ESTOP);
    message.fault_reset = has_flag(stimulus, LOCKSTEP_FAULT_RESET);
    message.sequence = sequence_;
    can_frame_t frame =
        make_frame(QUIESCE_CAN_LOCKSTEP_STIMULUS_FRAME_ID, QUIESCE_CAN_LOCKSTEP_STIMULUS_LENGTH);
    quiesce_can_lockstep_stimulus_pack(frame.data, &message, sizeof frame.data);
    queue(frame);
}

void QemuUartLink::take_command(const can_frame_t &frame) {
    quiesce_can_lockstep_command_t command{};
    if (quiesce_can_lockstep_command_unpack(&command, frame.data, frame.length) != 0 ||
        command.sequence != sequence_) {
        throw InputError("target: answers out of sequence");
    }
    sequence_ = static_cast<std::uint8_t>((sequence_ + 1) & kSequenceMask);
    reply_.current_cmd_mA = command.current_cmd_mA;
    reply_.is_driver_enabled = command.driver_is_enabled;
    reply_.telemetry.state = command.state;
    reply_.telemetry.fault = command.fault;
    reply_.telemetry.current_cmd_mA = command.current_cmd_mA;
}

void QemuUartLink::take_telemetry(const can_frame_t &frame) {
    std::uint32_t word = 0;
    for (unsigned i = 0; i < 4; ++i) {
        word |= std::uint32_t{frame.data[i]} << (8 * i);
    }
    const std::size_t index = frame.id - QUIESCE_CAN_TELEMETRY_FIRST_ID;
    std::memcpy(reinterpret_cast<std::uint8_t *>(&reply_.telemetry) + 4 * index, &word,
                sizeof word);
}

} // namespace quiesce
