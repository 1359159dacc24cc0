/// The bench's frames of the lock-step protocol over CAN (quiesce.dbc).
#ifndef QUIESCE_LOCKSTEP_FRAMES_H
#define QUIESCE_LOCKSTEP_FRAMES_H

#include <cstddef>
#include <cstdint>

#include "firmware.h"
#include "firmware_comm.h"

namespace quiesce {

/// How much telemetry the target sends: `frames` words in a burst, a burst every `every_ticks`.
struct TelemetryRate {
    std::uint16_t every_ticks;
    std::uint8_t frames;

    /// Whether every reply is complete.
    bool is_full() const { return every_ticks == 1 && frames == QUIESCE_CAN_TELEMETRY_WORDS; }
};

/// Every word after every tick: replies are complete, as over the other links.
constexpr TelemetryRate kFullTelemetry{1, QUIESCE_CAN_TELEMETRY_WORDS};

/// A stimulus of this sequence number and, before it, what belongs to it. frames: room for
/// kMaxBurstFrames. Returns how many there are. Throws InputError where a count or a measured
/// current does not fit its 24 bits.
std::size_t put_stimulus(const lockstep_stimulus_t &stimulus, std::uint8_t sequence,
                         can_frame_t *frames);

/// A value for an index of LockstepParamWrite.
can_frame_t param_write(std::uint16_t index, std::int32_t value);

/// LockstepControl.
can_frame_t control_frame(std::uint8_t operation, TelemetryRate telemetry);

} // namespace quiesce

#endif
