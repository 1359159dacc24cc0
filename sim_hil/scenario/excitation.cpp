#include "excitation.h"

namespace quiesce {

void Excitation::append(std::unique_ptr<Segment> segment, double duration_s) {
    const double end_cycles = segment->sample(duration_s, end_cycles_).phase_cycles;
    placed_.push_back({std::move(segment), end_s_, end_cycles_});
    end_s_ += duration_s;
    end_cycles_ = end_cycles;
}

std::size_t Excitation::segment_at(double time_s) const {
    std::size_t index = placed_.size() - 1;
    while (placed_[index].start_s > time_s) {
        --index;
    }
    return index;
}

} // namespace quiesce
