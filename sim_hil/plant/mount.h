/// A mount between two places that is no linear spring: what it adds to the structure's stiffness.
#ifndef QUIESCE_MOUNT_H
#define QUIESCE_MOUNT_H

#include <Eigen/Core>

#include <memory>

namespace quiesce {

class Mount {
  public:
    virtual ~Mount() = default;

    /// Resisting: > 0 resists a growing stroke. Finite for finite values; 0 at rest.
    virtual double force_N(double stroke_m, double velocity_m_s) const = 0;
    /// Upper bounds of its slopes over stroke and velocity, >= 0.
    virtual double stiffest_N_m() const = 0;
    virtual double stiffest_N_s_m() const = 0;
};

/// A mount and where it is.
struct PlantMount {
    std::shared_ptr<const Mount> mount;
    Eigen::VectorXd stroke; ///< that 1 of each mode gives, kg^-1/2: its end a less its end b
};

} // namespace quiesce

#endif
