#include "fault_injector.h"

#include <algorithm>
#include <limits>
#include <utility>

namespace quiesce {

namespace {

/// Half a microsecond keeps a tick that begins at a fault's start inside it whatever the rounding.
constexpr double kSlack_s = 5e-7;

bool is_active(const InjectedFault &fault, double time_s) {
    const double since_s = time_s - fault.start_s + kSlack_s;
    return since_s >= 0.0 && since_s < fault.duration_s;
}

} // namespace

FaultInjector::FaultInjector(std::vector<PlacedFault> faults,
                             std::vector<std::int32_t> full_scale_counts)
    : faults_(std::move(faults)), full_scale_counts_(std::move(full_scale_counts)),
      last_counts_(full_scale_counts_.size(), 0) {
    std::stable_sort(faults_.begin(), faults_.end(),
                     [](const PlacedFault &a, const PlacedFault &b) {
                         return a.fault.start_s < b.fault.start_s;
                     });
    note_ends();
}

void FaultInjector::note_ends() {
    double last_end_s = -std::numeric_limits<double>::infinity();
    last_end_s_.clear();
    for (const auto &[fault, sensor, damper] : faults_) {
        last_end_s = std::max(last_end_s, fault.start_s + fault.duration_s);
        last_end_s_.push_back(last_end_s);
    }
}

void FaultInjector::add(const PlacedFault &fault) {
    const auto after = std::upper_bound(
        faults_.begin(), faults_.end(), fault.fault.start_s,
        [](double start_s, const PlacedFault &other) { return start_s < other.fault.start_s; });
    faults_.insert(after, fault);
    note_ends();
}

void FaultInjector::clear(double time_s) {
    faults_.erase(std::remove_if(faults_.begin(), faults_.end(),
                                 [time_s](const PlacedFault &placed) {
                                     return placed.fault.start_s + placed.fault.duration_s > time_s;
                                 }),
                  faults_.end());
    note_ends();
}

std::set<FaultKind> FaultInjector::present(double time_s) const {
    std::set<FaultKind> out;
    const auto [begin, end] = around(time_s);
    for (auto placed = begin; placed != end; ++placed) {
        if (is_active(placed->fault, time_s)) {
            out.insert(placed->fault.kind);
        }
    }
    return out;
}

std::pair<FaultInjector::Position, FaultInjector::Position>
FaultInjector::around(double time_s) const {
    const auto end = std::upper_bound(
        faults_.begin(), faults_.end(), time_s + kSlack_s,
        [](double now_s, const PlacedFault &placed) { return now_s < placed.fault.start_s; });
    const auto over = std::lower_bound(last_end_s_.begin(), last_end_s_.end(), time_s);
    const auto begin = faults_.begin() + (over - last_end_s_.begin());
    return {std::min<Position>(begin, end), end};
}

void FaultInjector::apply(double time_s, lockstep_stimulus_t &stimulus) {
    const auto [begin, end] = around(time_s);
    for (auto placed = begin; placed != end; ++placed) {
        if (is_active(placed->fault, time_s)) {
            apply(placed->fault.kind, placed->sensor, stimulus);
        }
    }
    for (std::size_t i = 0; i < last_counts_.size(); ++i) {
        const bool is_seen =
            (stimulus.flags & LOCKSTEP_FRESH << i) != 0 && (stimulus.flags & LOCKSTEP_LOST) == 0;
        last_counts_[i] = is_seen ? stimulus.counts[i] : last_counts_[i];
    }
}

void FaultInjector::apply(FaultKind kind, std::size_t sensor, lockstep_stimulus_t &stimulus) const {
    switch (kind) {
    case FaultKind::dropout:
        stimulus.flags &= ~(LOCKSTEP_FRESH << sensor);
        break;
    case FaultKind::stuck:
        stimulus.counts[sensor] = last_counts_[sensor];
        break;
    case FaultKind::saturate:
        stimulus.counts[sensor] = full_scale_counts_[sensor];
        break;
    case FaultKind::range:
        stimulus.counts[sensor] = 2 * full_scale_counts_[sensor];
        break;
    case FaultKind::estop:
        stimulus.flags |= LOCKSTEP_ESTOP;
        break;
    case FaultKind::fault_reset:
        stimulus.flags |= LOCKSTEP_FAULT_RESET;
        stimulus.flags &= ~LOCKSTEP_ENABLE; // let go, so that it can arm again
        break;
    case FaultKind::disable:
        stimulus.flags &= ~LOCKSTEP_ENABLE;
        break;
    case FaultKind::lost_tick:
        stimulus.flags |= LOCKSTEP_LOST;
        break;
    case FaultKind::coil_open:
    case FaultKind::driver_stuck:
        break; // what the plant does, not what the controller sees
    }
}

ActuatorFault FaultInjector::actuator(double time_s, std::size_t damper) const {
    ActuatorFault state = ActuatorFault::none;
    const auto [begin, end] = around(time_s);
    for (auto placed = begin; placed != end; ++placed) {
        if (placed->damper != damper || !is_active(placed->fault, time_s)) {
            continue;
        }
        if (placed->fault.kind == FaultKind::coil_open) {
            return ActuatorFault::coil_open;
        }
        if (placed->fault.kind == FaultKind::driver_stuck) {
            state = ActuatorFault::driver_stuck;
        }
    }
    return state;
}

} // namespace quiesce
