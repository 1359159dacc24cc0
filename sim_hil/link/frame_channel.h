/// CAN frames both ways between the bench and a target, whatever carries them.
#ifndef QUIESCE_FRAME_CHANNEL_H
#define QUIESCE_FRAME_CHANNEL_H

#include <cstddef>
#include <string>

#include "firmware.h"
#include "firmware_comm.h"
#include "link_clock.h"

namespace quiesce {

/// Most frames of one send: all currents and samples of a tick.
constexpr std::size_t kMaxBurstFrames = QUIESCE_MAX_DAMPERS + QUIESCE_MAX_SENSORS;

/// Not thread-safe; closed by its destructor. Every function throws InputError, one line with the
/// name, when the other side or the bus is gone.
class FrameChannel {
  public:
    virtual ~FrameChannel() = default;

    /// What error lines begin with: what the user called it.
    virtual std::string name() const = 0;

    /// Sends count (<= kMaxBurstFrames) frames in order, in one write where the carrier can. Throws
    /// InputError, too, when they are not taken by the deadline.
    virtual void send(const can_frame_t *frames, std::size_t count,
                      LinkClock::time_point deadline) = 0;

    /// Waits for a frame. Returns false iff none came by the deadline.
    virtual bool receive(can_frame_t &frame, LinkClock::time_point deadline) = 0;
};

} // namespace quiesce

#endif
