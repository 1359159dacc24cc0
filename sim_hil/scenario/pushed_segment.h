/// What somebody outside pushes a structure with, tick by tick: in straight lines.
#ifndef QUIESCE_PUSHED_SEGMENT_H
#define QUIESCE_PUSHED_SEGMENT_H

#include <algorithm>
#include <memory>
#include <utility>

#include "excitation.h"

namespace quiesce {

struct Push {
    double force_N = 0.0;
    double base_accel_m_s2 = 0.0;
};

/// What acts in the tick that is integrated next, from its start to its end.
struct Stretch {
    double start_tick = 0.0;
    Push from;
    Push to;
};

class PushedSegment final : public Segment {
  public:
    PushedSegment(std::shared_ptr<const Stretch> now, int tick_rate_Hz)
        : now_(std::move(now)), tick_rate_Hz_(tick_rate_Hz) {}

    ExcitationSample sample(double time_s, double start_cycles) const override {
        const double part = std::clamp(time_s * tick_rate_Hz_ - now_->start_tick, 0.0, 1.0);
        const auto between = [part](double from, double to) { return from + part * (to - from); };
        return {between(now_->from.force_N, now_->to.force_N), 0.0, start_cycles,
                between(now_->from.base_accel_m_s2, now_->to.base_accel_m_s2)};
    }

  private:
    std::shared_ptr<const Stretch> now_;
    double tick_rate_Hz_;
};

/// For ever.
inline Excitation pushed_by(const std::shared_ptr<const Stretch> &stretch, int tick_rate_Hz) {
    Excitation excitation;
    excitation.append(std::make_unique<PushedSegment>(stretch, tick_rate_Hz), 1.0);
    return excitation;
}

} // namespace quiesce

#endif
