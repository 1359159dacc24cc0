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
#include "lockstep_frames.h"

namespace quiesce {

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

    /// Writes every parameter by its index, the words of the board where there is one (null: none)
    /// and those of the tables, then starts.
    StartAnswer start(const quiesce_board_t *board, const quiesce_params_t &params,
                      const Tables &tables);

    /// One tick. With less than full telemetry reply holds, of each word, the last value received;
    /// state, fault and command come every tick in any case. Throws InputError, too, where a value
    /// does not fit its signal: counts and measured current have 24 bits.
    void exchange(const lockstep_stimulus_t &stimulus, lockstep_reply_t &reply);

    /// Tells the target to end.
    void stop();

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
    void write_params(const quiesce_params_t &params);
    void write_board(const quiesce_board_t &board);
    void write_table(std::size_t first_index, const std::vector<std::uint32_t> &table);
    void write_values(std::size_t first_index, const std::vector<std::int32_t> &values);
    void require_stored(std::size_t index, std::int32_t value);
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
};

} // namespace quiesce

#endif
