/// An image under QEMU whose UART0 is a socket of this process: bytes out, bytes in.
#ifndef QUIESCE_QEMU_UART_H
#define QUIESCE_QEMU_UART_H

#include <cstddef>
#include <cstdint>

#include "instruction_counter.h"
#include "qemu_process.h"

namespace quiesce {

class QemuUart {
  public:
    /// Starts the image. Throws InputError as QemuProcess and InstructionCounter do.
    explicit QemuUart(const QemuOptions &options);

    /// Sends all bytes. Throws InputError when the image has ended.
    void send(const std::uint8_t *bytes, std::size_t count);

    /// Waits for bytes; returns how many came, 1 .. capacity. Throws InputError when the image has
    /// ended or nothing arrives within options.answer_time.
    std::size_t receive(std::uint8_t *bytes, std::size_t capacity);

    /// Waits for the image's greeting, a line that ends with CR: what is sent before it listens may
    /// be lost. Throws InputError as receive does.
    void await_greeting();

    /// Waits for the image to end by itself. Throws InputError when it does not.
    std::optional<InstructionCounts> finish();

    void pause() { process_.pause(); }
    void resume() { process_.resume(); }
    pid_t process_id() const { return process_.id(); }

  private:
    [[noreturn]] void fail_by_end();

    /// The two ends of the line; QEMU inherits its own.
    struct Line {
        explicit Line(std::chrono::milliseconds receive_time);
        FileDescriptor bench;
        FileDescriptor qemu;
    };

    QemuOptions options_;
    InstructionCounter counter_;
    Line line_;
    QemuProcess process_;
};

} // namespace quiesce

#endif
