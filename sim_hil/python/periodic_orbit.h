/// The periodic motion of a plant under a sinusoidal force, or acceleration of its base, and a
/// periodic driver output, and how it changes with that output.
///
/// The coil's periodic current is found first: it does not depend on the motion. The state y at
/// theta = 0 then solves P(y) = y, P being one period of classical Runge-Kutta, by Newton's method
/// with the derivative M of P by differences; where that fails, by periods of plain simulation.
/// Derivatives by the commands c: dy/dc = (I - M)^-1 dP/dc.
#ifndef QUIESCE_PERIODIC_ORBIT_H
#define QUIESCE_PERIODIC_ORBIT_H

#include <Eigen/Core>

#include <vector>

#include "coil.h"
#include "equations.h"
#include "rk4.h"
#include "segment.h"

namespace quiesce {

struct OrbitCase {
    double freq_Hz;     ///< > 0
    double drive_V;     ///< amplitude
    int intervals;      ///< of constant command, >= 1
    bool covers_period; ///< they cover the period; else half of it, and repeat
};

/// Integration steps in a period: a multiple of the intervals, at least 400, none longer than the
/// plant's max_step_s.
std::size_t orbit_grid(const PlantModel &model, const OrbitCase &orbit_case);

class PeriodicOrbit {
  public:
    /// One period: values at theta = 2 pi k / grid.
    struct Period {
        Eigen::VectorXd disp_m;
        Eigen::VectorXd accel_m_s2;
        Eigen::VectorXd end;     ///< state after the period
        Eigen::VectorXd largest; ///< of each state, absolute
    };

    /// Derivatives by each command, [grid x intervals].
    struct Sensitivity {
        Eigen::MatrixXd disp_per_A;
        Eigen::MatrixXd accel_per_A;
    };

    PeriodicOrbit(const PlantModel &model, const OrbitCase &orbit_case);

    std::size_t grid() const { return steps_; }
    std::size_t state_count() const { return equations_.state_count(); }

    /// Finds the orbit of a command [intervals], from a guess [state count] or from nothing. Throws
    /// InputError where there is none to be found, or where the damper closes.
    void solve(const double *command_A, const double *guess);

    const Eigen::VectorXd &start() const { return start_; }
    const Period &period() const { return period_; }
    const std::vector<double> &coil_half_steps_A() const { return coil_A_; }
    double residual() const { return residual_; }
    int periods() const { return periods_; }

    /// Of the orbit that solve found.
    Sensitivity sensitivity();

  private:
    /// Derivatives of one period by the state at its start.
    struct Monodromy {
        Eigen::MatrixXd disp;  ///< [grid x states]
        Eigen::MatrixXd accel; ///< [grid x states]
        Eigen::MatrixXd end;   ///< [states x states]
    };

    void set_coil(const std::vector<double> &command_A);
    double coil_pass(double current_A, const std::vector<double> &command_A, double *out) const;
    Period run(const Eigen::VectorXd &start);
    Monodromy monodromy();
    void settle(int count);
    bool newton_step();
    void take(const Eigen::VectorXd &start, Period period);
    double relative(const Eigen::VectorXd &change) const;
    void check_orbit() const;

    Equations equations_;
    OrbitCase case_;
    double max_current_A_;
    std::size_t steps_;
    double step_s_;
    Coil half_step_coil_;
    Rk4 rk4_;
    std::vector<ExcitationSample> shaking_; ///< at every half step, 2 steps_ + 1
    std::vector<double> command_A_;
    std::vector<double> coil_A_; ///< likewise
    Eigen::VectorXd start_;
    Period period_;
    double residual_ = 0.0;
    int periods_ = 0;
};

} // namespace quiesce

#endif
