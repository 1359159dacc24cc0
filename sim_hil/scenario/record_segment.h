/// A recorded acceleration of the base, such as an earthquake, with straight lines between its
/// samples and nothing after its end.
#ifndef QUIESCE_RECORD_SEGMENT_H
#define QUIESCE_RECORD_SEGMENT_H

#include <vector>

#include "segment.h"

namespace quiesce {

struct RecordPoint {
    double time_s; ///< rising from point to point
    double accel_m_s2;
};

class RecordSegment final : public Segment {
  public:
    /// Begins with the first of at least two points. time_scale > 0: 5 makes it five times faster.
    RecordSegment(std::vector<RecordPoint> points, double gain, double time_scale);

    ExcitationSample sample(double time_s, double start_cycles) const override;

  private:
    std::vector<RecordPoint> points_; ///< gain and time scale applied, from time 0 on
};

} // namespace quiesce

#endif
