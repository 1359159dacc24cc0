#include "slcan_channel.h"

#include <utility>

#include "input_error.h"

namespace quiesce {

namespace {

/// For an adapter's commands, which it takes at once or not at all.
constexpr std::chrono::seconds kCommandTime(1);

constexpr std::array<std::uint32_t, 9> kBitrates = {10000,  20000,  50000,  100000, 125000,
                                                    250000, 500000, 800000, 1000000};

/// "S6" for 500 kbit/s.
std::string bitrate_command(std::uint32_t bitrate, const std::string &name) {
    std::string known;
    for (std::size_t code = 0; code < kBitrates.size(); ++code) {
        if (kBitrates[code] == bitrate) {
            return "S" + std::to_string(code);
        }
        known += (known.empty() ? "" : ", ") + std::to_string(kBitrates[code]);
    }
    throw InputError(name + ": SLCAN has no bit rate " + std::to_string(bitrate) +
                     "; choose one of " + known);
}

/// Channel and stream in one.
class OwningSlcanChannel final : public FrameChannel {
  public:
    OwningSlcanChannel(std::unique_ptr<ByteStream> stream, std::uint32_t bitrate)
        : stream_(std::move(stream)), channel_(*stream_), is_adapter_(bitrate != 0) {
        if (is_adapter_) { // closed first: an open adapter takes no bit rate
            command("\rC\r" + bitrate_command(bitrate, name()) + "\rO\r");
        }
    }

    OwningSlcanChannel(const OwningSlcanChannel &) = delete;
    OwningSlcanChannel &operator=(const OwningSlcanChannel &) = delete;

    ~OwningSlcanChannel() override {
        if (is_adapter_) {
            try {
                command("C\r");
            } catch (const InputError &) {
                is_adapter_ = false; // gone already: nothing is left to close
            }
        }
    }

    std::string name() const override { return stream_->name(); }
    void send(const can_frame_t *frames, std::size_t count,
              LinkClock::time_point deadline) override {
        channel_.send(frames, count, deadline);
    }
    bool receive(can_frame_t &frame, LinkClock::time_point deadline) override {
        return channel_.receive(frame, deadline);
    }

  private:
    void command(const std::string &text) {
        stream_->send(reinterpret_cast<const std::uint8_t *>(text.data()), text.size(),
                      LinkClock::now() + kCommandTime);
    }

    std::unique_ptr<ByteStream> stream_;
    SlcanChannel channel_;
    bool is_adapter_;
};

} // namespace

void SlcanChannel::send(const can_frame_t *frames, std::size_t count,
                        LinkClock::time_point deadline) {
    std::array<std::uint8_t, kMaxBurstFrames * SLCAN_MAX_BYTES> output{};
    std::size_t length = 0;
    for (std::size_t i = 0; i < count; ++i) {
        length += slcan_encode(&frames[i], output.data() + length);
    }
    stream_.send(output.data(), length, deadline);
    sent_bytes_ += length;
}

bool SlcanChannel::receive(can_frame_t &frame, LinkClock::time_point deadline) {
    bool is_late = false; // bytes that never become a frame must not hold the bench for ever
    for (;;) {
        while (input_begin_ < input_end_) {
            if (slcan_decode(&decoder_, input_[input_begin_++], &frame)) {
                return true;
            }
        }
        if (is_late) {
            return false;
        }
        input_begin_ = 0;
        input_end_ = stream_.receive(input_.data(), input_.size(), deadline);
        received_bytes_ += input_end_;
        if (input_end_ == 0) {
            return false;
        }
        is_late = LinkClock::now() > deadline;
    }
}

std::unique_ptr<FrameChannel> make_slcan_channel(std::unique_ptr<ByteStream> stream,
                                                 std::uint32_t bitrate) {
    return std::make_unique<OwningSlcanChannel>(std::move(stream), bitrate);
}

} // namespace quiesce
