/// Several sines at once, each through the shaker's roll-off:
///
///   force = sum of drive_V g(f) sin(2 pi f t + phase)
#ifndef QUIESCE_TONES_SEGMENT_H
#define QUIESCE_TONES_SEGMENT_H

#include <vector>

#include "segment.h"
#include "shaker.h"

namespace quiesce {

struct Tone {
    double freq_Hz;
    double drive_V;   ///< amplitude of its part of the drive
    double phase_deg; ///< of its sine when the segment begins
};

class TonesSegment final : public Segment {
  public:
    TonesSegment(const ShakerParams &shaker, const std::vector<Tone> &tones);

    ExcitationSample sample(double time_s, double start_cycles) const override;

  private:
    struct Line {
        double freq_Hz;
        double amplitude_N;
        double phase_cycles;
    };

    std::vector<Line> lines_;
};

} // namespace quiesce

#endif
