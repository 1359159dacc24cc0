#include "excitation.h"

#include <cmath>

namespace quiesce {

namespace {

constexpr double kTwoPi = 6.28318530717958647692;

} // namespace

void Excitation::append(std::unique_ptr<Segment> segment, double duration_s) {
    const double cycles = segment->phase_cycles(duration_s);
    placed_.push_back({std::move(segment), end_s_, end_cycles_});
    end_s_ += duration_s;
    end_cycles_ += cycles;
}

std::size_t Excitation::segment_at(double time_s) const {
    std::size_t index = placed_.size() - 1;
    while (placed_[index].start_s > time_s) {
        --index;
    }
    return index;
}

Excitation::Sample Excitation::sample(std::size_t segment, double time_s) const {
    const Placed &placed = placed_[segment];
    const double local_s = time_s - placed.start_s;
    const double freq_Hz = placed.segment->freq_Hz(local_s);
    const double cycles = placed.start_cycles + placed.segment->phase_cycles(local_s);
    const double turn = cycles - std::floor(cycles);
    return {shaker_.amplitude_N(freq_Hz) * std::sin(kTwoPi * turn), freq_Hz, cycles};
}

} // namespace quiesce
