/// An image under QEMU whose UART0 is a socket of this process: bytes out, bytes in.
#ifndef QUIESCE_QEMU_UART_H
#define QUIESCE_QEMU_UART_H

#include <cstddef>
#include <cstdint>

#include "byte_stream.h"
#include "descriptor_stream.h"
#include "instruction_counter.h"
#include "qemu_process.h"

namespace quiesce {

/// Ends the line about an image that does not answer.
inline constexpr const char *kUartSilenceHint = "; is it the UART image (quiesce_mps2_uart)?";

class QemuUart final : public ByteStream {
  public:
    /// Starts the image. Throws InputError as QemuProcess and InstructionCounter do.
    explicit QemuUart(const QemuOptions &options);

    std::string name() const override { return "image " + options_.image_path; }

    /// When the image has ended, the line says how.
    void send(const std::uint8_t *bytes, std::size_t count,
              LinkClock::time_point deadline) override;
    std::size_t receive(std::uint8_t *bytes, std::size_t capacity,
                        LinkClock::time_point deadline) override;

    /// Deadline of an answer that the image is asked for now.
    LinkClock::time_point answer_deadline() const {
        return LinkClock::now() + options_.answer_time;
    }

    /// Waits for the image's greeting, a line that ends with CR: what is sent before it listens may
    /// be lost. Throws InputError, too, when it does not come within options.answer_time.
    void await_greeting();

    /// Waits for the image to end by itself. Throws InputError when it does not.
    std::optional<InstructionCounts> finish();

    void pause() { process_.pause(); }
    void resume() { process_.resume(); }
    pid_t process_id() const { return process_.id(); }

  private:
    void fail_if_ended();

    /// The two ends of the line; QEMU inherits its own.
    struct Line {
        Line();
        FileDescriptor bench;
        FileDescriptor qemu;
    };

    QemuOptions options_;
    InstructionCounter counter_;
    Line line_;
    QemuProcess process_;
    DescriptorStream stream_;
};

} // namespace quiesce

#endif
