#include "lockstep_client.h"

#include <algorithm>
#include <cstddef>
#include <cstdio>
#include <cstring>
#include <unistd.h>
#include <utility>

#include "input_error.h"
#include "lockstep_can.h"

namespace quiesce {

namespace {

constexpr std::uint8_t kSequenceMask = 15;

/// Pause between two questions for the status.
constexpr std::chrono::milliseconds kAskInterval(200);

/// Parameters from this index on exist nowhere: a write to one is refused, and does nothing else.
constexpr std::uint16_t kFenceIndex = 0xFF00;

constexpr std::size_t kWord = sizeof(std::uint32_t);

/// Number of a telemetry field's word in lockstep_reply_t.
constexpr std::size_t reply_word(std::size_t telemetry_offset) {
    return (offsetof(lockstep_reply_t, telemetry) + telemetry_offset) / kWord;
}

/// Words that every LockstepCommand, and what comes with it, brings.
ReplyWords command_words() {
    ReplyWords words;
    constexpr std::size_t kFirst = offsetof(lockstep_reply_t, current_cmd_mA) / kWord;
    for (std::size_t i = 0; i < QUIESCE_MAX_DAMPERS; ++i) {
        words.set(kFirst + i);
    }
    words.set(offsetof(lockstep_reply_t, drivers_enabled) / kWord);
    words.set(reply_word(offsetof(quiesce_telemetry_t, state)));
    words.set(reply_word(offsetof(quiesce_telemetry_t, fault)));
    words.set(reply_word(offsetof(quiesce_telemetry_t, current_cmd_mA)));
    return words;
}

std::string message_name(std::uint32_t id) {
    char text[16];
    std::snprintf(text, sizeof text, "0x%03X", static_cast<unsigned>(id));
    return text;
}

bool is_lockstep(const can_frame_t &frame) {
    return (frame.id & LockstepClient::kIdMask) == LockstepClient::kFirstId && !frame.is_extended &&
           !frame.is_remote;
}

bool is_telemetry(const can_frame_t &frame) {
    return frame.id >= QUIESCE_CAN_TELEMETRY_FIRST_ID &&
           frame.id < QUIESCE_CAN_TELEMETRY_FIRST_ID + QUIESCE_CAN_TELEMETRY_WORDS &&
           frame.length == kWord;
}

quiesce_can_lockstep_param_ack_t unpack_ack(const can_frame_t &frame) {
    quiesce_can_lockstep_param_ack_t ack{};
    quiesce_can_lockstep_param_ack_unpack(&ack, frame.data, frame.length);
    return ack;
}

static_assert((QUIESCE_CAN_TELEMETRY_FIRST_ID & LockstepClient::kIdMask) ==
                      LockstepClient::kFirstId &&
                  ((QUIESCE_CAN_TELEMETRY_FIRST_ID + QUIESCE_CAN_TELEMETRY_WORDS - 1) &
                   LockstepClient::kIdMask) == LockstepClient::kFirstId,
              "every lock-step message passes the mask");

} // namespace

LockstepClient::LockstepClient(FrameChannel &channel, LockstepClientOptions options)
    : channel_(channel), options_(std::move(options)) {}

void LockstepClient::greet(std::chrono::milliseconds time) {
    await_status(time);
    pass_fence();
}

void LockstepClient::await_status(std::chrono::milliseconds time) {
    const auto deadline = LinkClock::now() + time;
    can_frame_t frame;
    while (LinkClock::now() < deadline) {
        send_control(QUIESCE_CAN_LOCKSTEP_CONTROL_OPERATION_STATUS_CHOICE);
        const auto next_question = std::min(LinkClock::now() + kAskInterval, deadline);
        while (receive_before(frame, next_question)) {
            if (frame.id == QUIESCE_CAN_LOCKSTEP_STATUS_FRAME_ID) {
                return;
            }
        }
    }
    fail("no target answers within " + std::to_string(time.count()) + " ms" +
         options_.silence_hint);
}

/// The refusal of the fence comes after every answer to what was sent before it, by whomever.
void LockstepClient::pass_fence() {
    const auto index = static_cast<std::uint16_t>(
        kFenceIndex + (static_cast<unsigned>(getpid()) & 0xFFu)); // an earlier bench's is another
    const can_frame_t fence = param_write(index, 0);
    send(&fence, 1);
    const auto deadline = LinkClock::now() + options_.answer_time;
    can_frame_t frame;
    while (receive_before(frame, deadline)) {
        if (frame.id == QUIESCE_CAN_LOCKSTEP_PARAM_ACK_FRAME_ID &&
            unpack_ack(frame).param_index == index) {
            return;
        }
    }
    fail("the target answers, but not what it is asked" + options_.silence_hint);
}

StartAnswer LockstepClient::start(const quiesce_board_t *board, const quiesce_params_t &params,
                                  const Tables &tables) {
    write_params(params);
    if (board != nullptr) {
        write_board(*board);
    }
    for (std::size_t i = 0; i < tables.size(); ++i) {
        write_table(LOCKSTEP_CAN_TABLE_INDEX + LOCKSTEP_CAN_TABLE_INDICES * i, tables[i]);
    }
    send_control(board != nullptr ? QUIESCE_CAN_LOCKSTEP_CONTROL_OPERATION_START_BOARD_CHOICE
                                  : QUIESCE_CAN_LOCKSTEP_CONTROL_OPERATION_START_CHOICE);
    const auto status = receive_status();
    if (status.param_count != QUIESCE_PARAM_COUNT ||
        status.telemetry_words != QUIESCE_CAN_TELEMETRY_WORDS) {
        fail("the target was built from other sources than this bench; rebuild it");
    }
    sequence_ = 0;
    reply_ = lockstep_reply_t{};
    if (status.table_verdict != QUIESCE_TABLE_OK) {
        if (status.refused_index >= LOCKSTEP_TABLES) {
            fail("refuses a table that there is not; rebuild it");
        }
        return {false, {status.table_verdict, status.refused_index}};
    }
    if (status.param_is_refused != 0) {
        return {false, {}, status.refused_index};
    }
    return {status.board_is_refused == 0};
}

void LockstepClient::write_params(const quiesce_params_t &params) {
    std::vector<std::int32_t> values(QUIESCE_PARAM_COUNT);
    for (std::uint32_t i = 0; i < values.size(); ++i) {
        quiesce_param_get(&params, i, &values[i]);
    }
    write_values(0, values);
}

void LockstepClient::write_board(const quiesce_board_t &board) {
    std::vector<std::int32_t> words(LOCKSTEP_CAN_BOARD_WORDS);
    std::memcpy(words.data(), &board, sizeof board);
    write_values(LOCKSTEP_CAN_BOARD_INDEX, words);
}

/// Of one that is too long as many words as there is room for: the target says so by their number.
void LockstepClient::write_table(std::size_t first_index, const std::vector<std::uint32_t> &table) {
    const std::size_t count = std::min<std::size_t>(table.size(), QUIESCE_TABLE_WORDS);
    const auto end = table.begin() + static_cast<std::ptrdiff_t>(count);
    write_values(first_index, {table.begin(), end});
    write_values(first_index + LOCKSTEP_CAN_TABLE_COUNT, {static_cast<std::int32_t>(table.size())});
}

void LockstepClient::exchange(const lockstep_stimulus_t &stimulus, lockstep_reply_t &reply) {
    static const ReplyWords kCommandWords = command_words();
    std::array<can_frame_t, kMaxBurstFrames> frames;
    const std::size_t count = put_stimulus(stimulus, sequence_, frames.data());
    send(frames.data(), count);
    received_ = kCommandWords;
    std::size_t telemetry_frames = 0;
    for (;;) {
        const can_frame_t frame = receive();
        if (frame.id == QUIESCE_CAN_LOCKSTEP_DAMPER_FRAME_ID) {
            take_damper(frame);
            continue;
        }
        if (frame.id == QUIESCE_CAN_LOCKSTEP_COMMAND_FRAME_ID) {
            take_command(frame);
            if ((stimulus.flags & LOCKSTEP_REPORT) == 0) {
                forget_report();
            }
            reply = reply_;
            return;
        }
        if (!is_telemetry(frame)) {
            fail("answers a stimulus with an unexpected message, " + message_name(frame.id));
        }
        if (telemetry_frames++ == QUIESCE_CAN_TELEMETRY_WORDS) {
            fail("answers a stimulus with more telemetry than there is");
        }
        take_telemetry(frame);
    }
}

void LockstepClient::stop() {
    send_control(QUIESCE_CAN_LOCKSTEP_CONTROL_OPERATION_STOP_CHOICE);
    receive_status();
}

void LockstepClient::send(const can_frame_t *frames, std::size_t count) {
    channel_.send(frames, count, LinkClock::now() + options_.answer_time);
}

/// Next lock-step message. Returns false iff none came by the deadline.
bool LockstepClient::receive_before(can_frame_t &frame, LinkClock::time_point deadline) {
    while (channel_.receive(frame, deadline)) {
        if (is_lockstep(frame)) {
            return true;
        }
        if (LinkClock::now() > deadline) { // a busy bus is no answer
            return false;
        }
    }
    return false;
}

can_frame_t LockstepClient::receive() {
    can_frame_t frame;
    if (!receive_before(frame, LinkClock::now() + options_.answer_time)) {
        fail("no answer within " + std::to_string(options_.answer_time.count()) + " ms" +
             options_.silence_hint);
    }
    return frame;
}

can_frame_t LockstepClient::receive_message(std::uint32_t id, std::uint8_t length) {
    const can_frame_t frame = receive();
    if (frame.id != id || frame.length != length) {
        fail("answers with message " + message_name(frame.id) + " of " +
             std::to_string(frame.length) + " bytes instead of " + message_name(id));
    }
    return frame;
}

/// Of indices one after the other, a burst of frames at a time: the target answers each in turn.
void LockstepClient::write_values(std::size_t first_index,
                                  const std::vector<std::int32_t> &values) {
    std::array<can_frame_t, kMaxBurstFrames> frames;
    for (std::size_t sent = 0; sent < values.size();) {
        const std::size_t count = std::min(frames.size(), values.size() - sent);
        for (std::size_t i = 0; i < count; ++i) {
            frames[i] =
                param_write(static_cast<std::uint16_t>(first_index + sent + i), values[sent + i]);
        }
        send(frames.data(), count);
        for (const std::size_t end = sent + count; sent < end; ++sent) {
            require_stored(first_index + sent, values[sent]);
        }
    }
}

void LockstepClient::require_stored(std::size_t index, std::int32_t value) {
    const auto ack = unpack_ack(receive_message(QUIESCE_CAN_LOCKSTEP_PARAM_ACK_FRAME_ID,
                                                QUIESCE_CAN_LOCKSTEP_PARAM_ACK_LENGTH));
    if (ack.is_stored == 0 || ack.param_index != index || ack.param_value != value) {
        fail("the target does not store " +
             std::string(index < LOCKSTEP_CAN_BOARD_INDEX ? "parameter " : "word ") +
             std::to_string(index) + "; rebuild it");
    }
}

void LockstepClient::send_control(std::uint8_t operation) {
    const can_frame_t frame = control_frame(operation, options_.telemetry);
    send(&frame, 1);
}

quiesce_can_lockstep_status_t LockstepClient::receive_status() {
    const can_frame_t answer =
        receive_message(QUIESCE_CAN_LOCKSTEP_STATUS_FRAME_ID, QUIESCE_CAN_LOCKSTEP_STATUS_LENGTH);
    quiesce_can_lockstep_status_t status{};
    quiesce_can_lockstep_status_unpack(&status, answer.data, answer.length);
    return status;
}

void LockstepClient::set_enabled(std::uint32_t damper, bool is_enabled) {
    reply_.drivers_enabled &= ~(1u << damper);
    reply_.drivers_enabled |= (is_enabled ? 1u : 0u) << damper;
}

void LockstepClient::take_damper(const can_frame_t &frame) {
    quiesce_can_lockstep_damper_t command{};
    require_in_sequence(frame.length == QUIESCE_CAN_LOCKSTEP_DAMPER_LENGTH &&
                        quiesce_can_lockstep_damper_unpack(&command, frame.data, frame.length) ==
                            0 &&
                        command.sequence == sequence_);
    reply_.current_cmd_mA[command.damper_number] = command.current_cmd_mA;
    set_enabled(command.damper_number, command.driver_is_enabled != 0);
}

void LockstepClient::take_command(const can_frame_t &frame) {
    quiesce_can_lockstep_command_t command{};
    require_in_sequence(frame.length == QUIESCE_CAN_LOCKSTEP_COMMAND_LENGTH &&
                        quiesce_can_lockstep_command_unpack(&command, frame.data, frame.length) ==
                            0 &&
                        command.sequence == sequence_);
    sequence_ = static_cast<std::uint8_t>((sequence_ + 1) & kSequenceMask);
    reply_.current_cmd_mA[0] = command.current_cmd_mA;
    set_enabled(0, command.driver_is_enabled != 0);
    reply_.telemetry.state = command.state;
    reply_.telemetry.fault = command.fault;
    reply_.telemetry.current_cmd_mA = command.current_cmd_mA;
}

void LockstepClient::take_telemetry(const can_frame_t &frame) {
    std::uint32_t word = 0;
    for (unsigned i = 0; i < kWord; ++i) {
        word |= std::uint32_t{frame.data[i]} << (8 * i);
    }
    const std::size_t index = frame.id - QUIESCE_CAN_TELEMETRY_FIRST_ID;
    const std::size_t place = reply_word(kWord * index);
    std::memcpy(reinterpret_cast<std::uint8_t *>(&reply_) + kWord * place, &word, sizeof word);
    received_.set(place);
}

/// The target reports whenever it sends telemetry; nobody has asked for it here.
void LockstepClient::forget_report() {
    constexpr std::size_t kFirst = offsetof(lockstep_reply_t, report) / kWord;
    for (std::size_t i = 0; i < QUIESCE_REPORT_WORDS; ++i) {
        received_.reset(kFirst + i);
        reply_.report[i] = 0;
    }
}

void LockstepClient::require_in_sequence(bool is_answer) const {
    if (!is_answer) {
        fail("answers out of sequence; has it lost a frame, or does a second bench talk to it?");
    }
}

void LockstepClient::fail(const std::string &what) const {
    throw InputError(channel_.name() + ": " + what);
}

} // namespace quiesce
