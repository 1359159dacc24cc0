/// A bus for programs of one computer, as python-can's interface udp_multicast has it: each frame a
/// datagram to a multicast group, a MessagePack map of its fields. Nothing leaves the computer (a
/// hop limit of 0), and nobody has to be there to take it.
#ifndef QUIESCE_MULTICAST_BUS_H
#define QUIESCE_MULTICAST_BUS_H

#include <cstdint>
#include <string>
#include <vector>

#include "file_descriptor.h"
#include "firmware_comm.h"

namespace quiesce {

/// A frame as python-can packs it. time_s: since 1970.
std::vector<std::uint8_t> pack_frame(const can_frame_t &frame, double time_s);

/// Returns false iff it is no classic CAN frame, or an error frame.
bool unpack_frame(const std::uint8_t *bytes, std::size_t count, can_frame_t &frame);

/// Not thread-safe.
class MulticastBus {
  public:
    /// bus: "GROUP:PORT", IPv4. Throws InputError, one line, where it is none or cannot be joined.
    explicit MulticastBus(const std::string &bus);

    /// Returns false iff it is not taken at once.
    bool send(const can_frame_t &frame);

    /// The next one of somebody else that has come. Returns false iff there is none by now.
    bool receive(can_frame_t &frame);

  private:
    FileDescriptor in_;
    FileDescriptor out_;
    std::uint16_t own_port_ = 0; ///< where what this one sends comes from: it comes back, too
};

} // namespace quiesce

#endif
