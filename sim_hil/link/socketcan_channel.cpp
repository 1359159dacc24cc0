#include "socketcan_channel.h"

#include <array>
#include <cerrno>
#include <cstring>
#include <fcntl.h>
#include <linux/can.h>
#include <linux/can/raw.h>
#include <net/if.h>
#include <poll.h>
#include <sys/ioctl.h>
#include <sys/socket.h>
#include <thread>
#include <unistd.h>
#include <utility>

#include "descriptor_stream.h"
#include "input_error.h"
#include "lockstep_client.h"

namespace quiesce {

namespace {

/// A full queue has no event to wait for: a 500 kbit/s bus sends a frame in a quarter of this.
constexpr std::chrono::milliseconds kQueuePause(1);

can_frame to_kernel(const can_frame_t &frame) {
    can_frame out{};
    out.can_id =
        frame.id | (frame.is_extended ? CAN_EFF_FLAG : 0u) | (frame.is_remote ? CAN_RTR_FLAG : 0u);
    out.can_dlc = frame.length;
    std::memcpy(out.data, frame.data, frame.length);
    return out;
}

can_frame_t from_kernel(const can_frame &frame) {
    can_frame_t out{};
    out.is_extended = (frame.can_id & CAN_EFF_FLAG) != 0;
    out.is_remote = (frame.can_id & CAN_RTR_FLAG) != 0;
    out.id = frame.can_id & (out.is_extended ? CAN_EFF_MASK : CAN_SFF_MASK);
    out.length = frame.can_dlc;
    std::memcpy(out.data, frame.data, sizeof out.data);
    return out;
}

[[noreturn]] void fail(const std::string &name, int error) {
    switch (error) {
    case EAFNOSUPPORT:
        throw InputError(name + ": the kernel of this machine has no CAN (modules can, can_raw); "
                                "use a slcan: channel");
    case ENODEV:
    case ENXIO:
        throw InputError(name + ": no such CAN interface; ip link lists those there are");
    case ENETDOWN:
        throw InputError(name + ": the interface is down; "
                                "ip link set it up, type can with its bitrate");
    default:
        throw InputError(name + ": " + std::strerror(error));
    }
}

void bind_to(const FileDescriptor &socket, const std::string &interface, const std::string &name) {
    ifreq request{};
    if (interface.empty() || interface.size() >= sizeof request.ifr_name) {
        fail(name, ENODEV);
    }
    std::memcpy(request.ifr_name, interface.data(), interface.size());
    if (ioctl(socket.number(), SIOCGIFINDEX, &request) != 0) {
        fail(name, errno);
    }
    sockaddr_can address{};
    address.can_family = AF_CAN;
    address.can_ifindex = request.ifr_ifindex;
    if (bind(socket.number(), reinterpret_cast<const sockaddr *>(&address), sizeof address) != 0) {
        fail(name, errno);
    }
    if (ioctl(socket.number(), SIOCGIFFLAGS, &request) == 0 && (request.ifr_flags & IFF_UP) == 0) {
        fail(name, ENETDOWN);
    }
}

} // namespace

SocketCanChannel::SocketCanChannel(FileDescriptor socket, std::string name)
    : socket_(std::move(socket)), name_(std::move(name)) {
    const int flags = fcntl(socket_.number(), F_GETFL);
    if (flags < 0 || fcntl(socket_.number(), F_SETFL, flags | O_NONBLOCK) != 0) {
        fail(name_, errno);
    }
}

void SocketCanChannel::send(const can_frame_t *frames, std::size_t count,
                            LinkClock::time_point deadline) {
    for (std::size_t i = 0; i < count; ++i) {
        send_one(frames[i], deadline);
    }
}

void SocketCanChannel::send_one(const can_frame_t &frame, LinkClock::time_point deadline) {
    const can_frame out = to_kernel(frame);
    while (::send(socket_.number(), &out, sizeof out, MSG_NOSIGNAL) != sizeof out) {
        if (errno == ENOBUFS) {
            std::this_thread::sleep_for(kQueuePause);
        } else if (errno == EAGAIN || errno == EWOULDBLOCK) {
            wait_ready(socket_, POLLOUT, deadline);
        } else if (errno != EINTR) {
            fail(name_, errno);
        }
        if (LinkClock::now() > deadline) {
            throw InputError(name_ + ": the bus takes no frames; is anybody on it to acknowledge?");
        }
    }
}

bool SocketCanChannel::receive(can_frame_t &frame, LinkClock::time_point deadline) {
    while (wait_ready(socket_, POLLIN, deadline)) {
        can_frame in{};
        const ssize_t count = ::read(socket_.number(), &in, sizeof in);
        if (count == 0) {
            throw InputError(name_ + ": the other side has closed the line");
        }
        if (count < 0 && errno != EAGAIN && errno != EINTR) {
            fail(name_, errno);
        }
        if (count == sizeof in && in.can_dlc <= CAN_MAX_DLEN && (in.can_id & CAN_ERR_FLAG) == 0) {
            frame = from_kernel(in);
            return true;
        }
        if (LinkClock::now() > deadline) {
            break;
        }
    }
    return false;
}

SocketCanChannel open_socketcan(const std::string &interface, const std::string &name) {
    FileDescriptor socket(::socket(PF_CAN, SOCK_RAW | SOCK_CLOEXEC, CAN_RAW));
    if (socket.number() < 0) {
        fail(name, errno);
    }
    const can_filter filter = {LockstepClient::kFirstId,
                               LockstepClient::kIdMask | CAN_EFF_FLAG | CAN_RTR_FLAG};
    if (setsockopt(socket.number(), SOL_CAN_RAW, CAN_RAW_FILTER, &filter, sizeof filter) != 0) {
        fail(name, errno);
    }
    bind_to(socket, interface, name);
    return SocketCanChannel(std::move(socket), name);
}

} // namespace quiesce
