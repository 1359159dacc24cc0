#include "qemu_uart.h"

#include <cerrno>
#include <sys/socket.h>
#include <sys/time.h>
#include <system_error>

#include "input_error.h"

namespace quiesce {

namespace {

std::vector<std::string> qemu_arguments(int line, const InstructionCounter &counter) {
    std::vector<std::string> arguments = {"-M",       "mps2-an386",
                                          "-chardev", "socket,id=uart,fd=" + std::to_string(line),
                                          "-serial",  "chardev:uart"};
    for (const std::string &word : counter.qemu_arguments()) {
        arguments.push_back(word);
    }
    return arguments;
}

std::vector<int> inherited(int line, const InstructionCounter &counter) {
    std::vector<int> numbers = counter.inherited();
    numbers.push_back(line);
    return numbers;
}

} // namespace

QemuUart::Line::Line(std::chrono::milliseconds receive_time) {
    int ends[2];
    if (socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, ends) != 0) {
        throw std::system_error(errno, std::generic_category(), "socketpair");
    }
    bench = FileDescriptor(ends[0]);
    qemu = FileDescriptor(ends[1]);
    timeval time{};
    time.tv_sec = receive_time.count() / 1000;
    time.tv_usec = receive_time.count() % 1000 * 1000;
    setsockopt(ends[0], SOL_SOCKET, SO_RCVTIMEO, &time, sizeof time);
    setsockopt(ends[0], SOL_SOCKET, SO_SNDTIMEO, &time, sizeof time);
}

QemuUart::QemuUart(const QemuOptions &options)
    : options_(options), counter_(options), line_(options.answer_time),
      process_(options.image_path, qemu_arguments(line_.qemu.number(), counter_),
               inherited(line_.qemu.number(), counter_)) {
    line_.qemu.close(); // QEMU's end closes with QEMU: receive then sees the end of the stream
}

void QemuUart::send(const std::uint8_t *bytes, std::size_t count) {
    std::size_t sent = 0;
    while (sent < count) {
        const ssize_t step = ::send(line_.bench.number(), bytes + sent, count - sent, MSG_NOSIGNAL);
        if (step < 0 && errno == EINTR) {
            continue;
        }
        if (step <= 0) {
            fail_by_end();
        }
        sent += static_cast<std::size_t>(step);
    }
}

std::size_t QemuUart::receive(std::uint8_t *bytes, std::size_t capacity) {
    for (;;) {
        const ssize_t count = ::recv(line_.bench.number(), bytes, capacity, 0);
        if (count > 0) {
            return static_cast<std::size_t>(count);
        }
        if (count == 0 || errno != EINTR) {
            fail_by_end();
        }
    }
}

void QemuUart::await_greeting() {
    std::uint8_t byte = 0;
    while (byte != '\r') {
        receive(&byte, 1);
    }
}

std::optional<InstructionCounts> QemuUart::finish() {
    if (!process_.wait_for_end(options_.answer_time) || !process_.has_succeeded()) {
        throw InputError("image " + options_.image_path + ": did not end when told to");
    }
    return counter_.read();
}

void QemuUart::fail_by_end() {
    constexpr std::chrono::milliseconds kReapTime(
        500); // the stream ends shortly before the process
    if (process_.wait_for_end(kReapTime)) {
        throw InputError("image " + options_.image_path + ": " + process_.describe_end());
    }
    throw InputError("image " + options_.image_path + ": no answer within " +
                     std::to_string(options_.answer_time.count()) +
                     " ms; is it the UART image (quiesce_mps2_uart)?");
}

} // namespace quiesce
