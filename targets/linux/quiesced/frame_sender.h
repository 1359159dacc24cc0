/// Sends the frames of a tick, and knows whether the tick's command has left.
#ifndef QUIESCED_FRAME_SENDER_H
#define QUIESCED_FRAME_SENDER_H

#include <cstdint>

#include "firmware.h"

namespace quiesced {

/// Never blocks. bus: null: none. Returns CLOCK_MONOTONIC in ns of the moment when the bus had
/// taken the CurrentDemand frame; 0: there is none among the frames, or it was dropped.
std::int64_t send_frames(can_bus_t *bus, const can_frame_t *frames, std::uint32_t count);

} // namespace quiesced

#endif
