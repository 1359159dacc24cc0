#include "swept_segment.h"

#include <cmath>

namespace quiesce {

namespace {

constexpr double kTwoPi = 6.28318530717958647692;

} // namespace

ExcitationSample SweptSegment::sample(double time_s, double start_cycles) const {
    const double freq = freq_Hz(time_s);
    const double cycles = start_cycles + phase_cycles(time_s);
    const double turn = cycles - std::floor(cycles);
    return shaker_.sample(shaker_.amplitude(freq) * std::sin(kTwoPi * turn), freq, cycles);
}

} // namespace quiesce
