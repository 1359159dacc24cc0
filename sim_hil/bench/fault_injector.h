/// Applies a scenario's faults to what the controller sees and to the actuator.
#ifndef QUIESCE_FAULT_INJECTOR_H
#define QUIESCE_FAULT_INJECTOR_H

#include <cstdint>
#include <set>
#include <utility>
#include <vector>

#include "firmware.h"
#include "plant.h"
#include "rig.h"

namespace quiesce {

class FaultInjector {
  public:
    /// full_scale_counts: of each sensor.
    FaultInjector(std::vector<PlacedFault> faults, std::vector<std::int32_t> full_scale_counts);

    /// Another one, which may have begun.
    void add(const PlacedFault &fault);

    /// Ends all that are present at time_s, and calls off those to come.
    void clear(double time_s);

    /// Kinds of those that are present in the tick that begins at time_s, each once.
    std::set<FaultKind> present(double time_s) const;

    /// Alters the stimulus of the tick that begins at time_s.
    void apply(double time_s, lockstep_stimulus_t &stimulus);

    /// State of a damper's actuator in the tick that begins at time_s.
    ActuatorFault actuator(double time_s, std::size_t damper) const;

  private:
    using Position = std::vector<PlacedFault>::const_iterator;

    /// The few faults, of perhaps thousands, that can be active at time_s, and some that are not.
    std::pair<Position, Position> around(double time_s) const;
    void apply(FaultKind kind, std::size_t sensor, lockstep_stimulus_t &stimulus) const;
    void note_ends(); ///< after another one

    std::vector<PlacedFault> faults_; ///< by start; as given where two start together
    std::vector<double> last_end_s_;  ///< of each fault and all before it
    std::vector<std::int32_t> full_scale_counts_;
    std::vector<std::int32_t> last_counts_; ///< of the last samples that reached the controller
};

} // namespace quiesce

#endif
