/// A controller beside a plant that runs at the rate of the clock on the wall.
#ifndef QUIESCE_LIVE_LINK_H
#define QUIESCE_LIVE_LINK_H

#include "controller_link.h"
#include "firmware_node.h"
#include "input_error.h"

namespace quiesce {

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

    /// The last frames before it ends: no current is asked for any more.
    virtual void leave() = 0;

  private:
    lockstep_pace_t pace_{};
};

} // namespace quiesce

#endif
