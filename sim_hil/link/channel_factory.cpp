#include "channel_factory.h"

#include <charconv>
#include <cstring>
#include <fcntl.h>
#include <optional>

#include "descriptor_stream.h"
#include "input_error.h"
#include "slcan_channel.h"
#include "socketcan_channel.h"
#include "stream_openers.h"

namespace quiesce {

namespace {

[[noreturn]] void fail(const std::string &channel, const std::string &what) {
    throw InputError("--can " + channel + ": " + what +
                     "; give one of slcan:/dev/ttyACM0[,baud=N][,bitrate=N], slcan:unix:PATH, "
                     "slcan:tcp:HOST:PORT, socketcan:can0");
}

/// What follows prefix; nothing iff text does not begin with it.
std::optional<std::string> after(const std::string &text, const char *prefix) {
    const std::size_t length = std::strlen(prefix);
    return text.compare(0, length, prefix) == 0 ? std::optional(text.substr(length)) : std::nullopt;
}

std::unique_ptr<FrameChannel> open_unix(const std::string &path, const std::string &channel) {
    if (path.empty()) {
        fail(channel, "names no path");
    }
    return make_slcan_channel(open_unix_socket(path, channel), 0);
}

std::unique_ptr<FrameChannel> open_tcp(const std::string &address, const std::string &channel) {
    const std::size_t colon = address.rfind(':');
    if (colon == std::string::npos || colon == 0 || colon + 1 == address.size()) {
        fail(channel, "names no host and port");
    }
    return make_slcan_channel(
        open_tcp_socket(address.substr(0, colon), address.substr(colon + 1), channel), 0);
}

std::unique_ptr<FrameChannel> open_inherited(const std::string &number,
                                             const std::string &channel) {
    int descriptor = 0;
    const char *end = number.data() + number.size();
    const auto [stop, error] = std::from_chars(number.data(), end, descriptor);
    if (error != std::errc() || stop != end || fcntl(descriptor, F_GETFD) < 0) {
        fail(channel, "is no descriptor that this program was given");
    }
    return make_slcan_channel(
        std::make_unique<DescriptorStream>(FileDescriptor(descriptor), channel), 0);
}

struct LineSettings {
    std::string path;
    std::uint32_t baud = 0;
    std::uint32_t bitrate = 0;
};

std::uint32_t positive(const std::string &text, const std::string &channel) {
    std::uint32_t value = 0;
    const char *end = text.data() + text.size();
    const auto [stop, error] = std::from_chars(text.data(), end, value);
    if (error != std::errc() || stop != end || value == 0) {
        fail(channel, "\"" + text + "\" is no rate");
    }
    return value;
}

/// PATH[,baud=N][,bitrate=N]
LineSettings parse_line(const std::string &text, const std::string &channel) {
    LineSettings settings;
    std::size_t end = text.find(',');
    settings.path = text.substr(0, end);
    while (end != std::string::npos) {
        const std::size_t begin = end + 1;
        end = text.find(',', begin);
        const std::string word = text.substr(begin, end == std::string::npos ? end : end - begin);
        if (const auto baud = after(word, "baud=")) {
            settings.baud = positive(*baud, channel);
        } else if (const auto bitrate = after(word, "bitrate=")) {
            settings.bitrate = positive(*bitrate, channel);
        } else {
            fail(channel, "\"" + word + "\" is no setting of a serial line");
        }
    }
    return settings;
}

std::unique_ptr<FrameChannel> open_line(const std::string &text, const std::string &channel) {
    const LineSettings settings = parse_line(text, channel);
    if (settings.path.empty()) {
        fail(channel, "names no device");
    }
    return make_slcan_channel(open_serial_line(settings.path, settings.baud, channel),
                              settings.bitrate);
}

std::unique_ptr<FrameChannel> open_interface(const std::string &interface,
                                             const std::string &channel) {
    return std::make_unique<SocketCanChannel>(open_socketcan(interface, channel));
}

struct Kind {
    const char *prefix;
    std::unique_ptr<FrameChannel> (*open)(const std::string &rest, const std::string &channel);
};

/// The first that fits.
const Kind kKinds[] = {{"slcan:unix:", open_unix},
                       {"slcan:tcp:", open_tcp},
                       {"slcan:fd:", open_inherited},
                       {"slcan:", open_line},
                       {"socketcan:", open_interface}};

} // namespace

std::unique_ptr<FrameChannel> open_channel(const std::string &channel) {
    for (const Kind &kind : kKinds) {
        if (const auto rest = after(channel, kind.prefix)) {
            return kind.open(*rest, channel);
        }
    }
    fail(channel, "is no CAN channel");
}

} // namespace quiesce
