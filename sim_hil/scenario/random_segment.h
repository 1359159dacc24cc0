/// Band-limited Gaussian force, or acceleration of the base, the same for the same seed.
///
/// The drive is a sum of sines on the whole multiples of 1/repeat_s from low_Hz to high_Hz; each
/// has a Gaussian sine and cosine part, so amplitudes and phases are random. It is scaled so that
/// its RMS over repeat_s is drive_rms_V exactly. Each line goes through the shaker's roll-off. The
/// band has at least 200 lines.
///
/// The sum is tabulated once with an FFT, value and slope, at least 64 points to a cycle of
/// high_Hz, and read with cubic Hermite pieces: within 1e-6 of the sum, relative to its RMS.
#ifndef QUIESCE_RANDOM_SEGMENT_H
#define QUIESCE_RANDOM_SEGMENT_H

#include <cstddef>
#include <cstdint>
#include <vector>

#include "segment.h"
#include "shaker.h"

namespace quiesce {

struct RandomParams {
    double low_Hz;      ///< > 0
    double high_Hz;     ///< > low_Hz
    double drive_rms_V; ///< >= 0
    std::uint64_t seed;
    double least_repeat_s; ///< does not repeat before, > 0
};

class RandomSegment final : public Segment {
  public:
    /// What high_Hz * repeat_s may be at most: the table takes up to 2 KB a cycle.
    static constexpr double kMostCycles = 1e5;

    /// When it repeats itself.
    static double repeat_s(const RandomParams &params);

    RandomSegment(const ShakerParams &shaker_params, const RandomParams &params);

    ExcitationSample sample(double time_s, double start_cycles) const override;

  private:
    struct Point {
        double value; ///< N or m/s2
        double slope; ///< its change over one grid step, by its derivative
    };

    Shaker shaker_;
    double points_per_s_;
    std::vector<Point> table_; ///< one period
};

} // namespace quiesce

#endif
