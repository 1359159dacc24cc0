/// The force on the structure: a shaker driven through segments of sine and chirp, with the phase
/// continuous where one segment follows another.
#ifndef QUIESCE_EXCITATION_H
#define QUIESCE_EXCITATION_H

#include <cstddef>
#include <memory>
#include <vector>

#include "segment.h"
#include "shaker.h"

namespace quiesce {

class Excitation {
  public:
    explicit Excitation(const ShakerParams &shaker) : shaker_(shaker) {}

    /// Appends a segment; the last one goes on for ever.
    void append(std::unique_ptr<Segment> segment, double duration_s);

    struct Sample {
        double force_N;
        double freq_Hz;
        double phase_cycles; ///< since time 0, not wrapped
    };

    /// The segment that holds at time_s >= 0: it includes its start, not its end. At least one must
    /// have been appended.
    std::size_t segment_at(double time_s) const;

    /// The excitation at time_s as this segment has it, also at its very end.
    Sample sample(std::size_t segment, double time_s) const;

    Sample at(double time_s) const { return sample(segment_at(time_s), time_s); }

  private:
    struct Placed {
        std::unique_ptr<Segment> segment;
        double start_s;
        double start_cycles;
    };

    Shaker shaker_;
    std::vector<Placed> placed_;
    double end_s_ = 0.0;
    double end_cycles_ = 0.0;
};

} // namespace quiesce

#endif
