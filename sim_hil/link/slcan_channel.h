/// CAN frames as SLCAN lines on a stream.
#ifndef QUIESCE_SLCAN_CHANNEL_H
#define QUIESCE_SLCAN_CHANNEL_H

#include <array>
#include <memory>

#include "byte_stream.h"
#include "frame_channel.h"

namespace quiesce {

/// Lines that are no frame are dropped.
class SlcanChannel final : public FrameChannel {
  public:
    /// The stream stays the caller's and must outlive the channel.
    explicit SlcanChannel(ByteStream &stream) : stream_(stream) { slcan_decoder_init(&decoder_); }

    std::string name() const override { return stream_.name(); }
    void send(const can_frame_t *frames, std::size_t count,
              LinkClock::time_point deadline) override;
    bool receive(can_frame_t &frame, LinkClock::time_point deadline) override;

    std::size_t sent_bytes() const { return sent_bytes_; }
    std::size_t received_bytes() const { return received_bytes_; }

  private:
    ByteStream &stream_;
    slcan_decoder_t decoder_{};
    std::array<std::uint8_t, 4096> input_{};
    std::size_t input_begin_ = 0;
    std::size_t input_end_ = 0;
    std::size_t sent_bytes_ = 0;
    std::size_t received_bytes_ = 0;
};

/// SLCAN on a stream of its own. bitrate: bit/s of the bus that an adapter is told to set before it
/// is opened, and which it closes at the end; 0: the other side needs no such commands.
/// Throws InputError where SLCAN has no code for the bit rate.
std::unique_ptr<FrameChannel> make_slcan_channel(std::unique_ptr<ByteStream> stream,
                                                 std::uint32_t bitrate);

} // namespace quiesce

#endif
