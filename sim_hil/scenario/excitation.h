/// What shakes the structure: segments one after the other. The phase is continuous where one
/// follows another.
#ifndef QUIESCE_EXCITATION_H
#define QUIESCE_EXCITATION_H

#include <cstddef>
#include <memory>
#include <vector>

#include "segment.h"

namespace quiesce {

class Excitation {
  public:
    using Sample = ExcitationSample;

    /// Appends a segment; the last one goes on for ever.
    void append(std::unique_ptr<Segment> segment, double duration_s);

    /// Goes on with another segment for ever from start_s > 0, in place of what was to come. What
    /// was over before the segment that it cuts short and the one before that is forgotten, so that
    /// changes without end take no memory to speak of: no such time may be asked for any more.
    void change(std::unique_ptr<Segment> segment, double start_s);

    /// The segment that holds at time_s >= 0: it includes its start, not its end. At least one must
    /// have been appended.
    std::size_t segment_at(double time_s) const;

    /// The excitation at time_s as this segment has it, also at its very end.
    Sample sample(std::size_t segment, double time_s) const {
        const Placed &placed = placed_[segment];
        return placed.segment->sample(time_s - placed.start_s, placed.start_cycles);
    }

    Sample at(double time_s) const { return sample(segment_at(time_s), time_s); }

  private:
    struct Placed {
        std::unique_ptr<Segment> segment;
        double start_s;
        double start_cycles;
    };

    std::vector<Placed> placed_;
    double end_s_ = 0.0;
    double end_cycles_ = 0.0;
};

} // namespace quiesce

#endif
