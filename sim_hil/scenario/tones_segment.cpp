#include "tones_segment.h"

#include <cmath>

namespace quiesce {

namespace {

constexpr double kTwoPi = 6.28318530717958647692;

} // namespace

TonesSegment::TonesSegment(const ShakerParams &shaker_params, const std::vector<Tone> &tones) {
    const Shaker shaker(shaker_params);
    for (const Tone &tone : tones) {
        lines_.push_back(
            {tone.freq_Hz, shaker.amplitude_N(tone.freq_Hz, tone.drive_V), tone.phase_deg / 360.0});
    }
}

ExcitationSample TonesSegment::sample(double time_s, double start_cycles) const {
    double force_N = 0.0;
    for (const Line &line : lines_) {
        const double cycles = line.freq_Hz * time_s + line.phase_cycles;
        force_N += line.amplitude_N * std::sin(kTwoPi * (cycles - std::floor(cycles)));
    }
    return {force_N, 0.0, start_cycles, 0.0};
}

} // namespace quiesce
