#include "notify.h"

#include <cstddef>
#include <cstdlib>
#include <cstring>

#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

namespace quiesced {

namespace {

std::int64_t positive_number(const char *text) {
    char *end = nullptr;
    const long long value = text == nullptr ? 0 : std::strtoll(text, &end, 10);
    return end != nullptr && *end == '\0' && value > 0 && value < INT64_MAX / 1000 ? value : 0;
}

/// A path, or '@' and the name of an abstract socket. Returns a connected socket or -1.
int connect_to(const char *name) {
    sockaddr_un address{};
    address.sun_family = AF_UNIX;
    const std::size_t length = name == nullptr ? 0 : std::strlen(name);
    if (length < 2 || length >= sizeof address.sun_path || (name[0] != '/' && name[0] != '@')) {
        return -1;
    }
    std::memcpy(address.sun_path, name, length);
    if (name[0] == '@') {
        address.sun_path[0] = '\0';
    }
    const int fd = socket(AF_UNIX, SOCK_DGRAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0);
    const auto bytes = static_cast<socklen_t>(offsetof(sockaddr_un, sun_path) + length);
    if (fd >= 0 && connect(fd, reinterpret_cast<const sockaddr *>(&address), bytes) == 0) {
        return fd;
    }
    if (fd >= 0) {
        close(fd);
    }
    return -1;
}

} // namespace

Notifier::Notifier() : socket_(connect_to(std::getenv("NOTIFY_SOCKET"))) {
    const std::int64_t pid = positive_number(std::getenv("WATCHDOG_PID"));
    if (socket_ >= 0 && (pid == 0 || pid == getpid())) {
        watchdog_period_ns_ = positive_number(std::getenv("WATCHDOG_USEC")) * 1000 / 2;
    }
}

Notifier::~Notifier() {
    if (socket_ >= 0) {
        close(socket_);
    }
}

void Notifier::send(std::string_view state) const {
    if (socket_ >= 0) {
        (void)::send(socket_, state.data(), state.size(), MSG_NOSIGNAL | MSG_DONTWAIT);
    }
}

} // namespace quiesced
