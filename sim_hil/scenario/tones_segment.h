/// Several sines at once, each through the shaker's roll-off:
///
///   force, or acceleration of the base = sum of drive_V g(f) sin(2 pi f t + phase)
#ifndef QUIESCE_TONES_SEGMENT_H
#define QUIESCE_TONES_SEGMENT_H

#include <vector>

#include "segment.h"
#include "shaker.h"
#include "tone_sum.h"

namespace quiesce {

struct Tone {
    double freq_Hz;
    double size;      ///< amplitude: of a force's tone its part of the drive in V
    double phase_deg; ///< of its sine when the segment begins
};

class TonesSegment final : public Segment {
  public:
    TonesSegment(const ShakerParams &shaker_params, const std::vector<Tone> &tones);

    ExcitationSample sample(double time_s, double start_cycles) const override;

  private:
    Shaker shaker_;
    std::vector<ToneLine> lines_; ///< amplitudes in N or m/s2
};

} // namespace quiesce

#endif
