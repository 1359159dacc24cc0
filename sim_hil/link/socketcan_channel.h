/// CAN frames through a SocketCAN interface of this machine.
#ifndef QUIESCE_SOCKETCAN_CHANNEL_H
#define QUIESCE_SOCKETCAN_CHANNEL_H

#include "file_descriptor.h"
#include "frame_channel.h"

namespace quiesce {

class SocketCanChannel final : public FrameChannel {
  public:
    /// socket: one message a frame (struct can_frame), as a raw CAN socket has them; it becomes
    /// non-blocking. name: for error lines.
    SocketCanChannel(FileDescriptor socket, std::string name);

    std::string name() const override { return name_; }
    void send(const can_frame_t *frames, std::size_t count,
              LinkClock::time_point deadline) override;
    bool receive(can_frame_t &frame, LinkClock::time_point deadline) override;

  private:
    void send_one(const can_frame_t &frame, LinkClock::time_point deadline);

    FileDescriptor socket_;
    std::string name_;
};

/// Raw socket on the interface; the kernel passes on the lock-step messages only. Throws InputError
/// where the kernel has no CAN, where there is no such interface and where it is down.
SocketCanChannel open_socketcan(const std::string &interface, const std::string &name);

} // namespace quiesce

#endif
