#include "excitation.h"

namespace quiesce {

void Excitation::append(std::unique_ptr<Segment> segment, double duration_s) {
    const double end_cycles = segment->sample(duration_s, end_cycles_).phase_cycles;
    placed_.push_back({std::move(segment), end_s_, end_cycles_});
    end_s_ += duration_s;
    end_cycles_ = end_cycles;
}

void Excitation::change(std::unique_ptr<Segment> segment, double start_s) {
    while (placed_.back().start_s >= start_s) {
        placed_.pop_back();
    }
    const std::size_t last = placed_.size() - 1;
    end_s_ = start_s;
    end_cycles_ = sample(last, start_s).phase_cycles;
    placed_.push_back({std::move(segment), end_s_, end_cycles_});
    for (std::size_t past = last; past > 1 && placed_[past - 2].segment; --past) {
        placed_[past - 2].segment.reset();
    }
}

std::size_t Excitation::segment_at(double time_s) const {
    std::size_t index = placed_.size() - 1;
    while (placed_[index].start_s > time_s) {
        --index;
    }
    return index;
}

} // namespace quiesce
