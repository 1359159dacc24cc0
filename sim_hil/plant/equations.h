/// The plant's equations of motion, without coil, excitation or clock.
///
///   eta'' + damping eta' + omega2 eta = at_force F_e - at_damper F_d(v_d, x_d, I)
///                                       - base_participation a_g
///
/// State: eta, eta', the damper's own states.
#ifndef QUIESCE_EQUATIONS_H
#define QUIESCE_EQUATIONS_H

#include <cstddef>
#include <memory>
#include <vector>

#include "plant_model.h"

namespace quiesce {

class Equations {
  public:
    explicit Equations(const PlantModel &model)
        : structure_(model.structure), damper_(model.damper) {}

    std::size_t state_count() const {
        return 2 * static_cast<std::size_t>(structure_.mode_count()) + damper_->state_count();
    }

    /// Writes the rates of state y, both of state_count() elements, and returns the damper's force.
    double rates(double force_N, double current_A, const std::vector<double> &y,
                 std::vector<double> &out, double base_accel_m_s2 = 0.0) const;

    /// What the damper does after an integration step of dt_s that ended in y.
    void after_step(double current_A, std::vector<double> &y, double dt_s) const;
    /// The damper samples: its force is no function of y that can be integrated at any step.
    bool is_sampled() const { return damper_->is_sampled(); }

    /// At the sensor: relative to the base, and absolute.
    double displacement_m(const std::vector<double> &y) const;
    double accel_m_s2(const std::vector<double> &rates, double base_accel_m_s2 = 0.0) const;

    double damper_velocity_m_s(const std::vector<double> &y) const;

    /// The damper's ends have come to the end of its range.
    bool is_closed(const std::vector<double> &y) const;

  private:
    Structure structure_;
    std::shared_ptr<const Damper> damper_;
};

} // namespace quiesce

#endif
