/// Plant, sensors, controller and back: one control tick of the closed loop at a time, in
/// lock-step.
#ifndef QUIESCE_LOOP_H
#define QUIESCE_LOOP_H

#include <memory>
#include <set>
#include <vector>

#include "delay_line.h"
#include "fault_injector.h"
#include "run.h"
#include "senses.h"

namespace quiesce {

/// A setup in motion, from rest. What is changed while it runs takes effect with the next tick, as
/// if the scenario had said so from the beginning.
class Loop {
  public:
    /// setup and link must outlive it; the link has been started.
    Loop(const RunSetup &setup, ControllerLink &link);

    /// The tick after the last one. Throws InputError where the target fails or the plant leaves
    /// its model's range.
    void tick(const std::vector<TickObserver *> &observers);

    /// Begins with the next tick.
    std::int64_t next_tick() const { return next_tick_; }
    double time_s() const { return time_of(next_tick_); }

    /// From the next tick on, with a phase that continues.
    void excite(std::unique_ptr<Segment> segment);
    ExcitationSample excitation() const { return excitation_.at(time_s()); }

    /// The operator's enable; on at first, from tick 1.
    void enable(bool is_on) { is_enabled_ = is_on; }
    bool is_enabled() const { return is_enabled_; }

    /// Gravity along the axes of the accelerometers, which somebody turns over.
    void lie(double gravity_m_s2) { senses_.lie(gravity_m_s2); }

    FaultInjector &faults() { return injector_; }

  private:
    double time_of(std::int64_t tick) const {
        return static_cast<double>(tick) / setup_.params.tick_rate_Hz;
    }
    void command(double time_s);
    void sense(std::int64_t tick, double time_s);
    bool measures_current(std::size_t damper) const;

    const RunSetup &setup_;
    ControllerLink &link_;
    Excitation excitation_;
    Plant plant_;
    Senses senses_;
    FaultInjector injector_;
    DelayLine<lockstep_reply_t> bus_;    ///< to the drivers: a board's may take ticks
    std::vector<std::size_t> damper_of_; ///< of the plant, for each of the controller's
    bool is_enabled_ = true;
    std::int64_t next_tick_ = 0;
    lockstep_stimulus_t stimulus_{};
    lockstep_reply_t reply_{};
};

} // namespace quiesce

#endif
