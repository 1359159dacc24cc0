/// Applies a scenario's faults to what the controller sees and to the actuator.
#ifndef QUIESCE_FAULT_INJECTOR_H
#define QUIESCE_FAULT_INJECTOR_H

#include <cstdint>
#include <vector>

#include "firmware.h"
#include "plant.h"
#include "scenario.h"

namespace quiesce {

class FaultInjector {
  public:
    /// full_scale_counts: of the accelerometer.
    FaultInjector(const std::vector<InjectedFault> &faults, std::int32_t full_scale_counts)
        : faults_(faults), full_scale_counts_(full_scale_counts) {}

    /// Alters the stimulus of the tick that begins at time_s.
    void apply(double time_s, lockstep_stimulus_t &stimulus);

    /// State of the actuator in the tick that begins at time_s.
    ActuatorFault actuator(double time_s) const;

  private:
    bool is_active(const InjectedFault &fault, double time_s) const;
    void apply(FaultKind kind, lockstep_stimulus_t &stimulus) const;

    std::vector<InjectedFault> faults_;
    std::int32_t full_scale_counts_;
    std::int32_t last_counts_ = 0; ///< of the last sample that reached the controller
};

} // namespace quiesce

#endif
