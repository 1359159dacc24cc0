/// What holds for every kernel: its description, lanes, step bound, linearity, passivity.
#include <gtest/gtest.h>

#include <Eigen/Dense>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <memory>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "damper_motion.h"
#include "evaluator.h"
#include "kernel_models.h"

namespace {

using quiesce::CurrentLaw;
using quiesce::Damper;
using quiesce::DamperInput;
using quiesce::kernel_models;
using quiesce::KernelModel;
using quiesce::kRigCount;
using quiesce::Noise;
using quiesce::ParameterInfo;
using quiesce::Samples;
using quiesce::Scale;

constexpr double kForce_N = 1000.0;
constexpr double kDisp_m = 0.01;

/// Uniform in low .. high.
class Dice {
  public:
    explicit Dice(std::uint64_t seed) : bits_(seed) {}
    double operator()(double low, double high) {
        return low + (high - low) * static_cast<double>(bits_.bits() >> 11) * 0x1p-53;
    }

  private:
    Noise bits_;
};

/// Random motion of up to 20 mm with a current that rises in three steps.
Samples motion(std::uint64_t seed, int count, double current_A = 0.0) {
    Noise random(seed);
    Samples samples = quiesce::random_motion(0.005, random, count);
    for (std::size_t k = 0; k < samples.current.size(); ++k) {
        samples.current[k] = current_A * static_cast<double>(3 * k / samples.x.size()) / 2.0;
    }
    return samples;
}

/// NaN where there is one.
double largest(const std::vector<double> &values) {
    double most = 0.0;
    for (const double value : values) {
        most = std::abs(value) <= most ? most : std::abs(value);
        if (std::isnan(most)) {
            break;
        }
    }
    return most;
}

/// Forces of one constant set of parameters without a rig.
std::vector<double> forces(std::size_t model, const std::vector<double> &parameters,
                           const Samples &samples, int substeps) {
    const std::vector<int> orders(parameters.size(), 1);
    std::vector<double> row = parameters;
    row.resize(row.size() + kRigCount, 0.0);
    std::vector<double> force_N(samples.x.size());
    quiesce::simulate({model, orders.data(), row.data(), 1}, samples.grid(substeps), "scalar",
                      force_N.data());
    return force_N;
}

/// The lowest that the integral of F v dt ever gets, as a part of that of |F v|.
double lowest_energy(const Samples &samples, const std::vector<double> &force_N) {
    double energy_J = 0.0;
    double lowest_J = 0.0;
    double moved_J = 1e-300;
    for (std::size_t k = 1; k < force_N.size(); ++k) {
        const double power_W =
            0.5 * (force_N[k] * samples.v[k] + force_N[k - 1] * samples.v[k - 1]);
        energy_J += power_W * samples.step_s;
        moved_J += std::abs(power_W) * samples.step_s;
        lowest_J = std::min(lowest_J, energy_J);
    }
    return lowest_J / moved_J;
}

/// One test for each model, named after it.
class EveryKernel : public testing::TestWithParam<std::size_t> {
  protected:
    const KernelModel &model() const { return kernel_models()[GetParam()]; }
    const ParameterInfo &info(std::size_t k) const { return model().parameters[k]; }

