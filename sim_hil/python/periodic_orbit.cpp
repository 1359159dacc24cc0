#include "periodic_orbit.h"

#include <Eigen/LU>

#include <algorithm>
#include <cmath>
#include <limits>
#include <sstream>

#include "input_error.h"

namespace quiesce {

namespace {

constexpr double kTwoPi = 6.28318530717958647692;
constexpr double kFewestSteps = 400.0;

/// The orbit closes when the state changes by less than this part over a period.
constexpr double kClosed = 1e-10;
constexpr int kNewtonSteps = 40;
/// Differences are taken over this part of a state's largest value, or of the full current.
constexpr double kStatePart = 1e-6;
constexpr double kCurrentPart = 1e-5;

/// Fixed point of a contraction that is piecewise linear: Aitken's extrapolation, exact on a piece.
template <typename Map>
double fixed_point(double x, Map &&map) {
    for (int i = 0; i < 100; ++i) {
        const double once = map(x);
        const double twice = map(once);
        const double bend = twice - 2.0 * once + x;
        const double next = bend != 0.0 ? x - (once - x) * (once - x) / bend : twice;
        if (std::abs(next - x) <= 1e-15 * (1.0 + std::abs(x)) || !std::isfinite(next)) {
            return twice;
        }
        x = next;
    }
    return x;
}

} // namespace

std::size_t orbit_grid(const PlantModel &model, const OrbitCase &orbit_case) {
    const double intervals = orbit_case.intervals * (orbit_case.covers_period ? 1.0 : 2.0);
    const double steps = std::max(kFewestSteps, 1.0 / (orbit_case.freq_Hz * model.max_step_s));
    return static_cast<std::size_t>(intervals * std::ceil(steps / intervals * (1.0 - 1e-9)));
}

PeriodicOrbit::PeriodicOrbit(const PlantModel &model, const OrbitCase &orbit_case)
    : equations_(model), case_(orbit_case), max_current_A_(model.driver.max_current_A),
      steps_(orbit_grid(model, orbit_case)),
      step_s_(1.0 / (orbit_case.freq_Hz * static_cast<double>(steps_))),
      half_step_coil_(model.dampers[0].coil, 0.5 * step_s_), rk4_(equations_.state_count()),
      shaking_(2 * steps_ + 1), coil_A_(2 * steps_ + 1) {
    require_one_damper(model);
    if (equations_.is_sampled()) {
        throw InputError("the plant's damper model runs at a sample time of its own, so its motion "
                         "has no periodic solution; choose a model without delays");
    }
    const Shaker shaker(model.shaker);
    const double amplitude = shaker.amplitude(orbit_case.freq_Hz, orbit_case.drive_V);
    for (std::size_t i = 0; i < shaking_.size(); ++i) {
        const double cycles = static_cast<double>(i) / static_cast<double>(2 * steps_);
        shaking_[i] =
            shaker.sample(amplitude * std::sin(kTwoPi * cycles), orbit_case.freq_Hz, cycles);
    }
}

/// The current after a period that starts with current_A; out: at every half step, or null.
double PeriodicOrbit::coil_pass(double current_A, const std::vector<double> &command_A,
                                double *out) const {
    const std::size_t intervals = command_A.size() * (case_.covers_period ? 1 : 2);
    const std::size_t in_each = 2 * steps_ / intervals;
    for (std::size_t interval = 0; interval < intervals; ++interval) {
        const double target_A = command_A[interval % command_A.size()];
        for (std::size_t i = 0; i < in_each; ++i) {
            if (out != nullptr) {
                *out++ = current_A;
            }
            current_A = half_step_coil_.step(current_A, target_A);
        }
    }
    return current_A;
}

void PeriodicOrbit::set_coil(const std::vector<double> &command_A) {
    const double start_A = fixed_point(
        command_A.back(), [&](double from_A) { return coil_pass(from_A, command_A, nullptr); });
    coil_A_.back() = coil_pass(start_A, command_A, coil_A_.data());
}

PeriodicOrbit::Period PeriodicOrbit::run(const Eigen::VectorXd &start) {
    const auto count = static_cast<Eigen::Index>(steps_);
    Period out{Eigen::VectorXd(count), Eigen::VectorXd(count), {}, start.cwiseAbs()};
    std::vector<double> y(start.data(), start.data() + start.size());
    std::vector<double> k1(y.size());
    const Eigen::Map<const Eigen::VectorXd> state(y.data(), start.size());
    for (std::size_t k = 0; k < steps_; ++k) {
        const ExcitationSample *shaking = &shaking_[2 * k];
        const double *coil_A = &coil_A_[2 * k];
        const double base_m_s2 = shaking[0].base_accel_m_s2;
        equations_.rates(shaking[0].force_N, {coil_A[0]}, y, k1, base_m_s2);
        out.disp_m[static_cast<Eigen::Index>(k)] = equations_.displacement_m(y);
        out.accel_m_s2[static_cast<Eigen::Index>(k)] = equations_.accel_m_s2(k1, base_m_s2);
        rk4_.step(y, k1, step_s_,
                  [&](int at, const std::vector<double> &from, std::vector<double> &rates) {
                      equations_.rates(shaking[at].force_N, {coil_A[at]}, from, rates,
                                       shaking[at].base_accel_m_s2);
                  });
        out.largest = out.largest.cwiseMax(state.cwiseAbs());
    }
    out.end = state;
    ++periods_;
    return out;
}

double PeriodicOrbit::relative(const Eigen::VectorXd &change) const {
    const double largest = period_.largest.maxCoeff();
    if (largest == 0.0) {
        return change.cwiseAbs().maxCoeff();
    }
    const Eigen::VectorXd scale = period_.largest.cwiseMax(1e-9 * largest);
    const double worst = change.cwiseQuotient(scale).cwiseAbs().maxCoeff();
    return change.allFinite() ? worst : std::numeric_limits<double>::infinity();
}

void PeriodicOrbit::take(const Eigen::VectorXd &start, Period period) {
    start_ = start;
    period_ = std::move(period);
    residual_ = relative(period_.end - start_);
}

void PeriodicOrbit::settle(int count) {
    for (int i = 0; i < count; ++i) {
        const Eigen::VectorXd end = period_.end;
        take(end, run(end));
    }
}

PeriodicOrbit::Monodromy PeriodicOrbit::monodromy() {
    const Eigen::Index states = start_.size();
    const auto count = static_cast<Eigen::Index>(steps_);
    Monodromy out{Eigen::MatrixXd(count, states), Eigen::MatrixXd(count, states),
                  Eigen::MatrixXd(states, states)};
    const double floor = 1e-9 * std::max(period_.largest.maxCoeff(), 1e-6);
    for (Eigen::Index i = 0; i < states; ++i) {
        const double by = kStatePart * std::max(period_.largest[i], floor);
        Eigen::VectorXd start = start_;
        start[i] += by;
        const Period moved = run(start);
        out.disp.col(i) = (moved.disp_m - period_.disp_m) / by;
        out.accel.col(i) = (moved.accel_m_s2 - period_.accel_m_s2) / by;
        out.end.col(i) = (moved.end - period_.end) / by;
    }
    return out;
}

/// False where no part of the step brings the orbit closer to closing.
bool PeriodicOrbit::newton_step() {
    const Eigen::Index states = start_.size();
    const Eigen::MatrixXd left = Eigen::MatrixXd::Identity(states, states) - monodromy().end;
    const Eigen::VectorXd step = left.partialPivLu().solve(period_.end - start_);
    for (int halvings = 0; halvings < 5; ++halvings) {
        const Eigen::VectorXd start = start_ + std::ldexp(1.0, -halvings) * step;
        const Period trial = run(start);
        if (relative(trial.end - start) < residual_) {
            take(start, trial);
            return true;
        }
    }
    return false;
}

void PeriodicOrbit::solve(const double *command_A, const double *guess) {
    command_A_.assign(command_A, command_A + case_.intervals);
    set_coil(command_A_);
    periods_ = 0;
    const auto states = static_cast<Eigen::Index>(state_count());
    const Eigen::VectorXd start = guess != nullptr
                                      ? Eigen::Map<const Eigen::VectorXd>(guess, states).eval()
                                      : Eigen::VectorXd::Zero(states).eval();
    period_.largest = Eigen::VectorXd::Zero(states);
    take(start, run(start));
    settle(guess != nullptr ? 0 : 2);
    for (int i = 0; i < kNewtonSteps && residual_ > kClosed; ++i) {
        if (!newton_step()) {
            settle(10);
        }
    }
    check_orbit();
}

void PeriodicOrbit::check_orbit() const {
    std::ostringstream message;
    message << "at " << case_.freq_Hz << " Hz and " << case_.drive_V << " V ";
    // Differences cannot close an orbit further than this where the film is very stiff.
    if (!(residual_ <= 1e3 * kClosed)) {
        message << "no periodic motion was found";
        throw InputError(message.str());
    }
    std::vector<double> y(start_.data(), start_.data() + start_.size());
    if (equations_.closed_damper(y) < equations_.damper_count()) {
        message << "the damper closes to the end of its range; reduce shaker.drive_V";
        throw InputError(message.str());
    }
}

PeriodicOrbit::Sensitivity PeriodicOrbit::sensitivity() {
    const Eigen::Index states = start_.size();
    const auto count = static_cast<Eigen::Index>(steps_);
    const Monodromy m = monodromy();
    const Eigen::PartialPivLU<Eigen::MatrixXd> left(Eigen::MatrixXd::Identity(states, states) -
                                                    m.end);
    Sensitivity out{Eigen::MatrixXd(count, case_.intervals),
                    Eigen::MatrixXd(count, case_.intervals)};
    const double step_A = kCurrentPart * max_current_A_;
    for (Eigen::Index j = 0; j < case_.intervals; ++j) {
        std::vector<double> command_A = command_A_;
        double &moved_A = command_A[static_cast<std::size_t>(j)];
        const double by_A = moved_A + step_A <= max_current_A_ ? step_A : -step_A;
        moved_A += by_A;
        set_coil(command_A);
        const Period moved = run(start_);
        const Eigen::VectorXd start = left.solve(moved.end - period_.end) / by_A;
        out.disp_per_A.col(j) = (moved.disp_m - period_.disp_m) / by_A + m.disp * start;
        out.accel_per_A.col(j) = (moved.accel_m_s2 - period_.accel_m_s2) / by_A + m.accel * start;
    }
    set_coil(command_A_);
    return out;
}

} // namespace quiesce
