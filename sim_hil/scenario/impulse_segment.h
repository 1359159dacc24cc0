/// A blow: half a sine of force when the segment begins, then nothing. Not through the shaker.
#ifndef QUIESCE_IMPULSE_SEGMENT_H
#define QUIESCE_IMPULSE_SEGMENT_H

#include <cmath>

#include "segment.h"

namespace quiesce {

class ImpulseSegment final : public Segment {
  public:
    /// impulse_N_s: time integral of the force. pulse_s > 0: how long it lasts.
    ImpulseSegment(double impulse_N_s, double pulse_s)
        : peak_N_(0.5 * kPi * impulse_N_s / pulse_s), pulse_s_(pulse_s) {}

    ExcitationSample sample(double time_s, double start_cycles) const override {
        const double force_N =
            time_s < pulse_s_ ? peak_N_ * std::sin(kPi * time_s / pulse_s_) : 0.0;
        return {force_N, 0.0, start_cycles, 0.0};
    }

  private:
    static constexpr double kPi = 3.14159265358979323846;

    double peak_N_;
    double pulse_s_;
};

} // namespace quiesce

#endif
