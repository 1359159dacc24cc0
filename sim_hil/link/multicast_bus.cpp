#include "multicast_bus.h"

#include <arpa/inet.h>
#include <array>
#include <cerrno>
#include <charconv>
#include <chrono>
#include <cstring>
#include <netinet/in.h>
#include <sys/socket.h>

#include <nlohmann/json.hpp>

#include "input_error.h"

namespace quiesce {

namespace {

using Map = nlohmann::json;

constexpr std::size_t kMostBytes = 4096; // of a datagram; python-can's own bound

[[noreturn]] void fail(const std::string &bus, const std::string &what) {
    throw InputError("bus " + bus + ": " + what);
}

sockaddr_in address_of(const std::string &bus) {
    const char *const hint = "; write GROUP:PORT, such as 239.74.163.2:43113";
    const std::size_t colon = bus.rfind(':');
    sockaddr_in out{};
    out.sin_family = AF_INET;
    const std::string group = bus.substr(0, colon);
    if (colon == std::string::npos || inet_pton(AF_INET, group.c_str(), &out.sin_addr) != 1 ||
        !IN_MULTICAST(ntohl(out.sin_addr.s_addr))) {
        fail(bus, std::string("no multicast group of IPv4") + hint);
    }
    std::uint16_t port = 0;
    const char *const end = bus.data() + bus.size();
    const auto [stop, error] = std::from_chars(bus.data() + colon + 1, end, port);
    if (error != std::errc() || stop != end || port == 0) {
        fail(bus, std::string("no port") + hint);
    }
    out.sin_port = htons(port);
    return out;
}

const sockaddr *any(const sockaddr_in &address) {
    return reinterpret_cast<const sockaddr *>(&address);
}

/// Throws where one of the steps has failed, with the system's reason.
void must(bool is_done, const std::string &bus) {
    if (!is_done) {
        fail(bus, std::string(std::strerror(errno)) +
                      "; has this computer a route for multicast (ip route)?");
    }
}

template <class Value>
bool option(const FileDescriptor &socket, int level, int name, const Value &value) {
    return setsockopt(socket.number(), level, name, &value, sizeof value) == 0;
}

FileDescriptor datagrams() {
    return FileDescriptor(::socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0));
}

FileDescriptor joined(const sockaddr_in &group, const std::string &bus) {
    FileDescriptor socket = datagrams();
    must(socket.number() >= 0, bus);
    const int is_on = 1;
    must(option(socket, SOL_SOCKET, SO_REUSEADDR, is_on), bus);
    must(option(socket, SOL_SOCKET, SO_REUSEPORT, is_on), bus);
    sockaddr_in port = group;
    port.sin_addr.s_addr = htonl(INADDR_ANY);
    must(bind(socket.number(), any(port), sizeof port) == 0, bus);
    const ip_mreq request = {group.sin_addr, {htonl(INADDR_ANY)}};
    must(option(socket, IPPROTO_IP, IP_ADD_MEMBERSHIP, request), bus);
    return socket;
}

FileDescriptor sending(const sockaddr_in &group, const std::string &bus) {
    FileDescriptor socket = datagrams();
    must(socket.number() >= 0, bus);
    const unsigned char hops = 0;
    must(option(socket, IPPROTO_IP, IP_MULTICAST_TTL, hops), bus);
    must(connect(socket.number(), any(group), sizeof group) == 0, bus);
    return socket;
}

/// A member that says something, where it is there at all.
bool is_set(const Map &map, const char *name) {
    const auto found = map.find(name);
    return found != map.end() && found->is_boolean() && found->get<bool>();
}

bool whole(const Map &map, const char *name, std::uint64_t most, std::uint32_t &value) {
    const auto found = map.find(name);
    if (found == map.end() || !found->is_number_unsigned() || found->get<std::uint64_t>() > most) {
        return false;
    }
    value = found->get<std::uint32_t>();
    return true;
}

bool data_of(const Map &map, can_frame_t &frame) {
    const auto found = map.find("data");
    if (found == map.end() || !found->is_binary()) {
        return frame.is_remote;
    }
    const auto &bytes = found->get_binary();
    if (bytes.size() != (frame.is_remote ? 0 : frame.length)) {
        return false;
    }
    std::copy(bytes.begin(), bytes.end(), std::begin(frame.data));
    return true;
}

} // namespace

std::vector<std::uint8_t> pack_frame(const can_frame_t &frame, double time_s) {
    const std::size_t count = frame.is_remote ? 0 : frame.length;
    const Map map = {
        {"timestamp", time_s},
        {"arbitration_id", frame.id},
        {"is_extended_id", frame.is_extended},
        {"is_remote_frame", frame.is_remote},
        {"is_error_frame", false},
        {"channel", nullptr},
        {"dlc", frame.length},
        {"data", Map::binary({std::begin(frame.data), std::begin(frame.data) + count})},
        {"is_fd", false},
        {"bitrate_switch", false},
        {"error_state_indicator", false},
    };
    return Map::to_msgpack(map);
}

bool unpack_frame(const std::uint8_t *bytes, std::size_t count, can_frame_t &frame) {
    const Map map = Map::from_msgpack(bytes, bytes + count, true, false);
    if (!map.is_object() || is_set(map, "is_fd") || is_set(map, "is_error_frame")) {
        return false;
    }
    can_frame_t out{};
    std::uint32_t length = 0;
    out.is_extended = is_set(map, "is_extended_id");
    out.is_remote = is_set(map, "is_remote_frame");
    const std::uint32_t most_id = out.is_extended ? CAN_MAX_EXTENDED_ID : CAN_MAX_STANDARD_ID;
    if (!whole(map, "arbitration_id", most_id, out.id) ||
        !whole(map, "dlc", CAN_MAX_BYTES, length)) {
        return false;
    }
    out.length = static_cast<std::uint8_t>(length);
    if (!data_of(map, out)) {
        return false;
    }
    frame = out;
    return true;
}

MulticastBus::MulticastBus(const std::string &bus) {
    const sockaddr_in group = address_of(bus);
    in_ = joined(group, bus);
    out_ = sending(group, bus);
    sockaddr_in own{};
    socklen_t size = sizeof own;
    must(getsockname(out_.number(), reinterpret_cast<sockaddr *>(&own), &size) == 0, bus);
    own_port_ = own.sin_port;
}

bool MulticastBus::send(const can_frame_t &frame) {
    const std::chrono::duration<double> now = std::chrono::system_clock::now().time_since_epoch();
    const std::vector<std::uint8_t> bytes = pack_frame(frame, now.count());
    return ::send(out_.number(), bytes.data(), bytes.size(), MSG_NOSIGNAL) ==
           static_cast<ssize_t>(bytes.size());
}

bool MulticastBus::receive(can_frame_t &frame) {
    std::array<std::uint8_t, kMostBytes> bytes{};
    for (;;) {
        sockaddr_in from{};
        socklen_t size = sizeof from;
        const ssize_t count = recvfrom(in_.number(), bytes.data(), bytes.size(), 0,
                                       reinterpret_cast<sockaddr *>(&from), &size);
        if (count < 0) {
            return false;
        }
        if (from.sin_port != own_port_ &&
            unpack_frame(bytes.data(), static_cast<std::size_t>(count), frame)) {
            return true;
        }
    }
}

} // namespace quiesce
