#include "fault_injector.h"

namespace quiesce {

bool FaultInjector::is_active(const InjectedFault &fault, double time_s) const {
    // Half a microsecond keeps a tick that begins at start_s inside whatever the rounding.
    constexpr double kSlack_s = 5e-7;
    const double since_s = time_s - fault.start_s + kSlack_s;
    return since_s >= 0.0 && since_s < fault.duration_s;
}

void FaultInjector::apply(double time_s, lockstep_stimulus_t &stimulus) {
    for (const InjectedFault &fault : faults_) {
        if (is_active(fault, time_s)) {
            apply(fault.kind, stimulus);
        }
    }
    last_counts_ = stimulus.accel_counts;
}

void FaultInjector::apply(FaultKind kind, lockstep_stimulus_t &stimulus) const {
    switch (kind) {
    case FaultKind::dropout:
        stimulus.flags &= ~LOCKSTEP_FRESH;
        break;
    case FaultKind::stuck:
        stimulus.accel_counts = last_counts_;
        break;
    case FaultKind::saturate:
        stimulus.accel_counts = full_scale_counts_;
        break;
    case FaultKind::range:
        stimulus.accel_counts = 2 * full_scale_counts_;
        break;
    case FaultKind::estop:
        stimulus.flags |= LOCKSTEP_ESTOP;
        break;
    case FaultKind::fault_reset:
        stimulus.flags |= LOCKSTEP_FAULT_RESET;
        break;
    case FaultKind::disable:
        stimulus.flags &= ~LOCKSTEP_ENABLE;
        break;
    case FaultKind::coil_open:
    case FaultKind::driver_stuck:
        break; // what the plant does, not what the controller sees
    }
}

ActuatorFault FaultInjector::actuator(double time_s) const {
    ActuatorFault state = ActuatorFault::none;
    for (const InjectedFault &fault : faults_) {
        if (!is_active(fault, time_s)) {
            continue;
        }
        if (fault.kind == FaultKind::coil_open) {
            return ActuatorFault::coil_open;
        }
        if (fault.kind == FaultKind::driver_stuck) {
            state = ActuatorFault::driver_stuck;
        }
    }
    return state;
}

} // namespace quiesce
