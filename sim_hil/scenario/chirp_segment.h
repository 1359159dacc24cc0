/// Frequency that changes linearly with time.
#ifndef QUIESCE_CHIRP_SEGMENT_H
#define QUIESCE_CHIRP_SEGMENT_H

#include "swept_segment.h"

namespace quiesce {

class ChirpSegment final : public SweptSegment {
  public:
    /// From start_Hz at its beginning to end_Hz after duration_s > 0.
    ChirpSegment(const ShakerParams &shaker, double start_Hz, double end_Hz, double duration_s)
        : SweptSegment(shaker), start_Hz_(start_Hz), slope_Hz_s_((end_Hz - start_Hz) / duration_s) {
    }

  private:
    double freq_Hz(double time_s) const override { return start_Hz_ + slope_Hz_s_ * time_s; }
    double phase_cycles(double time_s) const override {
        return (start_Hz_ + 0.5 * slope_Hz_s_ * time_s) * time_s;
    }

    double start_Hz_;
    double slope_Hz_s_;
};

} // namespace quiesce

#endif
