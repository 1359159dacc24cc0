#include "descriptor_stream.h"

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <fcntl.h>
#include <poll.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <unistd.h>
#include <utility>

#include "input_error.h"

namespace quiesce {

namespace {

bool is_socket(int number) {
    struct stat status {};
    return fstat(number, &status) == 0 && S_ISSOCK(status.st_mode);
}

bool is_transient(int error) {
    return error == EAGAIN || error == EWOULDBLOCK || error == EINTR;
}

[[noreturn]] void fail_closed(const std::string &name) {
    throw InputError(name + ": the other side has closed the line");
}

/// A line that ends (hang-up of a pty, reset of a connection) reads like one that was closed.
[[noreturn]] void fail_io(const std::string &name, int error) {
    if (error == EIO || error == ECONNRESET || error == EPIPE) {
        fail_closed(name);
    }
    throw InputError(name + ": " + std::strerror(error));
}

} // namespace

bool wait_ready(const FileDescriptor &descriptor, short events, LinkClock::time_point deadline) {
    for (;;) {
        const auto left = std::chrono::ceil<std::chrono::milliseconds>(deadline - LinkClock::now());
        pollfd ready{descriptor.number(), events, 0};
        const auto time_ms = std::clamp<std::int64_t>(left.count(), 0, 1 << 30);
        const int count = poll(&ready, 1, static_cast<int>(time_ms));
        if (count > 0) {
            return true;
        }
        if (count == 0) {
            return false;
        }
        if (errno != EINTR) {
            throw InputError(std::string("poll: ") + std::strerror(errno));
        }
    }
}

DescriptorStream::DescriptorStream(FileDescriptor descriptor, std::string name)
    : descriptor_(std::move(descriptor)), name_(std::move(name)),
      is_socket_(is_socket(descriptor_.number())) {
    const int flags = fcntl(descriptor_.number(), F_GETFL);
    if (flags < 0 || fcntl(descriptor_.number(), F_SETFL, flags | O_NONBLOCK) != 0) {
        throw InputError(name_ + ": " + std::strerror(errno));
    }
}

void DescriptorStream::send(const std::uint8_t *bytes, std::size_t count,
                            LinkClock::time_point deadline) {
    std::size_t sent = 0;
    while (sent < count) {
        const ssize_t step =
            is_socket_ ? ::send(descriptor_.number(), bytes + sent, count - sent, MSG_NOSIGNAL)
                       : ::write(descriptor_.number(), bytes + sent, count - sent);
        if (step > 0) {
            sent += static_cast<std::size_t>(step);
        } else if (step < 0 && !is_transient(errno)) {
            fail_io(name_, errno);
        } else if (!wait_ready(descriptor_, POLLOUT, deadline)) {
            throw InputError(name_ + ": the other side takes no bytes");
        }
    }
}

std::size_t DescriptorStream::receive(std::uint8_t *bytes, std::size_t capacity,
                                      LinkClock::time_point deadline) {
    while (wait_ready(descriptor_, POLLIN, deadline)) {
        const ssize_t count = ::read(descriptor_.number(), bytes, capacity);
        if (count > 0) {
            return static_cast<std::size_t>(count);
        }
        if (count == 0) {
            fail_closed(name_);
        }
        if (!is_transient(errno)) {
            fail_io(name_, errno);
        }
    }
    return 0;
}

} // namespace quiesce
