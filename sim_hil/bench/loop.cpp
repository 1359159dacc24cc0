#include "loop.h"

#include <cmath>

namespace quiesce {

Loop::Loop(const RunSetup &setup, ControllerLink &link)
    : setup_(setup), link_(link), excitation_(make_excitation(setup.scenario, setup.plant.shaker)),
      plant_(setup.plant, excitation_, setup.params.tick_rate_Hz),
      senses_(setup.plant, setup.rig_or_null(), setup.params.tick_rate_Hz, setup.seed),
      injector_(place_faults(setup.scenario, setup.rig_or_null()), senses_.full_scales()),
      bus_(bus_ticks(setup.rig_or_null(), setup.params.tick_rate_Hz)) {
    for (std::size_t i = 0; i < setup.plant.dampers.size(); ++i) {
        damper_of_.push_back(setup.rig ? setup.rig->damper_of[i] : i);
    }
}

void Loop::tick(const std::vector<TickObserver *> &observers) {
    const std::int64_t tick = next_tick_;
    const double time_s = time_of(tick);
    link_.look(reply_);
    command(time_s);
    sense(tick, time_s);
    link_.exchange(stimulus_, reply_);
    for (TickObserver *observer : observers) {
        observer->on_tick({tick, time_s, plant_.truth(), plant_, stimulus_, reply_});
    }
    const std::vector<PlantTruth> &steps = plant_.advance();
    for (TickObserver *observer : observers) {
        observer->on_steps(time_s, plant_.step_s(), steps);
    }
    ++next_tick_;
}

/// The plant is at the next tick already, with what shook it until there: what is new begins one
/// later, where a scenario's segments do.
void Loop::excite(std::unique_ptr<Segment> segment) {
    excitation_.change(std::move(segment), time_of(next_tick_ + 1));
}

/// What the controller answered one tick ago, and the bus's ticks before, acts from here on.
void Loop::command(double time_s) {
    const lockstep_reply_t arrived = bus_.pass(reply_);
    for (std::size_t i = 0; i < damper_of_.size(); ++i) {
        const bool is_on = (arrived.drivers_enabled >> i & 1u) != 0;
        plant_.command(damper_of_[i], is_on ? 1e-3 * arrived.current_cmd_mA[i] : 0.0,
                       injector_.actuator(time_s, i));
    }
}

void Loop::sense(std::int64_t tick, double time_s) {
    stimulus_ = {tick > 0 && is_enabled_ ? LOCKSTEP_ENABLE : 0u, {0}, {0}}; // its edge arms
    stimulus_.flags |= setup_.wants_report ? LOCKSTEP_REPORT : 0u;
    stimulus_.flags |= setup_.wants_picture ? LOCKSTEP_PICTURE : 0u;
    senses_.read(plant_, tick, stimulus_);
    for (std::size_t i = 0; i < damper_of_.size(); ++i) {
        if (measures_current(i)) {
            stimulus_.flags |= LOCKSTEP_HAS_CURRENT << i;
            stimulus_.current_meas_mA[i] =
                static_cast<std::int32_t>(std::lround(1e3 * plant_.damper(damper_of_[i]).coil_A));
        }
    }
    injector_.apply(time_s, stimulus_);
}

bool Loop::measures_current(std::size_t damper) const {
    return setup_.rig ? setup_.rig->board().damper[damper].measures_current != 0
                      : setup_.scenario.feed_current;
}

} // namespace quiesce
