#include "structure.h"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>

#include <string>

#include "input_error.h"

namespace quiesce {

namespace {

constexpr double kTwoPi = 6.28318530717958647692;

/// Relative size below which an entry or eigenvalue is rounding.
constexpr double kRounding = 1e-9;

void require_symmetric(const Eigen::MatrixXd &matrix, const std::string &name) {
    const double scale = matrix.cwiseAbs().maxCoeff();
    if ((matrix - matrix.transpose()).cwiseAbs().maxCoeff() > kRounding * scale) {
        throw InputError(name + ": expected a symmetric matrix");
    }
}

void require_no_negative_eigenvalue(const Eigen::MatrixXd &matrix, const std::string &name) {
    require_symmetric(matrix, name);
    const Eigen::VectorXd values =
        Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(matrix, Eigen::EigenvaluesOnly)
            .eigenvalues();
    if (values.minCoeff() < -kRounding * values.cwiseAbs().maxCoeff()) {
        throw InputError(name + ": expected no negative eigenvalue, found " +
                         std::to_string(values.minCoeff()));
    }
}

bool is_diagonal(const Eigen::MatrixXd &matrix) {
    Eigen::MatrixXd rest = matrix;
    rest.diagonal().setZero();
    return rest.cwiseAbs().maxCoeff() <= kRounding * matrix.cwiseAbs().maxCoeff();
}

} // namespace

Structure structure_from_modes(const std::vector<Mode> &modes) {
    const auto count = static_cast<Eigen::Index>(modes.size());
    Structure out{Eigen::VectorXd(count),
                  Eigen::MatrixXd::Zero(count, count),
                  Eigen::VectorXd(count),
                  Eigen::VectorXd(count),
                  Eigen::VectorXd(count),
                  1.0,
                  true,
                  Eigen::MatrixXd::Identity(count, count),
                  {}};
    for (Eigen::Index i = 0; i < count; ++i) {
        const Mode &mode = modes[static_cast<std::size_t>(i)];
        const double omega = kTwoPi * mode.freq_Hz;
        out.omega2_rad2_s2(i) = omega * omega;
        out.damping_1_s(i, i) = 2.0 * mode.damping_ratio * omega;
        out.at_force(i) = mode.at_force;
        out.at_sensor(i) = mode.at_sensor;
        out.base_participation(i) = mode.base_participation;
    }
    return out;
}

Structure structure_from_matrices(const Matrices &matrices, Eigen::Index mode_count) {
    require_symmetric(matrices.mass_kg, "mass_kg");
    if (Eigen::LLT<Eigen::MatrixXd>(matrices.mass_kg).info() != Eigen::Success) {
        throw InputError("mass_kg: expected a positive definite matrix");
    }
    require_no_negative_eigenvalue(matrices.stiffness_N_m, "stiffness_N_m");
    require_no_negative_eigenvalue(matrices.damping_N_s_m, "damping_N_s_m");

    // The solver's eigenvectors are mass-normalised and sorted by rising frequency.
    const Eigen::GeneralizedSelfAdjointEigenSolver<Eigen::MatrixXd> solver(matrices.stiffness_N_m,
                                                                           matrices.mass_kg);
    const Eigen::MatrixXd shapes = solver.eigenvectors().leftCols(mode_count);
    const Eigen::MatrixXd damping = shapes.transpose() * matrices.damping_N_s_m * shapes;
    return {solver.eigenvalues().head(mode_count).cwiseMax(0.0),
            damping,
            shapes.transpose() * matrices.force,
            shapes.transpose() * matrices.sensor,
            shapes.transpose() * matrices.mass_kg * matrices.base,
            matrices.sensor.dot(matrices.base),
            is_diagonal(damping),
            shapes,
            matrices.base};
}

} // namespace quiesce
