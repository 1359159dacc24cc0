/// Constant frequency.
#ifndef QUIESCE_SINE_SEGMENT_H
#define QUIESCE_SINE_SEGMENT_H

#include "swept_segment.h"

namespace quiesce {

class SineSegment final : public SweptSegment {
  public:
    SineSegment(const ShakerParams &shaker, double freq_Hz)
        : SweptSegment(shaker), freq_Hz_(freq_Hz) {}

  private:
    double freq_Hz(double /*time_s*/) const override { return freq_Hz_; }
    double phase_cycles(double time_s) const override { return freq_Hz_ * time_s; }

    double freq_Hz_;
};

} // namespace quiesce

#endif
