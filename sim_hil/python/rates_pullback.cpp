#include "rates_pullback.h"

#include <algorithm>
#include <cmath>

namespace quiesce {

namespace {

/// Differences are taken over this part of the largest value reached, or of the full current.
constexpr double kPart = 1e-6;
/// What stands for a value that has never moved.
constexpr double kStill = 1e-9;

double dot(const Eigen::VectorXd &shape, const double *modal) {
    double sum = 0.0;
    for (Eigen::Index i = 0; i < shape.size(); ++i) {
        sum += shape[i] * modal[i];
    }
    return sum;
}

void add_scaled(const Eigen::VectorXd &shape, double factor, double *modal) {
    for (Eigen::Index i = 0; i < shape.size(); ++i) {
        modal[i] += factor * shape[i];
    }
}

void widen(double &largest, double value) {
    largest = std::max(largest, std::abs(value));
}

double step_over(double largest) {
    return kPart * std::max(largest, kStill);
}

/// Slope of value() by x, which is given back as it was.
template <typename Value>
double slope(double &x, double low, double high, Value &&value) {
    const double before = x;
    x = high;
    const double above = value();
    x = low;
    const double below = value();
    x = before;
    return (above - below) / (high - low);
}

template <typename Value>
double slope_about(double &x, double step, Value &&value) {
    return slope(x, x - step, x + step, value);
}

} // namespace

RatesPullback::RatesPullback(const PlantModel &model)
    : model_(model), modes_(static_cast<std::size_t>(model.structure.mode_count())),
      state_count_(2 * modes_) {
    std::size_t most = 0;
    for (const PlantDamper &one : model_.dampers) {
        first_state_.push_back(state_count_);
        state_count_ += one.damper->state_count();
        most = std::max(most, one.damper->state_count());
    }
    state_.resize(most);
    rates_.resize(most);
}

Reached RatesPullback::nothing_reached() const {
    const std::vector<double> of_strokes(model_.dampers.size() + model_.mounts.size(), 0.0);
    return {std::vector<double>(state_count_, 0.0), of_strokes, of_strokes};
}

void RatesPullback::reach(const std::vector<double> &y, Reached &reached) const {
    for (std::size_t i = 0; i < state_count_; ++i) {
        widen(reached.state[i], y[i]);
    }
    std::size_t at = 0;
    const auto of = [&](const Eigen::VectorXd &shape) {
        widen(reached.stroke_m[at], dot(shape, y.data()));
        widen(reached.speed_m_s[at], dot(shape, y.data() + modes_));
        ++at;
    };
    for (const PlantDamper &one : model_.dampers) {
        of(one.stroke);
    }
    for (const PlantMount &one : model_.mounts) {
        of(one.stroke);
    }
}

void RatesPullback::add_structure(const std::vector<double> &of_rates,
                                  std::vector<double> &of_state) const {
    const Structure &structure = model_.structure;
    for (std::size_t i = 0; i < modes_; ++i) {
        const auto mode = static_cast<Eigen::Index>(i);
        const double of_accel = of_rates[modes_ + i];
        of_state[i] -= structure.omega2_rad2_s2[mode] * of_accel;
        of_state[modes_ + i] += of_rates[i];
        for (std::size_t j = 0; j < modes_; ++j) {
            const double damping_1_s = structure.damping_1_s(mode, static_cast<Eigen::Index>(j));
            of_state[modes_ + j] -= damping_1_s * of_accel;
        }
    }
}

void RatesPullback::add_mount(const PlantMount &one, double stroke_step_m, double speed_step_m_s,
                              const std::vector<double> &y, const std::vector<double> &of_rates,
                              std::vector<double> &of_state) const {
    const double of_force = -dot(one.stroke, of_rates.data() + modes_);
    double stroke_m = dot(one.stroke, y.data());
    double speed_m_s = dot(one.stroke, y.data() + modes_);
    const auto force = [&] { return one.mount->force_N(stroke_m, speed_m_s); };
    const double per_m = slope_about(stroke_m, stroke_step_m, force);
    const double per_m_s = slope_about(speed_m_s, speed_step_m_s, force);
    add_scaled(one.stroke, of_force * per_m, of_state.data());
    add_scaled(one.stroke, of_force * per_m_s, of_state.data() + modes_);
}

void RatesPullback::add_damper(std::size_t k, const PullbackPlace &at, const PullbackWeights &of,
                               const PullbackSlopes &slopes) {
    const PlantDamper &one = model_.dampers[k];
    const std::size_t first = first_state_[k];
    const std::size_t count = one.damper->state_count();
    const double of_all_force = of.force[k] - dot(one.stroke, of.rates.data() + modes_);
    std::copy_n(at.y.begin() + static_cast<std::ptrdiff_t>(first), count, state_.begin());
    DamperInput input{dot(one.stroke, at.y.data() + modes_), dot(one.stroke, at.y.data()),
                      at.current_A[k]};
    const auto sum = [&] {
        double out = of_all_force * one.damper->force_N(input, state_.data(), rates_.data());
        for (std::size_t i = 0; i < count; ++i) {
            out += of.rates[first + i] * rates_[i];
        }
        return out;
    };
    const double per_m = slope_about(input.position_m, step_over(at.reached.stroke_m[k]), sum);
    const double per_m_s = slope_about(input.velocity_m_s, step_over(at.reached.speed_m_s[k]), sum);
    add_scaled(one.stroke, per_m, slopes.state.data());
    add_scaled(one.stroke, per_m_s, slopes.state.data() + modes_);
    for (std::size_t i = 0; i < count; ++i) {
        const double step = step_over(at.reached.state[first + i]);
        slopes.state[first + i] += slope_about(state_[i], step, sum);
    }
    // There is no current below 0.
    const double step_A = kPart * model_.driver.max_current_A;
    const double now_A = at.current_A[k];
    slopes.current[k] += slope(input.current_A, std::max(now_A - step_A, 0.0), now_A + step_A, sum);
}

void RatesPullback::add(const PullbackPlace &at, const PullbackWeights &of,
                        const PullbackSlopes &slopes) {
    add_structure(of.rates, slopes.state);
    for (std::size_t k = 0; k < model_.dampers.size(); ++k) {
        add_damper(k, at, of, slopes);
    }
    for (std::size_t j = 0; j < model_.mounts.size(); ++j) {
        const std::size_t k = model_.dampers.size() + j;
        add_mount(model_.mounts[j], step_over(at.reached.stroke_m[k]),
                  step_over(at.reached.speed_m_s[k]), at.y, of.rates, slopes.state);
    }
}

} // namespace quiesce
