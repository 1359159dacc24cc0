#include "lockstep_peer.h"

#include <array>
#include <cerrno>
#include <cstdint>
#include <cstdlib>
#include <fcntl.h>
#include <poll.h>
#include <stdexcept>
#include <sys/eventfd.h>
#include <sys/socket.h>
#include <system_error>
#include <termios.h>
#include <unistd.h>

extern "C" {
#include "lockstep_can.h"
}

namespace quiesce {

struct PeerServer {
    lockstep_can_t lockstep;
    slcan_decoder_t decoder;
};

namespace {

[[noreturn]] void fail(const char *what) {
    throw std::system_error(errno, std::generic_category(), what);
}

bool write_all(const FileDescriptor &line, const std::string &bytes) {
    for (std::size_t sent = 0; sent < bytes.size();) {
        ssize_t step = send(line.number(), bytes.data() + sent, bytes.size() - sent, MSG_NOSIGNAL);
        if (step < 0 && errno == ENOTSOCK) {
            step = write(line.number(), bytes.data() + sent, bytes.size() - sent);
        }
        if (step > 0) {
            sent += static_cast<std::size_t>(step);
        } else if (errno != EINTR) {
            return false;
        }
    }
    return true;
}

} // namespace

LockstepPeer::LockstepPeer(FileDescriptor line, Tamper tamper)
    : line_(std::move(line)), stop_(eventfd(0, EFD_CLOEXEC)), tamper_(std::move(tamper)),
      server_(std::make_unique<PeerServer>()) {
    lockstep_can_init(&server_->lockstep);
    slcan_decoder_init(&server_->decoder);
    thread_ = std::thread([this] { serve(); });
}

LockstepPeer::~LockstepPeer() {
    const std::uint64_t one = 1;
    if (write(stop_.number(), &one, sizeof one) == sizeof one) {
        thread_.join();
    }
}

void LockstepPeer::serve() {
    std::array<char, 4096> block;
    std::array<pollfd, 2> ready = {{{line_.number(), POLLIN, 0}, {stop_.number(), POLLIN, 0}}};
    while (poll(ready.data(), ready.size(), -1) > 0 && ready[1].revents == 0) {
        const ssize_t count = read(line_.number(), block.data(), block.size());
        if (count <= 0 ||
            !serve_bytes(std::string(block.data(), static_cast<std::size_t>(count)))) {
            line_.close();
            return;
        }
    }
}

bool LockstepPeer::serve_bytes(const std::string &bytes) {
    can_frame_t request;
    for (const char byte : bytes) {
        if (slcan_decode(&server_->decoder, static_cast<std::uint8_t>(byte), &request) &&
            !answer(request)) {
            return false;
        }
    }
    return true;
}

bool LockstepPeer::answer(const can_frame_t &request) {
    std::vector<can_frame_t> replies(LOCKSTEP_CAN_MAX_REPLIES);
    replies.resize(lockstep_can_receive(&server_->lockstep, &request, replies.data()));
    std::string bytes;
    if (tamper_) {
        const std::optional<std::string> before = tamper_(request, replies);
        if (!before) {
            return false;
        }
        bytes = *before;
    }
    for (const can_frame_t &reply : replies) {
        bytes += slcan_line(reply);
    }
    return write_all(line_, bytes);
}

std::pair<FileDescriptor, FileDescriptor> socket_pair(int type) {
    int ends[2];
    if (socketpair(AF_UNIX, type | SOCK_CLOEXEC, 0, ends) != 0) {
        fail("socketpair");
    }
    return {FileDescriptor(ends[0]), FileDescriptor(ends[1])};
}

Pty make_pty() {
    Pty pty{FileDescriptor(posix_openpt(O_RDWR | O_NOCTTY | O_CLOEXEC)), ""};
    std::array<char, 64> name{};
    if (pty.master.number() < 0 || grantpt(pty.master.number()) != 0 ||
        unlockpt(pty.master.number()) != 0 ||
        ptsname_r(pty.master.number(), name.data(), name.size()) != 0) {
        fail("pty");
    }
    pty.path = name.data();
    return pty;
}

std::string slcan_line(const can_frame_t &frame) {
    std::array<std::uint8_t, SLCAN_MAX_BYTES> line;
    const std::size_t length = slcan_encode(&frame, line.data());
    return {reinterpret_cast<const char *>(line.data()), length};
}

} // namespace quiesce