    /// Within the search range for a damper of 1 kN over 10 mm at this speed.
    double drawn(std::size_t k, double speed_m_s, Dice &dice) const {
        const Scale &scale = info(k).scale;
        const double unit = std::pow(kForce_N, scale.force) * std::pow(kDisp_m, scale.disp) *
                            std::pow(speed_m_s, scale.speed);
        const double value = unit * dice(info(k).search_low, info(k).search_high);
        return std::min(std::max(value, info(k).min), info(k).max);
    }
    std::vector<double> draw(double speed_m_s, Dice &dice) const {
        std::vector<double> values;
        for (std::size_t k = 0; k < model().parameter_count; ++k) {
            values.push_back(drawn(k, speed_m_s, dice));
        }
        return values;
    }
    /// Smallest number of steps in a sample with which the step bound is kept.
    int substeps(const std::vector<double> &p, const Samples &samples, double speed_m_s) const {
        const double rate_1_s = model().fastest_rate_1_s(p.data(), speed_m_s);
        return 1 + static_cast<int>(samples.step_s * rate_1_s / 2.7);
    }
    std::vector<bool> linear_ones() const {
        std::vector<bool> linear;
        for (std::size_t k = 0; k < model().parameter_count; ++k) {
            linear.push_back(info(k).is_linear);
        }
        return linear;
    }
    bool is_offset(std::size_t k) const { return std::string(info(k).name) == "f0_N"; }
};

std::string name_of(const testing::TestParamInfo<std::size_t> &param) {
    return kernel_models()[param.param].name;
}

INSTANTIATE_TEST_SUITE_P(Damper, EveryKernel,
                         testing::Range(std::size_t{0}, kernel_models().size()), name_of);

TEST(Kernels, have_names_of_their_own) {
    std::set<std::string> names;
    for (const KernelModel &model : kernel_models()) {
        EXPECT_TRUE(names.insert(model.name).second) << model.name;
    }
}

TEST_P(EveryKernel, describes_itself) {
    EXPECT_STRNE(model().title, "");
    EXPECT_STRNE(model().source, "");
    EXPECT_LT(model().told_count, model().parameter_count);
    std::set<std::string> names;
    for (std::size_t k = 0; k < model().parameter_count; ++k) {
        const ParameterInfo &one = info(k);
        EXPECT_TRUE(names.insert(one.name).second) << one.name;
        EXPECT_STRNE(one.unit, "") << one.name;
        EXPECT_STRNE(one.text, "") << one.name;
        EXPECT_LT(one.min, one.max) << one.name;
        EXPECT_LE(one.search_low, one.search_high) << one.name;
    }
}

TEST_P(EveryKernel, searches_where_parameters_are_admissible) {
    // From 85 N over 1 mm to 5 kN over 50 mm.
    for (const double size : {0.1, 5.0}) {
        for (std::size_t k = 0; k < model().parameter_count; ++k) {
            const Scale &scale = info(k).scale;
            const double unit = std::pow(850.0 * size, scale.force) *
                                std::pow(0.01 * size, scale.disp) *
                                std::pow(0.2 * size, scale.speed);
            EXPECT_LT(unit * info(k).search_low, info(k).max) << info(k).name;
            EXPECT_GE(unit * info(k).search_high, info(k).min) << info(k).name;
        }
    }
}

bool same_bits(double a, double b) {
    return std::memcmp(&a, &b, sizeof a) == 0 || (std::isnan(a) && std::isnan(b));
}

/// Rows for simulate(): parameters with `order` coefficients against the current, then the rig.
std::vector<double> with_laws(const std::vector<double> &p, int order, bool has_rig, Dice &dice) {
    std::vector<double> row;
    for (const double value : p) {
        row.push_back(value);
        for (int c = 1; c < order; ++c) {
            row.push_back(value * dice(-0.3, 0.3));
        }
    }
    // Lags, inertia, skew, offset, drift, then the field law.
    const double rig[kRigCount] = {dice(0.0, 0.02),   dice(0.0, 0.02),   dice(-1.0, 1.0),
                                   dice(-2e-3, 2e-3), dice(-50.0, 50.0), dice(-5.0, 5.0),
                                   dice(0.5, 2.0),    dice(0.0, 2.0),    1.0};
    for (const double value : rig) {
        row.push_back(has_rig ? value : 0.0);
    }
    return row;
}

/// How many of the forces of any set of instructions differ from those of one candidate at a time.
std::size_t different_forces(const quiesce::CandidateRows &candidates, const Samples &samples) {
    const quiesce::MotionGrid grid = samples.grid(3);
    std::vector<double> scalar(candidates.count * samples.x.size());
    quiesce::simulate(candidates, grid, "scalar", scalar.data());
    std::vector<double> lanes(scalar.size());
    std::size_t different = 0;
    for (const std::string &set : quiesce::instruction_sets()) {
        quiesce::simulate(candidates, grid, set, lanes.data());
        for (std::size_t k = 0; k < scalar.size(); ++k) {
            different += same_bits(scalar[k], lanes[k]) ? 0U : 1U;
        }
    }
    return different;
}

TEST_P(EveryKernel, has_the_same_bits_in_every_lane) {
    constexpr std::size_t kRows = 37; // no multiple of any number of lanes
    const Samples samples = motion(1, 150, 1.5);
    Dice dice(7);
    for (const int order : {1, 3}) {
        for (const bool has_rig : {false, true}) {
            const std::vector<int> orders(model().parameter_count, order);
            std::vector<double> rows;
            for (std::size_t row = 0; row < kRows; ++row) {
                const std::vector<double> one =
                    with_laws(draw(samples.fastest_m_s(), dice), order, has_rig, dice);
                rows.insert(rows.end(), one.begin(), one.end());
            }
            EXPECT_EQ(different_forces({GetParam(), orders.data(), rows.data(), kRows}, samples),
                      0U)
                << "order " << order << ", rig " << has_rig;
        }
    }
}

TEST_P(EveryKernel, stays_bounded_just_below_its_step_bound) {
    Dice dice(11);
    for (std::uint64_t seed = 0; seed < 20; ++seed) {
        const Samples samples = motion(seed, 800);
        const double speed_m_s = samples.fastest_m_s();
        const std::vector<double> p = draw(speed_m_s, dice);
        const double most_N =
            largest(forces(GetParam(), p, samples, substeps(p, samples, speed_m_s)));
        EXPECT_LT(most_N, 1e4 * kForce_N) << "seed " << seed; // NaN fails too
    }
}

/// Forwards to a model and keeps the largest |eigenvalue| of its states' Jacobian that it sees.
class Stopwatch final : public Damper {
  public:
    explicit Stopwatch(std::shared_ptr<const Damper> model)
        : model_(std::move(model)), size_(model_->state_count(), 1e-9) {}

