/// The other end of a CAN channel: the real lock-step server in a thread, on an open descriptor.
#ifndef QUIESCE_TEST_LOCKSTEP_PEER_H
#define QUIESCE_TEST_LOCKSTEP_PEER_H

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "byte_stream.h"
#include "file_descriptor.h"
#include "firmware_comm.h"

namespace quiesce {

/// What a peer does to the server's answer before it is sent: alters the replies, returns bytes
/// that go before them. Nothing: closes the line instead.
using Tamper = std::function<std::optional<std::string>(const can_frame_t &request,
                                                        std::vector<can_frame_t> &replies)>;

/// Serves until the line closes or the peer goes.
class LockstepPeer {
  public:
    /// line: stream of SLCAN lines.
    explicit LockstepPeer(FileDescriptor line, Tamper tamper = {});
    LockstepPeer(const LockstepPeer &) = delete;
    LockstepPeer &operator=(const LockstepPeer &) = delete;
    ~LockstepPeer();

  private:
    void serve();
    bool serve_bytes(const std::string &bytes);
    bool answer(const can_frame_t &request);

    FileDescriptor line_;
    FileDescriptor stop_; ///< readable once the thread is to end
    Tamper tamper_;
    std::unique_ptr<struct PeerServer> server_;
    std::thread thread_;
};

/// Two connected streams: the bench's end, the peer's.
std::pair<FileDescriptor, FileDescriptor> socket_pair(int type);

/// A pty: its master, and the path of its other side.
struct Pty {
    FileDescriptor master;
    std::string path;
};
Pty make_pty();

/// The peer's half of a message of the target, as an SLCAN line.
std::string slcan_line(const can_frame_t &frame);

} // namespace quiesce

#endif
