#include "run.h"

#include <chrono>
#include <cmath>

#include "accelerometer.h"
#include "fault_injector.h"
#include "input_error.h"

namespace quiesce {

namespace {

/// One scenario in progress.
class Loop {
  public:
    Loop(const RunSetup &setup, ControllerLink &link)
        : setup_(setup), link_(link),
          excitation_(make_excitation(setup.scenario, setup.plant.shaker)),
          plant_(setup.plant, excitation_, setup.params.tick_rate_Hz),
          sensor_(setup.plant.sensor, setup.seed),
          injector_(setup.scenario.faults, sensor_.full_scale_counts()) {}

    void tick(std::int64_t tick, const std::vector<TickObserver *> &observers) {
        const double time_s = static_cast<double>(tick) / setup_.params.tick_rate_Hz;
        // What the controller answered one tick ago acts from here on.
        const double command_A =
            (reply_.drivers_enabled & 1u) != 0 ? 1e-3 * reply_.current_cmd_mA[0] : 0.0;
        plant_.command(command_A, injector_.actuator(time_s));
        sense(time_s);
        link_.exchange(stimulus_, reply_);
        for (TickObserver *observer : observers) {
            observer->on_tick({tick, time_s, plant_.truth(), stimulus_, reply_});
        }
        const std::vector<PlantTruth> &steps = plant_.advance();
        for (TickObserver *observer : observers) {
            observer->on_steps(time_s, plant_.step_s(), steps);
        }
    }

  private:
    void sense(double time_s) {
        stimulus_ = {LOCKSTEP_FRESH | LOCKSTEP_ENABLE,
                     {sensor_.sample_counts(plant_.truth().accel_m_s2)},
                     {0}};
        stimulus_.flags |= setup_.wants_report ? LOCKSTEP_REPORT : 0u;
        if (setup_.scenario.feed_current) {
            stimulus_.flags |= LOCKSTEP_HAS_CURRENT;
            stimulus_.current_meas_mA[0] =
                static_cast<std::int32_t>(std::lround(1e3 * plant_.truth().coil_A));
        }
        injector_.apply(time_s, stimulus_);
    }

    const RunSetup &setup_;
    ControllerLink &link_;
    Excitation excitation_;
    Plant plant_;
    Accelerometer sensor_;
    FaultInjector injector_;
    lockstep_stimulus_t stimulus_{};
    lockstep_reply_t reply_{};
};

} // namespace

std::int64_t RunSetup::tick_count() const {
    return std::llround(scenario.duration_s * static_cast<double>(params.tick_rate_Hz));
}

RunTiming run_scenario(const RunSetup &setup, ControllerLink &link,
                       const std::vector<TickObserver *> &observers) {
    if (!link.start(nullptr, setup.params)) {
        throw InputError("the controller on target " + link.target() + " refuses its parameters");
    }
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
