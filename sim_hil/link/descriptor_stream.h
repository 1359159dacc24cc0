/// A stream on an open descriptor: socket, serial line or pty.
#ifndef QUIESCE_DESCRIPTOR_STREAM_H
#define QUIESCE_DESCRIPTOR_STREAM_H

#include "byte_stream.h"
#include "file_descriptor.h"

namespace quiesce {

class DescriptorStream final : public ByteStream {
  public:
    /// descriptor: becomes non-blocking. name: for error lines.
    DescriptorStream(FileDescriptor descriptor, std::string name);

    std::string name() const override { return name_; }
    void send(const std::uint8_t *bytes, std::size_t count,
              LinkClock::time_point deadline) override;
    std::size_t receive(std::uint8_t *bytes, std::size_t capacity,
                        LinkClock::time_point deadline) override;

  private:
    FileDescriptor descriptor_;
    std::string name_;
    bool is_socket_;
};

/// Waits until the descriptor is ready for events (of poll) or at its end. Returns false iff it was
/// not by the deadline.
bool wait_ready(const FileDescriptor &descriptor, short events, LinkClock::time_point deadline);

} // namespace quiesce

#endif
