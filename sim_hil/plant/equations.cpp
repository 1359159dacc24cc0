#include "equations.h"

namespace quiesce {

namespace {

double dot(const Eigen::VectorXd &shape, const double *modal) {
    double sum = 0.0;
    for (Eigen::Index i = 0; i < shape.size(); ++i) {
        sum += shape[i] * modal[i];
    }
    return sum;
}

} // namespace

double Equations::rates(double force_N, double current_A, const std::vector<double> &y,
                        std::vector<double> &out, double base_accel_m_s2) const {
    const auto count = static_cast<std::size_t>(structure_.mode_count());
    const double *eta = y.data();
    const double *eta_rate = eta + count;
    double *accel = out.data() + count;
    const double damper_force_N = damper_->force_N(
        {dot(structure_.at_damper, eta_rate), dot(structure_.at_damper, eta), current_A},
        eta_rate + count, accel + count);
    for (std::size_t i = 0; i < count; ++i) {
        const auto mode = static_cast<Eigen::Index>(i);
        out[i] = eta_rate[i];
        accel[i] = structure_.at_force[mode] * force_N -
                   structure_.at_damper[mode] * damper_force_N -
                   structure_.damping_1_s(mode, mode) * eta_rate[i] -
                   structure_.omega2_rad2_s2[mode] * eta[i] -
                   structure_.base_participation[mode] * base_accel_m_s2;
    }
    if (structure_.is_proportional) {
        return damper_force_N;
    }
    for (std::size_t i = 0; i < count; ++i) {
        for (std::size_t j = 0; j < count; ++j) {
            accel[i] -= i == j ? 0.0
                               : structure_.damping_1_s(static_cast<Eigen::Index>(i),
                                                        static_cast<Eigen::Index>(j)) *
                                     eta_rate[j];
        }
    }
    return damper_force_N;
}

void Equations::after_step(double current_A, std::vector<double> &y, double dt_s) const {
    const auto count = static_cast<std::size_t>(structure_.mode_count());
    damper_->after_step({dot(structure_.at_damper, y.data() + count),
                         dot(structure_.at_damper, y.data()), current_A},
                        y.data() + 2 * count, dt_s);
}

double Equations::displacement_m(const std::vector<double> &y) const {
    return dot(structure_.at_sensor, y.data());
}

double Equations::accel_m_s2(const std::vector<double> &rates, double base_accel_m_s2) const {
    return dot(structure_.at_sensor, rates.data() + structure_.mode_count()) +
           structure_.base_at_sensor * base_accel_m_s2;
}

double Equations::damper_velocity_m_s(const std::vector<double> &y) const {
    return dot(structure_.at_damper, y.data() + structure_.mode_count());
}

bool Equations::is_closed(const std::vector<double> &y) const {
    return dot(structure_.at_damper, y.data()) <= damper_->lowest_position_m();
}

} // namespace quiesce
