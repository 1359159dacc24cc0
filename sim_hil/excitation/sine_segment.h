/// Constant frequency.
#ifndef QUIESCE_SINE_SEGMENT_H
#define QUIESCE_SINE_SEGMENT_H

#include "segment.h"

namespace quiesce {

class SineSegment final : public Segment {
  public:
    explicit SineSegment(double freq_Hz) : freq_Hz_(freq_Hz) {}

    double freq_Hz(double /*time_s*/) const override { return freq_Hz_; }
    double phase_cycles(double time_s) const override { return freq_Hz_ * time_s; }

  private:
    double freq_Hz_;
};

} // namespace quiesce

#endif
