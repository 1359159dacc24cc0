/// One stretch of the excitation's frequency over time.
#ifndef QUIESCE_SEGMENT_H
#define QUIESCE_SEGMENT_H

namespace quiesce {

class Segment {
  public:
    virtual ~Segment() = default;

    /// Both at time_s since the segment began; time_s may lie beyond its end.
    virtual double freq_Hz(double time_s) const = 0;
    virtual double phase_cycles(double time_s) const = 0; ///< integral of the frequency; 0 at 0
};

} // namespace quiesce

#endif
