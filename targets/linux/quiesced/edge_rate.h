/// How often the edges of a line come, against how often they should.
#ifndef QUIESCED_EDGE_RATE_H
#define QUIESCED_EDGE_RATE_H

#include <cstdint>

namespace quiesced {

class EdgeRate {
  public:
    /// Forgets everything. expected_Hz: > 0.
    void start(std::uint32_t expected_Hz);

    /// Edges have come, the newest at time_ns. Returns true iff it has turned out now that the rate
    /// is off, or right again: more than 2 % off, or not, in three seconds in a row.
    bool count(std::uint32_t edges, std::int64_t time_ns);

    bool is_off() const { return is_off_; }
    /// Of the last second that was measured, rounded.
    std::uint32_t rate_Hz() const { return rate_Hz_; }

  private:
    double expected_Hz_ = 1;
    std::uint32_t rate_Hz_ = 0;
    bool has_start_ = false;
    std::int64_t start_ns_ = 0; ///< of the second that is measured
    std::uint32_t edges_ = 0;   ///< in it
    int in_a_row_ = 0;          ///< seconds that contradict is_off_
    bool is_off_ = false;
};

} // namespace quiesced

#endif
