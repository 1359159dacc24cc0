/// Carries a latched fault from one run to the next. The core cannot start in a fault: a kept one
/// holds its emergency stop pressed until the operator acknowledges, so that it enters FAULT itself
/// and stays there.
#ifndef QUIESCED_FAULT_LATCH_H
#define QUIESCED_FAULT_LATCH_H

#include "exchange.h"

namespace quiesced {

/// The fault in which the core is latched, which only an acknowledgement ends; QUIESCE_FAULT_NONE:
/// none. Refused parameters are none: others mend them.
std::uint32_t latched_fault(const node_t &node);

class FaultLatch {
  public:
    /// Holds what exchange.latched_fault says, and keeps it up to date from then on.
    explicit FaultLatch(Exchange &exchange);

    /// An earlier run's fault that nobody has acknowledged; QUIESCE_FAULT_NONE: none.
    std::uint32_t held() const { return held_; }
    /// The driver must not be switched on, not even by the core's start.
    bool is_holding() const { return phase_ == Phase::holding; }

    /// In each tick: what the board says, before the core gets it.
    void before_tick(node_inputs_t &board);
    /// Right after the core's step: a fault that it has just entered is kept before anything tells
    /// of it.
    void keep_new(const node_t &node);
    /// At the end: what has become of it.
    void after_tick(const node_t &node);

  private:
    /// The edge that ends the hold finds the core's stop pressed, where it does nothing. It is
    /// repeated, after a tick without, once the stop is released: one acknowledgement is enough.
    enum class Phase { nothing, holding, released, repeating };

    void let_go(const node_t &node);
    void tell(std::uint32_t fault);

    Exchange &exchange_;
    std::uint32_t held_;
    std::uint32_t told_;
    Phase phase_;
    bool is_pressed_ = false;    ///< the board's own emergency stop
    bool is_reset_ = false;      ///< the board acknowledges in this tick
    bool was_reset_high_ = true; ///< a button that is stuck at the start is no acknowledgement
};

} // namespace quiesced

#endif
