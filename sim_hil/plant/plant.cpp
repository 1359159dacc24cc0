#include "plant.h"

#include <cmath>
#include <sstream>

#include "input_error.h"

namespace quiesce {

namespace {

[[noreturn]] void stop(double now_s, const std::string &why) {
    std::ostringstream message;
    message << "the simulation stopped at t = " << now_s << " s: " << why;
    throw InputError(message.str());
}

} // namespace

Plant::Plant(const PlantModel &model, const Excitation &excitation, int tick_rate_Hz)
    : equations_(model), excitation_(&excitation), driver_(model.driver),
      steps_(steps_per_tick(model, 1.0 / tick_rate_Hz)),
      step_rate_Hz_(static_cast<double>(tick_rate_Hz * steps_)), step_s_(1.0 / step_rate_Hz_),
      places_(model.places), dampers_(model.dampers), rk4_(equations_.state_count()),
      y_(equations_.state_count(), 0.0), k1_(y_.size(), 0.0), excitation_now_(excitation.at(0.0)),
      substeps_(static_cast<std::size_t>(steps_)) {
    for (const PlantDamper &one : dampers_) {
        actuators_.push_back({Coil(one.coil, 0.5 * step_s_),
                              Remanence(one.coil.remanence * model.driver.max_current_A), 0.0});
    }
    observe();
}

void Plant::command(std::size_t damper, double current_A, ActuatorFault fault) {
    Actuator &actuator = actuators_[damper];
    if (fault != ActuatorFault::driver_stuck) {
        actuator.driver_A = fault == ActuatorFault::coil_open ? 0.0 : driver_.output_A(current_A);
    }
    if (fault == ActuatorFault::coil_open && coil_A_[damper] != 0.0) {
        coil_A_[damper] = 0.0;
        effective_A_[damper] = actuator.remanence.step(effective_A_[damper], coil_A_[damper]);
        observe();
    }
}

PlaceTruth Plant::place(std::size_t index) const {
    return equations_.at(places_[index], y_, k1_, excitation_now_.base_accel_m_s2);
}

DamperTruth Plant::damper(std::size_t index) const {
    return {equations_.stroke_m(index, y_), equations_.stroke_velocity_m_s(index, y_),
            damper_force_N_[index], coil_A_[index], equations_.fluid_C(index, y_)};
}

void Plant::observe() {
    const double base_accel_m_s2 = excitation_now_.base_accel_m_s2;
    damper_force_N_ =
        equations_.rates(excitation_now_.force_N, effective_A_, y_, k1_, base_accel_m_s2);
    truth_ = {equations_.displacement_m(y_),
              equations_.accel_m_s2(k1_, base_accel_m_s2),
              coil_A_[0],
              damper_force_N_[0],
              excitation_now_.phase_cycles,
              equations_.stroke_velocity_m_s(0, y_)};
}

/// Half a step later.
Plant::Drive Plant::drive_after(const Drive &before, const Excitation::Sample &excitation) const {
    Drive after{excitation.force_N, excitation.base_accel_m_s2, {}, {}};
    for (std::size_t k = 0; k < actuators_.size(); ++k) {
        const Actuator &actuator = actuators_[k];
        after.coil_A[k] = actuator.half_step_coil.step(before.coil_A[k], actuator.driver_A);
        after.effective_A[k] = actuator.remanence.step(before.effective_A[k], after.coil_A[k]);
    }
    return after;
}

void Plant::step() {
    const auto start = static_cast<double>(step_count_);
    const double end_s = time_s(start + 1.0);
    const Excitation::Sample end = excitation_->sample(segment_, end_s);
    Drive stage[3] = {};
    stage[0] = {excitation_now_.force_N, excitation_now_.base_accel_m_s2, coil_A_, effective_A_};
    stage[1] = drive_after(stage[0], excitation_->sample(segment_, time_s(start + 0.5)));
    stage[2] = drive_after(stage[1], end);
    rk4_.step(y_, k1_, step_s_,
              [&](int at, const std::vector<double> &y, std::vector<double> &out) {
                  equations_.rates(stage[at].force_N, stage[at].effective_A, y, out,
                                   stage[at].base_accel_m_s2);
              });
    coil_A_ = stage[2].coil_A;
    effective_A_ = stage[2].effective_A;
    equations_.after_step(effective_A_, y_, step_s_);
    ++step_count_;
    // A new segment's force may differ from what the old one ended with.
    const std::size_t segment = excitation_->segment_at(end_s);
    excitation_now_ = segment == segment_ ? end : excitation_->sample(segment, end_s);
    segment_ = segment;
    observe();
}

const std::vector<PlantTruth> &Plant::advance() {
    for (PlantTruth &after : substeps_) {
        step();
        after = truth_;
    }
    check_motion();
    return substeps_;
}

void Plant::visit_state(StateArchive &archive) {
    for (Actuator &actuator : actuators_) {
        archive(actuator.driver_A);
    }
    archive(y_);
    archive(coil_A_);
    archive(effective_A_);
    archive(step_count_);
    archive(excitation_now_);
    archive(segment_);
    if (archive.is_loading()) {
        observe(); // the rest follows
    }
}

void Plant::check_motion() const {
    const double now_s = time_s(static_cast<double>(step_count_));
    if (!std::isfinite(truth_.accel_m_s2)) {
        stop(now_s, "it diverged; choose a smaller integration.max_step_us in the plant file or "
                    "--dt-us");
    }
    const std::size_t closed = equations_.closed_damper(y_);
    if (closed < dampers_.size()) {
        stop(now_s, "the " + label(dampers_[closed]) +
                        " closed to the end of its range; reduce "
                        "shaker.drive_V or check the damper's gap");
    }
}

} // namespace quiesce
