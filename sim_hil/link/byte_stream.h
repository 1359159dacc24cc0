/// Bytes both ways between the bench and a target: what SLCAN lines travel on.
#ifndef QUIESCE_BYTE_STREAM_H
#define QUIESCE_BYTE_STREAM_H

#include <cstddef>
#include <cstdint>
#include <string>

#include "link_clock.h"

namespace quiesce {

/// Not thread-safe. Every function throws InputError, one line with the name, when the other side
/// is gone.
class ByteStream {
  public:
    virtual ~ByteStream() = default;

    /// What error lines begin with.
    virtual std::string name() const = 0;

    /// Sends all bytes. Throws InputError, too, when they are not taken by the deadline.
    virtual void send(const std::uint8_t *bytes, std::size_t count,
                      LinkClock::time_point deadline) = 0;

    /// Waits for bytes. Returns how many came, at most capacity; 0 iff none did by the deadline.
    virtual std::size_t receive(std::uint8_t *bytes, std::size_t capacity,
                                LinkClock::time_point deadline) = 0;
};

} // namespace quiesce

#endif
