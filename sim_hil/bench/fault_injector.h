/// Applies a scenario's faults to what the controller sees and to the actuator.
#ifndef QUIESCE_FAULT_INJECTOR_H
#define QUIESCE_FAULT_INJECTOR_H

#include <cstdint>
#include <utility>
#include <vector>

#include "firmware.h"
#include "plant.h"
#include "scenario.h"

namespace quiesce {

class FaultInjector {
  public:
    /// full_scale_counts: of the accelerometer.
    FaultInjector(const std::vector<InjectedFault> &faults, std::int32_t full_scale_counts);

    /// Alters the stimulus of the tick that begins at time_s.
    void apply(double time_s, lockstep_stimulus_t &stimulus);

    /// State of the actuator in the tick that begins at time_s.
    ActuatorFault actuator(double time_s) const;

  private:
    using Position = std::vector<InjectedFault>::const_iterator;

    /// The few faults, of perhaps thousands, that can be active at time_s, and some that are not.
    std::pair<Position, Position> around(double time_s) const;
    void apply(FaultKind kind, lockstep_stimulus_t &stimulus) const;

    std::vector<InjectedFault> faults_; ///< by start; as given where two start together
    std::vector<double> last_end_s_;    ///< of each fault and all before it
    std::int32_t full_scale_counts_;
    std::int32_t last_counts_ = 0; ///< of the last sample that reached the controller
};

} // namespace quiesce

#endif
