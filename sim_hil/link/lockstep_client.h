/// The bench's side of the lock-step protocol over CAN (quiesce.dbc;
/// targets/lockstep/lockstep_can.h is the other side): start, parameters, one stimulus and one
/// reply a tick.
#ifndef QUIESCE_LOCKSTEP_CLIENT_H
#define QUIESCE_LOCKSTEP_CLIENT_H

#include <array>
#include <chrono>
#include <string>

#include "controller_link.h"
#include "frame_channel.h"

namespace quiesce {

/// How much telemetry the target sends: `frames` words in a burst, a burst every `every_ticks`.
struct TelemetryRate {
    std::uint16_t every_ticks;
    std::uint8_t frames;
};

/// Every word after every tick: replies are complete, as over the other links.
constexpr TelemetryRate kFullTelemetry{1, QUIESCE_CAN_TELEMETRY_WORDS};

struct LockstepClientOptions {
    TelemetryRate telemetry = kFullTelemetry;
    /// Longest wait for one answer. Generous: a loaded machine must not look like a dead target.
    std::chrono::milliseconds answer_time = std::chrono::seconds(10);
    /// What to look at when nobody answers; ends the line about it.
    std::string silence_hint;
};

/// Not thread-safe. Frames that are no lock-step messages are passed over: the bus may have other
/// traffic. Every function throws InputError, one line with the channel's name, when the target
/// does not answer in time or answers with something else.
class LockstepClient {
  public:
    /// Ids of the lock-step messages: (id & kIdMask) == kFirstId.
    static constexpr std::uint32_t kFirstId = 0x600;
    static constexpr std::uint32_t kIdMask = 0x780;

    /// The channel stays the caller's and must outlive the client.
    LockstepClient(FrameChannel &channel, LockstepClientOptions options);

    /// Asks for the status until the target answers, for at most `time`, and then makes sure that
    /// nothing of an earlier conversation is still under way. For a target that may start later
    /// than the bench, or that an earlier bench has left in mid-tick.
    void greet(std::chrono::milliseconds time);

    /// Writes every parameter by its index, and the words of the board where there is one (null:
    /// none), then starts. Returns false iff one is refused.
    bool start(const quiesce_board_t *board, const quiesce_params_t &params);

    /// One tick. With less than full telemetry reply holds, of each word, the last value received;
    /// state, fault and command come every tick in any case. Throws InputError, too, where a value
    /// does not fit its signal: counts and measured current have 24 bits.
    void exchange(const lockstep_stimulus_t &stimulus, lockstep_reply_t &reply);

    /// Tells the target to end.
    void stop();

    /// Index of the parameter that the last start refused. Only where it returned false.
    std::uint32_t refused_index() const { return refused_index_; }

    /// Words that the last exchange brought.
    const ReplyWords &received() const { return received_; }

  private:
    void send(const can_frame_t *frames, std::size_t count);
    bool receive_before(can_frame_t &frame, LinkClock::time_point deadline);
    can_frame_t receive();
    can_frame_t receive_message(std::uint32_t id, std::uint8_t length);
    void send_control(std::uint8_t operation);
    quiesce_can_lockstep_status_t receive_status();
    void await_status(std::chrono::milliseconds time);
    void pass_fence();
    void write_parameter(std::uint32_t index, std::int32_t value);
    std::size_t put_stimulus(const lockstep_stimulus_t &stimulus, can_frame_t *frames) const;
    can_frame_t current_frame(const lockstep_stimulus_t &stimulus, std::uint8_t damper) const;
    can_frame_t sensor_frame(const lockstep_stimulus_t &stimulus, std::uint8_t number) const;
    can_frame_t stimulus_frame(const lockstep_stimulus_t &stimulus) const;
    void write_board(const quiesce_board_t &board);
    void set_enabled(std::uint32_t damper, bool is_enabled);
    void take_damper(const can_frame_t &frame);
    void take_command(const can_frame_t &frame);
    void take_telemetry(const can_frame_t &frame);
    void forget_report();
    void require_in_sequence(bool is_answer) const;
    [[noreturn]] void fail(const std::string &what) const;

    FrameChannel &channel_;
    LockstepClientOptions options_;
    lockstep_reply_t reply_{};
    ReplyWords received_;
    std::uint8_t sequence_ = 0;
    std::uint32_t refused_index_ = 0;
};

} // namespace quiesce

#endif
