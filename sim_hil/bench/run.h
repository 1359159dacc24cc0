/// The lock-step loop: plant, sensor, controller and back, one control tick at a time.
#ifndef QUIESCE_RUN_H
#define QUIESCE_RUN_H

#include <cstdint>
#include <optional>
#include <vector>

#include "controller_link.h"
#include "plant.h"
#include "rig.h"
#include "scenario.h"

namespace quiesce {

/// Everything that decides the outcome of a run, overrides applied.
struct RunSetup {
    PlantModel plant;
    Scenario scenario;
    std::optional<Rig> rig; ///< none: the plant's one sensor and one damper, as parameters say
    quiesce_params_t params;
    Tables tables; ///< of the controller, those of them that ship left out
    std::uint64_t seed;
    bool wants_report = false;  ///< what the law reports, in every tick
    bool wants_picture = false; ///< what the controller makes of its sensors, in every tick

    const Rig *rig_or_null() const { return rig ? &*rig : nullptr; }
    const quiesce_board_t *board() const { return rig ? &rig->board() : nullptr; }

    double tick_s() const { return 1.0 / static_cast<double>(params.tick_rate_Hz); }
    std::int64_t tick_count() const;
};

/// One tick: sample at time_s, what the controller saw, what it answered. The command acts from the
/// next tick on.
struct TickRecord {
    std::int64_t tick;
    double time_s;
    const PlantTruth &truth;
    const Plant &plant; ///< at the same instant
    const lockstep_stimulus_t &stimulus;
    const lockstep_reply_t &reply;
};

class TickObserver {
  public:
    virtual ~TickObserver() = default;

    virtual void on_tick(const TickRecord &record) = 0;

    /// The integration steps of the tick that followed; the last one ends where the next tick
    /// begins.
    virtual void on_steps(double /*start_s*/, double /*step_s*/,
                          const std::vector<PlantTruth> & /*steps*/) {}
};

struct RunTiming {
    std::int64_t ticks;
    double wall_s;          ///< of the loop alone
    double realtime_factor; ///< simulated time / wall_s
};

/// Starts the link and runs the whole scenario. Throws InputError when the target refuses what it
/// is started with or fails, or when the plant leaves its model's range.
RunTiming run_scenario(const RunSetup &setup, ControllerLink &link,
                       const std::vector<TickObserver *> &observers);

} // namespace quiesce

#endif