    std::size_t state_count() const override { return model_->state_count(); }
    double force_N(const DamperInput &input, const double *state, double *rates) const override {
        for (std::size_t k = 0; k < size_.size(); ++k) {
            size_[k] = std::max(size_[k], std::abs(state[k]));
        }
        if (++calls_ % 97 == 0) {
            look(input, state);
        }
        return model_->force_N(input, state, rates);
    }
    double stiffest_N_s_m(double current_A) const override {
        return model_->stiffest_N_s_m(current_A);
    }
    double lowest_position_m() const override { return model_->lowest_position_m(); }
    double fastest_1_s() const { return fastest_1_s_; }

  private:
    void look(const DamperInput &input, const double *state) const {
        const auto count = static_cast<Eigen::Index>(size_.size());
        Eigen::MatrixXd jacobian(count, count);
        for (Eigen::Index k = 0; k < count; ++k) {
            const double nudge = 1e-6 * size_[static_cast<std::size_t>(k)];
            jacobian.col(k) =
                (moved_rates(input, state, k, nudge) - moved_rates(input, state, k, -nudge)) /
                (2.0 * nudge);
        }
        fastest_1_s_ = std::max(fastest_1_s_, jacobian.eigenvalues().cwiseAbs().maxCoeff());
    }
    Eigen::VectorXd moved_rates(const DamperInput &input, const double *state, Eigen::Index k,
                                double nudge) const {
        std::vector<double> moved(state, state + size_.size());
        moved[static_cast<std::size_t>(k)] += nudge;
        Eigen::VectorXd rates(static_cast<Eigen::Index>(size_.size()));
        model_->force_N(input, moved.data(), rates.data());
        return rates;
    }

