/// One stretch of what shakes the structure: a force, an acceleration of its base, or both.
#ifndef QUIESCE_SEGMENT_H
#define QUIESCE_SEGMENT_H

namespace quiesce {

/// What acts at one instant.
struct ExcitationSample {
    double force_N;
    double freq_Hz;         ///< 0 where there is no one frequency
    double phase_cycles;    ///< since time 0, not wrapped; stands still where freq_Hz is 0
    double base_accel_m_s2; ///< absolute acceleration of the structure's base
};

class Segment {
  public:
    virtual ~Segment() = default;

    /// time_s: since the segment began; may lie beyond its end. start_cycles: the phase at which it
    /// began.
    virtual ExcitationSample sample(double time_s, double start_cycles) const = 0;
};

} // namespace quiesce

#endif
