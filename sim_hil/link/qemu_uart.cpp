#include "qemu_uart.h"

#include <cerrno>
#include <sys/socket.h>
#include <system_error>
#include <utility>

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

QemuUart::Line::Line() {
    int ends[2];
    if (socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, ends) != 0) {
        throw std::system_error(errno, std::generic_category(), "socketpair");
    }
    bench = FileDescriptor(ends[0]);
    qemu = FileDescriptor(ends[1]);
}

QemuUart::QemuUart(const QemuOptions &options)
    : options_(options), counter_(options),
      process_(options.image_path, qemu_arguments(line_.qemu.number(), counter_),
               inherited(line_.qemu.number(), counter_)),
      stream_(std::move(line_.bench), "image " + options.image_path) {
    line_.qemu.close(); // QEMU's end closes with QEMU: receive then sees the end of the stream
}

void QemuUart::send(const std::uint8_t *bytes, std::size_t count, LinkClock::time_point deadline) {
    try {
        stream_.send(bytes, count, deadline);
    } catch (const InputError &) {
        fail_if_ended();
        throw;
    }
}

std::size_t QemuUart::receive(std::uint8_t *bytes, std::size_t capacity,
                              LinkClock::time_point deadline) {
    try {
        return stream_.receive(bytes, capacity, deadline);
    } catch (const InputError &) {
        fail_if_ended();
        throw;
    }
}

void QemuUart::await_greeting() {
    const auto deadline = answer_deadline();
    std::uint8_t byte = 0;
    while (byte != '\r') {
        if (receive(&byte, 1, deadline) == 0) {
            throw InputError(name() + ": no answer within " +
                             std::to_string(options_.answer_time.count()) + " ms" +
                             kUartSilenceHint);
        }
    }
}

std::optional<InstructionCounts> QemuUart::finish() {
    if (!process_.wait_for_end(options_.answer_time) || !process_.has_succeeded()) {
        throw InputError(name() + ": did not end when told to");
    }
    return counter_.read();
}

void QemuUart::fail_if_ended() {
    constexpr std::chrono::milliseconds kReapTime(
        500); // the stream ends shortly before the process
    if (process_.wait_for_end(kReapTime)) {
        throw InputError(name() + ": " + process_.describe_end());
    }
}

} // namespace quiesce
