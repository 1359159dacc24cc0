/// What leaves when the bus or the line does not take all: a demand before everything that reports,
/// telemetry last. Of each cyclic message only the newest frame waits; replies, frames of a table's
/// transfer and pages of the freeze frame wait in rows.
///
/// As long as everything leaves, frames go in the order of their classes: demands, Status, replies,
/// transfer, freeze frame, telemetry. While something still waits from the tick before, a demand
/// that says what the last one said goes behind the freeze frame until that is kRepeatEvery_ns ago,
/// so that a line which demands alone would fill carries the others, too. A change of state or of
/// the output stage always goes first. Telemetry is shed in the order FaultRecord, RawSample,
/// SpectrumPeak2 .. 0, LawState, Motion, and what comes every second.
#ifndef QUIESCED_FRAME_SENDER_H
#define QUIESCED_FRAME_SENDER_H

#include <array>
#include <cstdint>

#include "firmware.h"

namespace quiesced {

/// Frames that never left, since the start.
struct SendCounters {
    can_unsent_t unsent;   ///< cyclic ones for newer ones, of replies and pages what had no room
    std::uint32_t refused; ///< attempts that the bus did not take, of frames that waited on
};

class FrameSender {
  public:
    /// Takes a frame, or refuses it and all that come after it for now.
    using Sink = bool (*)(void *context, const can_frame_t *frame);

    /// As the driver's timeout of 10 ms demands.
    static constexpr std::int64_t kRepeatEvery_ns = 4'000'000;

    /// Sends the frames of a tick and what waits from earlier ones. Never blocks. Returns now_ns
    /// where the tick's demands have left; 0: there are none, or one of them waits.
    std::int64_t send(Sink sink, void *context, const can_frame_t *frames, std::uint32_t count,
                      std::int64_t now_ns);

    const SendCounters &counters() const { return counters_; }

  private:
    struct Slot {
        can_frame_t frame;
        bool waits;
    };
    struct Demand {
        can_frame_t last; ///< that left
        std::int64_t left_ns;
    };
    template <std::size_t kRoom>
    struct Row {
        std::array<can_frame_t, kRoom> frames;
        std::size_t first;
        std::size_t count;
    };
    struct Way { ///< to the bus, until it refuses
        Sink sink;
        void *context;
        bool is_open;
    };

    void take(const can_frame_t &frame);
    void replace(std::uint32_t message, const can_frame_t &frame);
    bool leave(Way &way, const can_frame_t &frame);
    void send_slot(Way &way, std::uint32_t message);
    void send_demands(Way &way, std::int64_t now_ns, bool only_urgent);
    bool is_urgent(std::size_t damper, std::int64_t now_ns) const;
    bool has_left_over() const;
    template <std::size_t kRoom>
    void append(Row<kRoom> &row, const can_frame_t &frame);
    template <std::size_t kRoom>
    void send_row(Way &way, Row<kRoom> &row);

    std::array<Slot, QUIESCE_CAN_MESSAGES> slots_{};
    std::array<Demand, QUIESCE_MAX_DAMPERS> demands_{};
    Row<4> replies_{};
    Row<8> flow_{};   ///< TableFlow
    Row<12> pages_{}; ///< two freeze frames
    SendCounters counters_{};
};

} // namespace quiesced

#endif
