#include "run.h"

#include <chrono>
#include <cmath>
#include <deque>

#include "fault_injector.h"
#include "senses.h"
#include "start.h"

namespace quiesce {

namespace {

/// Commands on their way to the drivers: a board's bus may take ticks.
class CommandBus {
  public:
    explicit CommandBus(std::size_t latency_ticks) : on_the_way_(latency_ticks) {}

    lockstep_reply_t pass(const lockstep_reply_t &reply) {
        on_the_way_.push_back(reply);
        const lockstep_reply_t out = on_the_way_.front();
        on_the_way_.pop_front();
        return out;
    }

  private:
    std::deque<lockstep_reply_t> on_the_way_;
};

std::size_t bus_ticks(const RunSetup &setup) {
    const double latency_us = setup.rig ? setup.rig->board().bus_latency_us : 0;
    return static_cast<std::size_t>(std::llround(1e-6 * latency_us / setup.tick_s()));
}

/// One scenario in progress.
class Loop {
  public:
    Loop(const RunSetup &setup, ControllerLink &link)
        : setup_(setup), link_(link),
          excitation_(make_excitation(setup.scenario, setup.plant.shaker)),
          plant_(setup.plant, excitation_, setup.params.tick_rate_Hz),
          senses_(setup.plant, setup.rig_or_null(), setup.params.tick_rate_Hz, setup.seed),
          injector_(place_faults(setup.scenario, setup.rig_or_null()), senses_.full_scales()),
          bus_(bus_ticks(setup)) {
        for (std::size_t i = 0; i < setup.plant.dampers.size(); ++i) {
            damper_of_.push_back(setup.rig ? setup.rig->damper_of[i] : i);
        }
    }

    void tick(std::int64_t tick, const std::vector<TickObserver *> &observers) {
        const double time_s = static_cast<double>(tick) / setup_.params.tick_rate_Hz;
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
    }

  private:
    /// What the controller answered one tick ago, and the bus's ticks before, acts from here on.
    void command(double time_s) {
        const lockstep_reply_t arrived = bus_.pass(reply_);
        for (std::size_t i = 0; i < damper_of_.size(); ++i) {
            const bool is_on = (arrived.drivers_enabled >> i & 1u) != 0;
            plant_.command(damper_of_[i], is_on ? 1e-3 * arrived.current_cmd_mA[i] : 0.0,
                           injector_.actuator(time_s, i));
        }
    }

    void sense(std::int64_t tick, double time_s) {
        stimulus_ = {tick > 0 ? LOCKSTEP_ENABLE : 0u, {0}, {0}}; // its edge arms
        stimulus_.flags |= setup_.wants_report ? LOCKSTEP_REPORT : 0u;
        stimulus_.flags |= setup_.wants_picture ? LOCKSTEP_PICTURE : 0u;
        senses_.read(plant_, tick, stimulus_);
        for (std::size_t i = 0; i < damper_of_.size(); ++i) {
            if (measures_current(i)) {
                stimulus_.flags |= LOCKSTEP_HAS_CURRENT << i;
                stimulus_.current_meas_mA[i] = static_cast<std::int32_t>(
                    std::lround(1e3 * plant_.damper(damper_of_[i]).coil_A));
            }
        }
        injector_.apply(time_s, stimulus_);
    }

    bool measures_current(std::size_t damper) const {
        return setup_.rig ? setup_.rig->board().damper[damper].measures_current != 0
                          : setup_.scenario.feed_current;
    }

    const RunSetup &setup_;
    ControllerLink &link_;
    Excitation excitation_;
    Plant plant_;
    Senses senses_;
    FaultInjector injector_;
    CommandBus bus_;
    std::vector<std::size_t> damper_of_; ///< of the plant, for each of the controller's
    lockstep_stimulus_t stimulus_{};
    lockstep_reply_t reply_{};
};

} // namespace

std::int64_t RunSetup::tick_count() const {
    return std::llround(scenario.duration_s * static_cast<double>(params.tick_rate_Hz));
}

RunTiming run_scenario(const RunSetup &setup, ControllerLink &link,
                       const std::vector<TickObserver *> &observers) {
    start_controller(link, setup.board(), setup.params, setup.tables);
    Loop loop(setup, link);
    const std::int64_t ticks = setup.tick_count();
    const auto start = std::chrono::steady_clock::now();
    for (std::int64_t tick = 0; tick < ticks; ++tick) {
        loop.tick(tick, observers);
    }
    const std::chrono::duration<double> wall = std::chrono::steady_clock::now() - start;
    return {ticks, wall.count(), static_cast<double>(ticks) * setup.tick_s() / wall.count()};
}

} // namespace quiesce
