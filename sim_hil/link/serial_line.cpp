#include <array>
#include <cerrno>
#include <cstring>
#include <fcntl.h>
#include <sys/file.h>
#include <termios.h>
#include <utility>

#include "descriptor_stream.h"
#include "input_error.h"
#include "stream_openers.h"

namespace quiesce {

namespace {

struct Speed {
    std::uint32_t baud;
    speed_t code;
};

constexpr std::array<Speed, 12> kSpeeds = {{{9600, B9600},
                                            {19200, B19200},
                                            {38400, B38400},
                                            {57600, B57600},
                                            {115200, B115200},
                                            {230400, B230400},
                                            {460800, B460800},
                                            {500000, B500000},
                                            {921600, B921600},
                                            {1000000, B1000000},
                                            {2000000, B2000000},
                                            {3000000, B3000000}}};

[[noreturn]] void fail(const std::string &name, int error) {
    throw InputError(name + ": " + std::strerror(error));
}

speed_t speed_of(std::uint32_t baud, const std::string &name) {
    std::string known;
    for (const Speed &speed : kSpeeds) {
        if (speed.baud == baud) {
            return speed.code;
        }
        known += (known.empty() ? "" : ", ") + std::to_string(speed.baud);
    }
    throw InputError(name + ": no such baud rate; choose one of " + known);
}

void make_raw(const FileDescriptor &line, std::uint32_t baud, const std::string &name) {
    termios settings{};
    if (tcgetattr(line.number(), &settings) != 0) {
        throw InputError(name + ": is no serial line or pty");
    }
    cfmakeraw(&settings);
    settings.c_cflag |= CLOCAL | CREAD;
    if (baud != 0) {
        cfsetspeed(&settings, speed_of(baud, name));
    }
    if (tcsetattr(line.number(), TCSANOW, &settings) != 0) {
        fail(name, errno);
    }
}

} // namespace

std::unique_ptr<ByteStream> open_serial_line(const std::string &path, std::uint32_t baud,
                                             const std::string &name) {
    FileDescriptor line(open(path.c_str(), O_RDWR | O_NOCTTY | O_NONBLOCK | O_CLOEXEC));
    if (line.number() < 0) {
        fail(name, errno);
    }
    if (flock(line.number(), LOCK_EX | LOCK_NB) != 0) {
        throw InputError(name + ": another program has locked it; is a second bench running?");
    }
    make_raw(line, baud, name);
    return std::make_unique<DescriptorStream>(std::move(line), name);
}

} // namespace quiesce
