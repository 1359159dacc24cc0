/// The C functions of periodic motion.
#include <algorithm>
#include <cmath>
#include <complex>
#include <sstream>

#include "input_error.h"
#include "periodic_orbit.h"
#include "plant_handle.h"

namespace {

using quiesce::InputError;
using quiesce::OrbitCase;
using quiesce::PeriodicOrbit;

constexpr double kTwoPi = 6.28318530717958647692;
constexpr int kMostIntervals = 100000;

using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

bool is_allowed(const quiesce_orbit_case &orbit_case) {
    return orbit_case.freq_Hz > 0.0 && std::isfinite(orbit_case.freq_Hz) &&
           orbit_case.drive_V >= 0.0 && std::isfinite(orbit_case.drive_V) &&
           orbit_case.intervals >= 1 && orbit_case.intervals <= kMostIntervals;
}

OrbitCase converted(const quiesce_orbit_case &from) {
    return {from.freq_Hz, from.drive_V, from.intervals, from.covers_period != 0};
}

void check(const quiesce_plant &plant, const quiesce_orbit_case &orbit_case,
           const double *command_A) {
    if (!is_allowed(orbit_case)) {
        throw InputError("frequency, drive and number of intervals must be positive and finite");
    }
    const double max_A = plant.model.driver.max_current_A;
    const auto is_wrong = [&](double value_A) { return !(value_A >= 0.0 && value_A <= max_A); };
    const double *end = command_A + orbit_case.intervals;
    const double *wrong = std::find_if(command_A, end, is_wrong);
    if (wrong != end) {
        std::ostringstream message;
        message << "command " << wrong - command_A << " is " << *wrong << " A; allowed are 0 .. "
                << max_A;
        throw InputError(message.str());
    }
}

/// The parabola through the largest value of a periodic series and its two neighbours.
double peak(const Eigen::VectorXd &values) {
    Eigen::Index at = 0;
    const double top = values.maxCoeff(&at);
    const Eigen::Index count = values.size();
    const double before = values[(at + count - 1) % count];
    const double after = values[(at + 1) % count];
    const double bend = before - 2.0 * top + after;
    return bend < 0.0 ? top - 0.125 * (after - before) * (after - before) / bend : top;
}

/// c of the fundamental Re(c exp(i theta)).
std::complex<double> fundamental(const Eigen::VectorXd &values) {
    const auto count = static_cast<double>(values.size());
    std::complex<double> sum = 0.0;
    for (Eigen::Index k = 0; k < values.size(); ++k) {
        sum += values[k] * std::polar(1.0, -kTwoPi * static_cast<double>(k) / count);
    }
    return 2.0 / count * sum;
}

double rms(const Eigen::VectorXd &values) {
    return std::sqrt(values.squaredNorm() / static_cast<double>(values.size()));
}

/// At whole steps.
Eigen::VectorXd coil_A(const PeriodicOrbit &orbit) {
    using Strided = Eigen::Map<const Eigen::VectorXd, 0, Eigen::InnerStride<2>>;
    return Strided(orbit.coil_half_steps_A().data(), static_cast<Eigen::Index>(orbit.grid()));
}

quiesce_orbit_figures figures_of(const PeriodicOrbit &orbit) {
    const PeriodicOrbit::Period &period = orbit.period();
    const std::complex<double> disp = fundamental(period.disp_m);
    const std::complex<double> accel = fundamental(period.accel_m_s2);
    return {0.5 * (peak(period.disp_m) + peak(-period.disp_m)),
            rms(period.disp_m),
            rms(period.accel_m_s2),
            coil_A(orbit).mean(),
            std::abs(disp),
            std::arg(disp),
            std::abs(accel),
            std::arg(accel),
            orbit.residual(),
            orbit.periods()};
}

void write(const Eigen::VectorXd &values, double *out) {
    if (out != nullptr) {
        Eigen::Map<Eigen::VectorXd>(out, values.size()) = values;
    }
}

void write_sensitivity(PeriodicOrbit &orbit, const quiesce_orbit &out) {
    const PeriodicOrbit::Sensitivity s = orbit.sensitivity();
    Eigen::Map<RowMajor>(out.disp_per_A, s.disp_per_A.rows(), s.disp_per_A.cols()) = s.disp_per_A;
    Eigen::Map<RowMajor>(out.accel_per_A, s.accel_per_A.rows(), s.accel_per_A.cols()) =
        s.accel_per_A;
}

} // namespace

std::size_t quiesce_orbit_grid(const quiesce_plant *plant, const quiesce_orbit_case *orbit_case) {
    return is_allowed(*orbit_case) ? quiesce::orbit_grid(plant->model, converted(*orbit_case)) : 0;
}

std::size_t quiesce_orbit_state_count(const quiesce_plant *plant) {
    return quiesce::Equations(plant->model).state_count();
}

int quiesce_orbit_solve(const quiesce_plant *plant, const quiesce_orbit_case *orbit_case,
                        const double *command_A, quiesce_orbit *orbit, char *error,
                        std::size_t error_size) {
    const auto work = [&] {
        check(*plant, *orbit_case, command_A);
        PeriodicOrbit solver(plant->model, converted(*orbit_case));
        const bool has_guess = orbit->start != nullptr && !std::isnan(orbit->start[0]);
        solver.solve(command_A, has_guess ? orbit->start : nullptr);
        orbit->figures = figures_of(solver);
        write(solver.start(), orbit->start);
        write(solver.period().disp_m, orbit->disp_m);
        write(solver.period().accel_m_s2, orbit->accel_m_s2);
        write(coil_A(solver), orbit->coil_A);
        if (orbit->disp_per_A != nullptr && orbit->accel_per_A != nullptr) {
            write_sensitivity(solver, *orbit);
        }
    };
    return quiesce::guarded(work, error, error_size);
}