    std::shared_ptr<const Damper> model_;
    mutable std::vector<double> size_; ///< of each state so far
    mutable std::size_t calls_ = 0;
    mutable double fastest_1_s_ = 0.0;
};

TEST_P(EveryKernel, is_no_faster_than_it_says) {
    Dice dice(13);
    for (std::uint64_t seed = 0; seed < 12 && model().state_count > 0; ++seed) {
        const Samples samples = motion(seed, 300);
        const double speed_m_s = samples.fastest_m_s();
        const std::vector<double> p = draw(speed_m_s, dice);
        std::vector<CurrentLaw> laws;
        for (const double value : p) {
            laws.push_back({value, 0.0, 0.0});
        }
        const Stopwatch watched(model().make(laws.data(), 1.0, speed_m_s, {}, {}));
        run(watched, samples, substeps(p, samples, speed_m_s));
        EXPECT_GT(watched.fastest_1_s(), 0.0);
        EXPECT_LE(watched.fastest_1_s(), 1.05 * model().fastest_rate_1_s(p.data(), speed_m_s))
            << "seed " << seed;
    }
}

/// Forces at two values of the chosen parameters and half way: how far the latter is from the
/// mean, as a part of the largest force.
double bend(std::size_t model, std::vector<double> p, const std::vector<double> &other,
            const std::vector<bool> &chosen, const Samples &samples, int substeps) {
    const std::vector<double> from_N = forces(model, p, samples, substeps);
    std::vector<double> half = p;
    for (std::size_t k = 0; k < p.size(); ++k) {
        if (chosen[k]) {
            half[k] = 0.5 * (p[k] + other[k]);
            p[k] = other[k];
        }
    }
    const std::vector<double> to_N = forces(model, p, samples, substeps);
    const std::vector<double> half_N = forces(model, half, samples, substeps);
    std::vector<double> off_N(from_N.size());
    for (std::size_t k = 0; k < from_N.size(); ++k) {
        off_N[k] = half_N[k] - 0.5 * (from_N[k] + to_N[k]);
    }
    return largest(off_N) / (largest(from_N) + largest(to_N) + 1e-300);
}

TEST_P(EveryKernel, is_linear_in_the_parameters_it_says) {
    const std::vector<bool> linear = linear_ones();
    const Samples samples = motion(3, 300, 1.5);
    const double speed_m_s = samples.fastest_m_s();
    Dice dice(17);
    for (int draws = 0; draws < 10; ++draws) {
        const std::vector<double> p = draw(speed_m_s, dice);
        const std::vector<double> other = draw(speed_m_s, dice);
        const int steps = substeps(p, samples, speed_m_s);
        EXPECT_LT(bend(GetParam(), p, other, linear, samples, steps), 1e-9);
    }
}

TEST_P(EveryKernel, says_all_parameters_that_it_is_linear_in) {
    const std::vector<bool> linear = linear_ones();
    const Samples samples = motion(3, 300, 1.5);
    const double speed_m_s = samples.fastest_m_s();
    for (std::size_t k = 0; k < model().parameter_count; ++k) {
        if (linear[k] || info(k).search_low == info(k).search_high) {
            continue;
        }
        std::vector<bool> chosen = linear;
        chosen[k] = true;
        double most = 0.0;
        Dice dice(19);
        for (int draws = 0; draws < 10; ++draws) {
            const std::vector<double> p = draw(speed_m_s, dice);
            const std::vector<double> other = draw(speed_m_s, dice);
            const int steps =
                std::max(substeps(p, samples, speed_m_s), substeps(other, samples, speed_m_s));
            most = std::max(most, bend(GetParam(), p, other, chosen, samples, steps));
        }
        EXPECT_GT(most, 1e-6) << info(k).name;
    }
}

TEST_P(EveryKernel, gives_out_no_energy_where_it_says_so) {
    Dice dice(23);
    int checked = 0;
    for (std::uint64_t seed = 0; seed < 200 && checked < 20; ++seed) {
        const Samples samples = motion(seed, 1000);
        const double speed_m_s = samples.fastest_m_s();
        std::vector<double> p = draw(speed_m_s, dice);
        for (std::size_t k = 0; k < p.size(); ++k) {
            p[k] = is_offset(k) ? 0.0 : p[k];
        }
        if (!model().is_passive(p.data())) {
            continue;
        }
        ++checked;
        const int steps = 2 * substeps(p, samples, speed_m_s);
        EXPECT_GT(lowest_energy(samples, forces(GetParam(), p, samples, steps)), -2e-3)
            << "seed " << seed;
    }
}

} // namespace
