#include "equations.h"

#include <algorithm>

namespace quiesce {

namespace {

double dot(const Eigen::VectorXd &shape, const double *modal) {
    double sum = 0.0;
    for (Eigen::Index i = 0; i < shape.size(); ++i) {
        sum += shape[i] * modal[i];
    }
    return sum;
}

/// What a damper with this stroke sees. modal: eta, eta'.
DamperInput seen(const Eigen::VectorXd &stroke, const double *modal, double current_A) {
    return {dot(stroke, modal + stroke.size()), dot(stroke, modal), current_A};
}

/// The damping between different modes.
void couple(const Structure &structure, const double *eta_rate, double *accel) {
    const Eigen::Index count = structure.mode_count();
    for (Eigen::Index i = 0; i < count; ++i) {
        for (Eigen::Index j = 0; j < count; ++j) {
            accel[i] -= i == j ? 0.0 : structure.damping_1_s(i, j) * eta_rate[j];
        }
    }
}

/// What a mount does to each mode.
void resist(const PlantMount &one, const double *eta, const double *eta_rate, double *accel) {
    const double force_N = one.mount->force_N(dot(one.stroke, eta), dot(one.stroke, eta_rate));
    for (Eigen::Index i = 0; i < one.stroke.size(); ++i) {
        accel[i] -= one.stroke[i] * force_N;
    }
}

} // namespace

Equations::Equations(const PlantModel &model)
    : structure_(model.structure), mounts_(model.mounts),
      state_count_(2 * static_cast<std::size_t>(structure_.mode_count())) {
    for (const PlantDamper &one : model.dampers) {
        dampers_.push_back({one.damper, one.stroke, state_count_});
        state_count_ += one.damper->state_count();
    }
}

DamperValues Equations::rates(double force_N, const DamperValues &current_A,
                              const std::vector<double> &y, std::vector<double> &out,
                              double base_accel_m_s2) const {
    const auto count = static_cast<std::size_t>(structure_.mode_count());
    const double *eta = y.data();
    const double *eta_rate = eta + count;
    double *accel = out.data() + count;
    DamperValues damper_force_N{};
    for (std::size_t k = 0; k < dampers_.size(); ++k) {
        const Joined &one = dampers_[k];
        damper_force_N[k] =
            one.damper->force_N(seen(one.stroke, eta, current_A[k]), eta + one.first_state,
                                out.data() + one.first_state);
    }
    const Eigen::VectorXd &first = dampers_[0].stroke;
    for (std::size_t i = 0; i < count; ++i) {
        const auto mode = static_cast<Eigen::Index>(i);
        out[i] = eta_rate[i];
        accel[i] = structure_.at_force[mode] * force_N - first[mode] * damper_force_N[0] -
                   structure_.damping_1_s(mode, mode) * eta_rate[i] -
                   structure_.omega2_rad2_s2[mode] * eta[i] -
                   structure_.base_participation[mode] * base_accel_m_s2;
    }
    if (!structure_.is_proportional) {
        couple(structure_, eta_rate, accel);
    }
    for (std::size_t k = 1; k < dampers_.size(); ++k) {
        for (std::size_t i = 0; i < count; ++i) {
            accel[i] -= dampers_[k].stroke[static_cast<Eigen::Index>(i)] * damper_force_N[k];
        }
    }
    for (const PlantMount &one : mounts_) {
        resist(one, eta, eta_rate, accel);
    }
    return damper_force_N;
}

void Equations::after_step(const DamperValues &current_A, std::vector<double> &y,
                           double dt_s) const {
    for (std::size_t k = 0; k < dampers_.size(); ++k) {
        const Joined &one = dampers_[k];
        one.damper->after_step(seen(one.stroke, y.data(), current_A[k]), y.data() + one.first_state,
                               dt_s);
    }
}

bool Equations::is_sampled() const {
    return std::any_of(dampers_.begin(), dampers_.end(),
                       [](const Joined &one) { return one.damper->is_sampled(); });
}

double Equations::displacement_m(const std::vector<double> &y) const {
    return dot(structure_.at_sensor, y.data());
}

double Equations::accel_m_s2(const std::vector<double> &rates, double base_accel_m_s2) const {
    return dot(structure_.at_sensor, rates.data() + structure_.mode_count()) +
           structure_.base_at_sensor * base_accel_m_s2;
}

PlaceTruth Equations::at(const Place &place, const std::vector<double> &y,
                         const std::vector<double> &rates, double base_accel_m_s2) const {
    const Eigen::Index count = structure_.mode_count();
    return {dot(place.shape, y.data()), dot(place.shape, y.data() + count),
            dot(place.shape, rates.data() + count) + place.base * base_accel_m_s2};
}

double Equations::stroke_m(std::size_t damper, const std::vector<double> &y) const {
    return dot(dampers_[damper].stroke, y.data());
}

double Equations::stroke_velocity_m_s(std::size_t damper, const std::vector<double> &y) const {
    return dot(dampers_[damper].stroke, y.data() + structure_.mode_count());
}

std::optional<double> Equations::fluid_C(std::size_t damper, const std::vector<double> &y) const {
    const Joined &one = dampers_[damper];
    return one.damper->fluid_C(y.data() + one.first_state);
}

std::size_t Equations::closed_damper(const std::vector<double> &y) const {
    for (std::size_t k = 0; k < dampers_.size(); ++k) {
        if (stroke_m(k, y) <= dampers_[k].damper->lowest_position_m()) {
            return k;
        }
    }
    return dampers_.size();
}

} // namespace quiesce
