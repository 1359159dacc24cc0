/// A controller beside a plant that runs at the rate of the clock on the wall.
#ifndef QUIESCE_LIVE_LINK_H
#define QUIESCE_LIVE_LINK_H

#include "controller_link.h"
#include "firmware_node.h"
#include "input_error.h"

namespace quiesce {

/// Frames taken in a tick, each way: a storm of them does not keep it from running.
constexpr std::size_t kMostFrames = 256;

/// The controller is gone, which nothing about the plant mends.
class TargetGone : public InputError {
  public:
    using InputError::InputError;
};

class LiveLink : public ControllerLink {
  public:
    /// How the next ticks come: lateness, work and overruns.
    lockstep_pace_t &pace() { return pace_; }

    /// Of the plant's next ticks: whoever is on the bus may change that of a controller.
    virtual std::int32_t tick_rate_Hz() const = 0;

    /// Once between two ticks, half-way: whoever has a clock of his own is looked at. Throws
    /// TargetGone.
    virtual void half_way() {}

    /// By how much the plant's clock is to come later from now on, so that its ticks lie between
    /// those of the controller; once after each tick.
    virtual std::int64_t shift_ns() { return 0; }

    /// The last frames before it ends: no current is asked for any more.
    virtual void leave() = 0;

  private:
    lockstep_pace_t pace_{};
};

} // namespace quiesce

#endif
