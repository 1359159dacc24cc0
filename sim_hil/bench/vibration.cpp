#include "vibration.h"

#include <algorithm>
#include <cmath>

namespace quiesce {

Vibration::Vibration(std::int64_t tick_rate_Hz)
    : block_ticks_(std::max<std::int64_t>(
          1, std::llround(kWindow_s * static_cast<double>(tick_rate_Hz) / kBlocks))) {}

void Vibration::on_tick(const TickRecord &record) {
    block_.displacement_m2 += record.truth.displacement_m * record.truth.displacement_m;
    block_.accel_m2_s4 += record.truth.accel_m_s2 * record.truth.accel_m_s2;
    if (++ticks_ == block_ticks_) {
        close_block();
    }
}

void Vibration::close_block() {
    blocks_.push_back(block_);
    block_ = {};
    ticks_ = 0;
    if (blocks_.size() > kBlocks) {
        blocks_.pop_front();
    }
    if (blocks_.size() == kBlocks) {
        (is_on_ ? on_ : off_) = now();
    }
}

VibrationRms Vibration::now() const {
    Sums sum = block_;
    for (const Sums &block : blocks_) {
        sum.displacement_m2 += block.displacement_m2;
        sum.accel_m2_s4 += block.accel_m2_s4;
    }
    const auto ticks =
        static_cast<double>(ticks_ + static_cast<std::int64_t>(blocks_.size()) * block_ticks_);
    return ticks == 0.0 ? VibrationRms{}
                        : VibrationRms{std::sqrt(sum.displacement_m2 / ticks),
                                       std::sqrt(sum.accel_m2_s4 / ticks)};
}

void Vibration::control(bool is_on) {
    if (is_on != is_on_) {
        is_on_ = is_on;
        block_ = {};
        ticks_ = 0;
        blocks_.clear();
    }
}

void Vibration::excitation_changed() {
    block_ = {};
    ticks_ = 0;
    blocks_.clear();
    on_.reset();
    off_.reset();
}

} // namespace quiesce
