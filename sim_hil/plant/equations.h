/// The plant's equations of motion, without coils, excitation or clock.
///
///   eta'' + damping eta' + omega2 eta = at_force F_e - sum_k stroke_k F_k(v_k, x_k, I_k)
///                                       - sum_j stroke_j F_j(x_j, v_j)     of mounts
///                                       - base_participation a_g
///
/// State: eta, eta', the dampers' own states, one damper after the other.
#ifndef QUIESCE_EQUATIONS_H
#define QUIESCE_EQUATIONS_H

#include <cstddef>
#include <memory>
#include <optional>
#include <vector>

#include "plant_model.h"

namespace quiesce {

/// True values of a place at one instant.
struct PlaceTruth {
    double displacement_m; ///< relative to the base
    double velocity_m_s;   ///< relative to the base
    double accel_m_s2;     ///< absolute
};

class Equations {
  public:
    explicit Equations(const PlantModel &model);

    std::size_t state_count() const { return state_count_; }
    std::size_t damper_count() const { return dampers_.size(); }

    /// Writes the rates of state y, both of state_count() elements, and returns the dampers'
    /// resisting forces in N.
    DamperValues rates(double force_N, const DamperValues &current_A, const std::vector<double> &y,
                       std::vector<double> &out, double base_accel_m_s2 = 0.0) const;

    /// What the dampers do after an integration step of dt_s that ended in y.
    void after_step(const DamperValues &current_A, std::vector<double> &y, double dt_s) const;
    /// A damper samples: its force is no function of y that can be integrated at any step.
    bool is_sampled() const;

    /// At the sensor: relative to the base, and absolute.
    double displacement_m(const std::vector<double> &y) const;
    double accel_m_s2(const std::vector<double> &rates, double base_accel_m_s2 = 0.0) const;

    PlaceTruth at(const Place &place, const std::vector<double> &y,
                  const std::vector<double> &rates, double base_accel_m_s2) const;

    double stroke_m(std::size_t damper, const std::vector<double> &y) const;
    /// Temperature of a damper's fluid, of those that keep one.
    std::optional<double> fluid_C(std::size_t damper, const std::vector<double> &y) const;
    double stroke_velocity_m_s(std::size_t damper, const std::vector<double> &y) const;

    /// The first damper whose ends have come to the end of its range; damper_count() where none
    /// has.
    std::size_t closed_damper(const std::vector<double> &y) const;

  private:
    struct Joined {
        std::shared_ptr<const Damper> damper;
        Eigen::VectorXd stroke;
        std::size_t first_state; ///< in y
    };

    Structure structure_;
    std::vector<Joined> dampers_;
    std::vector<PlantMount> mounts_;
    std::size_t state_count_;
};

} // namespace quiesce

#endif
