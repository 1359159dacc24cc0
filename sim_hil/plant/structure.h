/// A linear structure in modal coordinates, with one excitation point and one sensor.
///
///   eta'' + damping eta' + omega2 eta = at_force F_e - base_participation a_g
///   displacement at a point = at_point . eta          relative to the base
///   acceleration at the sensor = at_sensor . eta'' + base_at_sensor a_g          absolute
///
/// Modes are mass-normalised. The damping matrix is diagonal where damping is proportional; where
/// it is not, it is kept in full, so that M/C/K structures are simulated without approximation
/// (other than modes that the user asks to leave out).
#ifndef QUIESCE_STRUCTURE_H
#define QUIESCE_STRUCTURE_H

#include <Eigen/Core>

#include <vector>

namespace quiesce {

struct Structure {
    Eigen::VectorXd omega2_rad2_s2; ///< squares of the natural frequencies
    Eigen::MatrixXd damping_1_s;    ///< 2 xi omega on the diagonal
    Eigen::VectorXd at_force;       ///< mode shapes in kg^-1/2
    Eigen::VectorXd at_sensor;
    Eigen::VectorXd base_participation; ///< kg^1/2: modal force per base acceleration a_g
    double base_at_sensor;              ///< how the sensor moves with the base: 1, all of it
    bool is_proportional;               ///< damping_1_s is diagonal
    /// [degree of freedom x mode] of matrices; of modes, which know no other degrees, 1.
    Eigen::MatrixXd shapes;
    Eigen::VectorXd base; ///< that of Matrices; empty for modes

    Eigen::Index mode_count() const { return omega2_rad2_s2.size(); }

    /// Modal shape of a point from its motion per degree of freedom (modes: per mode).
    Eigen::VectorXd shape_of(const Eigen::VectorXd &at) const { return shapes.transpose() * at; }
};

struct Mode {
    double freq_Hz;
    double damping_ratio;
    double at_force; ///< mass-normalised shape, kg^-1/2
    double at_sensor;
    double base_participation = 0.0; ///< shape . mass . base, kg^1/2
};

Structure structure_from_modes(const std::vector<Mode> &modes);

/// n degrees of freedom, relative to the base:
///
///   M q'' + C q' + K q = force F_e - M base a_g          sensor reads sensor . q
struct Matrices {
    Eigen::MatrixXd mass_kg;
    Eigen::MatrixXd damping_N_s_m;
    Eigen::MatrixXd stiffness_N_m;
    Eigen::VectorXd force;
    Eigen::VectorXd sensor;
    Eigen::VectorXd base; ///< motion of each degree of freedom when the base moves by 1
};

/// Keeps the mode_count lowest modes (1 .. n). Throws InputError unless all three matrices are
/// symmetric, mass_kg positive definite, and the other two have no negative eigenvalue.
Structure structure_from_matrices(const Matrices &matrices, Eigen::Index mode_count);

} // namespace quiesce

#endif
