/// A sine whose frequency may change over time, driven through the shaker.
#ifndef QUIESCE_SWEPT_SEGMENT_H
#define QUIESCE_SWEPT_SEGMENT_H

#include "segment.h"
#include "shaker.h"

namespace quiesce {

class SweptSegment : public Segment {
  public:
    ExcitationSample sample(double time_s, double start_cycles) const final;

  protected:
    explicit SweptSegment(const ShakerParams &shaker) : shaker_(shaker) {}

  private:
    /// Both at time_s since the segment began.
    virtual double freq_Hz(double time_s) const = 0;
    virtual double phase_cycles(double time_s) const = 0; ///< integral of the frequency; 0 at 0

    Shaker shaker_;
};

} // namespace quiesce

#endif
