/// Several sines of the base's acceleration at once, as of a vibration table:
///
///   base acceleration = sum of accel_m_s2 sin(2 pi f t + phase)
#ifndef QUIESCE_BASE_TONES_SEGMENT_H
#define QUIESCE_BASE_TONES_SEGMENT_H

#include <utility>

#include "segment.h"
#include "tone_sum.h"

namespace quiesce {

class BaseTonesSegment final : public Segment {
  public:
    /// Amplitudes in m/s2.
    explicit BaseTonesSegment(std::vector<ToneLine> lines) : lines_(std::move(lines)) {}

    ExcitationSample sample(double time_s, double start_cycles) const override {
        return {0.0, 0.0, start_cycles, sum_of_tones(lines_, time_s)};
    }

  private:
    std::vector<ToneLine> lines_;
};

} // namespace quiesce

#endif
