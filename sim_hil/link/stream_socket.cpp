#include <cerrno>
#include <cstring>
#include <netdb.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <utility>

#include "descriptor_stream.h"
#include "input_error.h"
#include "stream_openers.h"

namespace quiesce {

namespace {

using Addresses = std::unique_ptr<addrinfo, decltype(&freeaddrinfo)>;

[[noreturn]] void fail(const std::string &name, int error) {
    throw InputError(name + ": " + std::strerror(error) +
                     (error == ECONNREFUSED ? "; nobody listens there" : ""));
}

Addresses look_up(const std::string &host, const std::string &port, const std::string &name) {
    addrinfo hints{};
    hints.ai_socktype = SOCK_STREAM;
    addrinfo *found = nullptr;
    const int error = getaddrinfo(host.c_str(), port.c_str(), &hints, &found);
    if (error != 0) {
        throw InputError(name + ": " + gai_strerror(error));
    }
    return {found, &freeaddrinfo};
}

} // namespace

std::unique_ptr<ByteStream> open_unix_socket(const std::string &path, const std::string &name) {
    sockaddr_un address{};
    address.sun_family = AF_UNIX;
    if (path.size() >= sizeof address.sun_path) {
        throw InputError(name + ": the path is too long for a socket, at most " +
                         std::to_string(sizeof address.sun_path - 1) + " bytes");
    }
    std::memcpy(address.sun_path, path.data(), path.size());
    FileDescriptor line(socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0));
    if (line.number() < 0 ||
        connect(line.number(), reinterpret_cast<const sockaddr *>(&address), sizeof address) != 0) {
        fail(name, errno);
    }
    return std::make_unique<DescriptorStream>(std::move(line), name);
}

std::unique_ptr<ByteStream> open_tcp_socket(const std::string &host, const std::string &port,
                                            const std::string &name) {
    const Addresses addresses = look_up(host, port, name);
    int error = 0;
    for (const addrinfo *at = addresses.get(); at != nullptr; at = at->ai_next) {
        FileDescriptor line(socket(at->ai_family, at->ai_socktype | SOCK_CLOEXEC, at->ai_protocol));
        if (line.number() >= 0 && connect(line.number(), at->ai_addr, at->ai_addrlen) == 0) {
            const int is_on = 1; // a stimulus must not wait for more bytes to send
            setsockopt(line.number(), IPPROTO_TCP, TCP_NODELAY, &is_on, sizeof is_on);
            return std::make_unique<DescriptorStream>(std::move(line), name);
        }
        error = errno;
    }
    fail(name, error);
}

} // namespace quiesce
