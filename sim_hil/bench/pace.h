/// Ticks at the rate of the clock on the wall: when each is due, and how late it came.
#ifndef QUIESCE_PACE_H
#define QUIESCE_PACE_H

#include <array>
#include <cstdint>

namespace quiesce {

/// Says when; whoever runs the ticks sleeps. Late ticks are made up for one after the other, so
/// that none is left out; what is too late for that is the clock's loss.
class Pace {
  public:
    /// Bin i counts ticks less than 2^i us late, and at least half as much; the last one all
    /// others.
    static constexpr std::size_t kBins = 18;

    /// now_ns: of a clock that never goes back; the first tick is due then.
    Pace(std::int64_t rate_Hz, std::int64_t now_ns) : rate_Hz_(rate_Hz), start_ns_(now_ns) {}

    /// When the next tick is due.
    std::int64_t due_ns() const;

    /// It begins now.
    void begin(std::int64_t now_ns);

    /// Half a tick before that.
    std::int64_t half_way_ns() const { return due_ns() - 500'000'000 / rate_Hz_; }

    /// What is due from now on is due so much later.
    void shift(std::int64_t by_ns) { start_ns_ += by_ns; }

    /// From the next tick on at another rate; one has begun now.
    void change_rate(std::int64_t rate_Hz, std::int64_t now_ns);

    std::int64_t ticks() const { return ticks_; }
    std::int64_t lateness_us() const { return lateness_us_; } ///< of the last one
    std::int64_t latest_us() const { return latest_us_; }     ///< of all
    std::uint32_t overruns() const { return overruns_; }      ///< began a whole tick late or more
    double lost_s() const { return 1e-9 * static_cast<double>(lost_ns_); } ///< given up
    const std::array<std::uint64_t, kBins> &histogram() const { return bins_; }

  private:
    std::int64_t rate_Hz_;
    std::int64_t start_ns_;
    std::int64_t since_start_ = 0; ///< ticks
    std::int64_t ticks_ = 0;
    std::int64_t lateness_us_ = 0;
    std::int64_t latest_us_ = 0;
    std::int64_t lost_ns_ = 0;
    std::uint32_t overruns_ = 0;
    std::array<std::uint64_t, kBins> bins_{};
};

} // namespace quiesce

#endif
