/// Plants with several dampers between places, against closed forms and direct integration.
#include <gtest/gtest.h>

#include <Eigen/Cholesky>

#include <algorithm>
#include <cmath>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "impulse_segment.h"
#include "input_error.h"
#include "periodic_orbit.h"
#include "plant.h"
#include "plant_file.h"
#include "plant_library.h"
#include "record_segment.h"
#include "sine_segment.h"
#include "viscous.h"

namespace {

using quiesce::ActuatorFault;
using quiesce::Damper;
using quiesce::DamperTruth;
using quiesce::Excitation;
using quiesce::Matrices;
using quiesce::PlaceTruth;
using quiesce::Plant;
using quiesce::PlantDamper;
using quiesce::PlantModel;

const char *const kTwoStoreys = "sim_hil/data/plants/two_storeys.toml";
constexpr int kTickRate_Hz = 1000;
constexpr std::size_t kFloor = 0;
constexpr std::size_t kRoof = 1;
constexpr std::size_t kLower = 0;
constexpr std::size_t kUpper = 1;

PlantModel two_storeys() {
    return quiesce::load_plant(kTwoStoreys);
}

std::shared_ptr<const Damper> viscous(double base_N_s_m, double per_A_N_s_m) {
    return std::make_shared<quiesce::Viscous>(
        quiesce::ViscousParams{base_N_s_m, per_A_N_s_m, 100.0});
}

/// A drag that lags behind the velocity: a damper with a state, which is its force.
class Lagging final : public Damper {
  public:
    Lagging(double coefficient_N_s_m, double lag_s) : c_N_s_m_(coefficient_N_s_m), lag_s_(lag_s) {}

    std::size_t state_count() const override { return 1; }
    double force_N(const quiesce::DamperInput &input, const double *state,
                   double *rates) const override {
        rates[0] = (c_N_s_m_ * input.velocity_m_s - state[0]) / lag_s_;
        return state[0];
    }
    double stiffest_N_s_m(double /*current_A*/) const override { return c_N_s_m_; }
    double fastest_rate_1_s(double /*current_A*/) const override { return 1.0 / lag_s_; }
    double lowest_position_m() const override { return -1.0; }

  private:
    double c_N_s_m_;
    double lag_s_;
};

/// Its force is how often it was told that a step ended, in this unit.
class Counting final : public Damper {
  public:
    explicit Counting(double unit_N) : unit_N_(unit_N) {}

    std::size_t state_count() const override { return 1; }
    double force_N(const quiesce::DamperInput & /*input*/, const double *state,
                   double *rates) const override {
        rates[0] = 0.0;
        return unit_N_ * state[0];
    }
    double stiffest_N_s_m(double /*current_A*/) const override { return 0.0; }
    void after_step(const quiesce::DamperInput & /*input*/, double *state,
                    double /*dt_s*/) const override {
        state[0] += 1.0;
    }
    bool is_sampled() const override { return true; }
    double lowest_position_m() const override { return -1.0; }

  private:
    double unit_N_;
};

Excitation sine(const PlantModel &model, double freq_Hz) {
    Excitation excitation;
    excitation.append(std::make_unique<quiesce::SineSegment>(model.shaker, freq_Hz), 1e5);
    return excitation;
}

Excitation blow(double impulse_N_s) {
    Excitation excitation;
    excitation.append(std::make_unique<quiesce::ImpulseSegment>(impulse_N_s, 0.02), 1e5);
    return excitation;
}

/// Runs these ticks with the same command for all dampers; each is seen after it ended.
void run(
    Plant &plant, std::size_t dampers, int ticks, double current_A,
    const std::function<void()> &see = [] {}) {
    for (int tick = 0; tick < ticks; ++tick) {
        for (std::size_t k = 0; k < dampers; ++k) {
            plant.command(k, current_A, ActuatorFault::none);
        }
        plant.advance();
        see();
    }
}

/// Displacements of a place, tick by tick, while a sine shakes the plant for 2 s.
std::vector<double> motion_m(const PlantModel &model, std::size_t place) {
    const Excitation excitation = sine(model, 4.0);
    Plant plant(model, excitation, kTickRate_Hz);
    std::vector<double> out;
    run(plant, model.dampers.size(), 2000, 1.3,
        [&] { out.push_back(plant.place(place).displacement_m); });
    return out;
}

void expect_same(const std::vector<double> &a, const std::vector<double> &b) {
    double largest = 0.0;
    double difference = 0.0;
    ASSERT_EQ(a.size(), b.size());
    for (std::size_t i = 0; i < a.size(); ++i) {
        largest = std::max(largest, std::abs(a[i]));
        difference = std::max(difference, std::abs(a[i] - b[i]));
    }
    EXPECT_GT(largest, 1e-4);
    EXPECT_LT(difference, 1e-11 * largest);
}

TEST(SeveralDampers, two_equal_ones_at_the_same_ends_are_one_of_twice_the_force) {
    PlantModel one = two_storeys();
    one.dampers = {one.dampers[kUpper]};
    PlantModel two = one;
    one.dampers[0].damper = viscous(16.0, 40.0);
    two.dampers[0].damper = viscous(8.0, 20.0);
    two.dampers.push_back(two.dampers[0]);
    expect_same(motion_m(two, kRoof), motion_m(one, kRoof));
    EXPECT_DOUBLE_EQ(quiesce::longest_safe_step_s(two), quiesce::longest_safe_step_s(one));
}

TEST(SeveralDampers, two_equal_ones_with_states_are_one_of_twice_the_force) {
    PlantModel one = two_storeys();
    one.dampers = {one.dampers[kLower]};
    PlantModel two = one;
    one.dampers[0].damper = std::make_shared<Lagging>(120.0, 0.01);
    two.dampers[0].damper = std::make_shared<Lagging>(60.0, 0.01);
    two.dampers.push_back(two.dampers[0]);
    expect_same(motion_m(two, kFloor), motion_m(one, kFloor));
}

TEST(SeveralDampers, each_has_its_own_states_whatever_their_order) {
    PlantModel model = two_storeys();
    model.dampers[kLower].damper = std::make_shared<Lagging>(100.0, 0.02);
    model.dampers[kUpper].damper = std::make_shared<Lagging>(50.0, 0.005);
    PlantDamper stateless = model.dampers[kLower];
    stateless.damper = viscous(10.0, 5.0);
    model.dampers.insert(model.dampers.begin() + 1, stateless);
    PlantModel reversed = model;
    std::reverse(reversed.dampers.begin(), reversed.dampers.end());
    expect_same(motion_m(model, kRoof), motion_m(reversed, kRoof));
}

TEST(SeveralDampers, the_order_of_the_ends_is_only_the_sign_of_the_stroke) {
    const PlantModel model = two_storeys();
    PlantModel turned = model;
    turned.dampers[kUpper].stroke *= -1.0;
    expect_same(motion_m(model, kRoof), motion_m(turned, kRoof));
    const Excitation excitation = sine(model, 4.0);
    Plant plant(model, excitation, kTickRate_Hz);
    Plant other(turned, excitation, kTickRate_Hz);
    run(plant, 2, 700, 1.0);
    run(other, 2, 700, 1.0);
    EXPECT_NEAR(plant.damper(kUpper).stroke_m, -other.damper(kUpper).stroke_m, 1e-14);
    EXPECT_NEAR(plant.damper(kUpper).force_N, -other.damper(kUpper).force_N, 1e-9);
    EXPECT_GT(plant.damper(kUpper).force_N * plant.damper(kUpper).velocity_m_s, 0.0);
}

/// Two masses in space with nothing but dampers between them.
PlantModel free_masses() {
    PlantModel model = two_storeys();
    Matrices matrices;
    matrices.mass_kg = (Eigen::Matrix2d() << 2.0, 0.0, 0.0, 1.0).finished();
    matrices.stiffness_N_m = Eigen::Matrix2d::Zero();
    matrices.damping_N_s_m = Eigen::Matrix2d::Zero();
    matrices.force = Eigen::Vector2d(1.0, 0.0);
    matrices.sensor = Eigen::Vector2d(0.0, 1.0);
    matrices.base = Eigen::Vector2d::Ones();
    model.structure = quiesce::structure_from_matrices(matrices, 2);
    model.places[kFloor].shape = model.structure.shape_of(Eigen::Vector2d(1.0, 0.0));
    model.places[kRoof].shape = model.structure.shape_of(Eigen::Vector2d(0.0, 1.0));
    for (PlantDamper &one : model.dampers) {
        one.stroke = model.places[kRoof].shape - model.places[kFloor].shape;
        one.damper = viscous(3.0, 1.0);
    }
    return model;
}

TEST(SeveralDampers, between_two_places_conserve_momentum) {
    const PlantModel model = free_masses();
    constexpr double kImpulse_N_s = 0.6;
    const Excitation excitation = blow(kImpulse_N_s);
    Plant plant(model, excitation, kTickRate_Hz);
    const auto momentum_N_s = [&] {
        return 2.0 * plant.place(kFloor).velocity_m_s + 1.0 * plant.place(kRoof).velocity_m_s;
    };
    run(plant, 2, 20, 0.0);
    EXPECT_NEAR(momentum_N_s(), kImpulse_N_s, 1e-6);
    EXPECT_GT(plant.place(kFloor).velocity_m_s - plant.place(kRoof).velocity_m_s, 0.1);
    const double before_N_s = momentum_N_s();
    run(plant, 2, 3000, 0.0, [&] { ASSERT_NEAR(momentum_N_s(), before_N_s, 1e-13); });
    // 6 N s/m on a reduced mass of 2/3 kg: 27 time constants later they move as one.
    EXPECT_NEAR(plant.place(kFloor).velocity_m_s, 0.2, 1e-6);
    EXPECT_NEAR(plant.place(kRoof).velocity_m_s, 0.2, 1e-6);
    EXPECT_NEAR(plant.place(kFloor).accel_m_s2, 0.0, 1e-9);
}

TEST(SeveralDampers, a_force_through_a_damper_acts_where_its_stroke_is_measured) {
    // Reciprocity: what damper k does to the stroke of j is what j does to that of k.
    const PlantModel model = two_storeys();
    const Eigen::VectorXd &lower = model.dampers[kLower].stroke;
    const Eigen::VectorXd &upper = model.dampers[kUpper].stroke;
    const Eigen::Matrix2d mass = 20.0 * Eigen::Matrix2d::Identity();
    const Eigen::Vector2d in_lower(1.0, 0.0);
    const Eigen::Vector2d in_upper(-1.0, 1.0);
    EXPECT_NEAR(lower.dot(upper), in_lower.dot(mass.ldlt().solve(in_upper)), 1e-12);
    EXPECT_NEAR(lower.dot(lower), in_lower.dot(mass.ldlt().solve(in_lower)), 1e-12);
    EXPECT_NEAR(upper.dot(upper), in_upper.dot(mass.ldlt().solve(in_upper)), 1e-12);
}

/// The masses of two_storeys.toml themselves, with viscous dampers in place of its own.
struct Direct {
    Eigen::Matrix2d stiffness_N_m =
        (Eigen::Matrix2d() << 37200.0, -18600.0, -18600.0, 18600.0).finished();
    Eigen::Matrix2d damping_N_s_m = (Eigen::Matrix2d() << 16.62, -5.58, -5.58, 11.04).finished();
    double mass_kg = 20.0;

    void add(const Eigen::Vector2d &stroke, double coefficient_N_s_m) {
        damping_N_s_m += coefficient_N_s_m * stroke * stroke.transpose();
    }
    Eigen::Vector2d accel(const Eigen::Vector2d &x, const Eigen::Vector2d &v, double force_N,
                          double base_accel_m_s2) const {
        const Eigen::Vector2d load =
            Eigen::Vector2d(0.0, force_N) - damping_N_s_m * v - stiffness_N_m * x;
        return load / mass_kg - Eigen::Vector2d::Constant(base_accel_m_s2);
    }
};

/// One classical Runge-Kutta step from t_s.
void step(const Direct &direct, const Excitation &excitation, double t_s, double dt_s,
          Eigen::Vector2d &x, Eigen::Vector2d &v) {
    const double at_s[4] = {0.0, 0.5 * dt_s, 0.5 * dt_s, dt_s};
    const double weight[4] = {1.0 / 6.0, 1.0 / 3.0, 1.0 / 3.0, 1.0 / 6.0};
    Eigen::Vector2d x_rate = Eigen::Vector2d::Zero();
    Eigen::Vector2d v_rate = Eigen::Vector2d::Zero();
    Eigen::Vector2d x_sum = Eigen::Vector2d::Zero();
    Eigen::Vector2d v_sum = Eigen::Vector2d::Zero();
    for (int stage = 0; stage < 4; ++stage) {
        const auto now = excitation.at(t_s + at_s[stage]);
        const Eigen::Vector2d x_now = x + at_s[stage] * x_rate;
        const Eigen::Vector2d v_now = v + at_s[stage] * v_rate;
        x_rate = v_now;
        v_rate = direct.accel(x_now, v_now, now.force_N, now.base_accel_m_s2);
        x_sum += weight[stage] * x_rate;
        v_sum += weight[stage] * v_rate;
    }
    x += dt_s * x_sum;
    v += dt_s * v_sum;
}

PlantModel with_viscous_dampers(double lower_N_s_m, double upper_N_s_m) {
    PlantModel model = two_storeys();
    model.dampers[kLower].damper = viscous(lower_N_s_m, 0.0);
    model.dampers[kUpper].damper = viscous(upper_N_s_m, 0.0);
    model.max_step_s = 1e-3;
    return model;
}

void expect_places_of(const Direct &direct, const PlantModel &model, const Excitation &excitation) {
    Plant plant(model, excitation, kTickRate_Hz);
    Eigen::Vector2d x = Eigen::Vector2d::Zero();
    Eigen::Vector2d v = Eigen::Vector2d::Zero();
    double largest_m = 0.0;
    for (int tick = 0; tick < 1500; ++tick) {
        step(direct, excitation, 1e-3 * tick, 1e-3, x, v);
        plant.advance();
        const auto now = excitation.at(1e-3 * (tick + 1));
        const Eigen::Vector2d absolute_m_s2 = direct.accel(x, v, now.force_N, now.base_accel_m_s2) +
                                              Eigen::Vector2d::Constant(now.base_accel_m_s2);
        for (const std::size_t i : {kFloor, kRoof}) {
            const PlaceTruth place = plant.place(i);
            const auto at = static_cast<Eigen::Index>(i);
            ASSERT_NEAR(place.displacement_m, x[at], 1e-12) << tick;
            ASSERT_NEAR(place.velocity_m_s, v[at], 1e-11) << tick;
            ASSERT_NEAR(place.accel_m_s2, absolute_m_s2[at], 1e-9) << tick;
        }
        const DamperTruth upper = plant.damper(kUpper);
        ASSERT_NEAR(upper.stroke_m, x[1] - x[0], 1e-12) << tick;
        ASSERT_NEAR(upper.velocity_m_s, v[1] - v[0], 1e-11) << tick;
        ASSERT_NEAR(plant.damper(kLower).stroke_m, x[0], 1e-12) << tick;
        largest_m = std::max(largest_m, x.norm());
    }
    EXPECT_GT(largest_m, 1e-3);
}

TEST(SeveralDampers, places_move_as_the_masses_integrated_directly) {
    const PlantModel model = with_viscous_dampers(30.0, 70.0);
    Direct direct;
    direct.add(Eigen::Vector2d(1.0, 0.0), 30.0);
    direct.add(Eigen::Vector2d(-1.0, 1.0), 70.0);
    {
        SCOPED_TRACE("shaken at the roof");
        expect_places_of(direct, model, sine(model, 5.0));
    }
    SCOPED_TRACE("shaken at the base");
    Excitation record;
    const std::vector<quiesce::RecordPoint> points = {
        {0.0, 0.0}, {0.2, 3.0}, {0.5, -2.0}, {1.1, 1.5}, {3.0, 0.0}};
    record.append(std::make_unique<quiesce::RecordSegment>(points, 1.0, 1.0), 1e5);
    expect_places_of(direct, model, record);
}

TEST(SeveralDampers, take_together_what_the_structure_loses) {
    PlantModel model = two_storeys();
    model.max_step_s = 1e-4;
    const Excitation excitation = blow(6.0);
    constexpr int kRate_Hz = 10000;
    Plant plant(model, excitation, kRate_Hz);
    const Direct direct;
    double taken_J[2] = {};
    double damping_J = 0.0;
    const auto velocity = [&] {
        return Eigen::Vector2d(plant.place(kFloor).velocity_m_s, plant.place(kRoof).velocity_m_s);
    };
    const auto energy_J = [&] {
        const Eigen::Vector2d x(plant.place(kFloor).displacement_m,
                                plant.place(kRoof).displacement_m);
        return 0.5 * direct.mass_kg * velocity().squaredNorm() +
               0.5 * x.dot(direct.stiffness_N_m * x);
    };
    run(plant, 2, 200, 0.7); // the blow is over
    const double before_J = energy_J();
    run(plant, 2, kRate_Hz, 0.7, [&] {
        for (const std::size_t k : {kLower, kUpper}) {
            const DamperTruth now = plant.damper(k);
            taken_J[k] += now.force_N * now.velocity_m_s / kRate_Hz;
        }
        damping_J += velocity().dot(direct.damping_N_s_m * velocity()) / kRate_Hz;
    });
    const double lost_J = before_J - energy_J();
    EXPECT_GT(before_J, 0.5);
    EXPECT_GT(taken_J[kLower], 0.1 * lost_J);
    EXPECT_GT(taken_J[kUpper], 0.1 * lost_J);
    EXPECT_GT(damping_J, 0.01 * lost_J);
    EXPECT_NEAR(taken_J[kLower] + taken_J[kUpper] + damping_J, lost_J, 1e-3 * lost_J);
}

TEST(SeveralDampers, each_follows_its_own_command_and_coil) {
    PlantModel model = two_storeys();
    model.dampers[kUpper].coil = {0.020, 0.020, 0.1};
    const Excitation excitation = sine(model, 3.0);
    Plant plant(model, excitation, kTickRate_Hz);
    for (int tick = 0; tick < 10; ++tick) {
        plant.command(kLower, 2.0, ActuatorFault::none);
        plant.command(kUpper, 1.0, ActuatorFault::none);
        plant.advance();
    }
    const double full_A = quiesce::CurrentDriver(model.driver).output_A(1.0);
    EXPECT_NEAR(plant.damper(kLower).coil_A, 2.0 * (1.0 - std::exp(-1.0)), 1e-9);
    EXPECT_NEAR(plant.damper(kUpper).coil_A, full_A * (1.0 - std::exp(-0.5)), 1e-9);
    EXPECT_EQ(plant.truth().coil_A, plant.damper(kLower).coil_A) << "the first one's";
    EXPECT_EQ(plant.truth().damper_force_N, plant.damper(kLower).force_N);
    EXPECT_EQ(plant.truth().damper_velocity_m_s, plant.damper(kLower).velocity_m_s);
}

TEST(SeveralDampers, a_fault_of_one_actuator_leaves_the_other) {
    const PlantModel model = two_storeys();
    const Excitation excitation = sine(model, 3.0);
    Plant plant(model, excitation, kTickRate_Hz);
    run(plant, 2, 200, 2.0);
    const double lower_N = plant.damper(kLower).force_N;
    plant.command(kUpper, 2.0, ActuatorFault::coil_open);
    EXPECT_EQ(plant.damper(kUpper).coil_A, 0.0);
    EXPECT_EQ(plant.damper(kLower).force_N, lower_N);
    for (int tick = 0; tick < 200; ++tick) {
        plant.command(kLower, 0.0, ActuatorFault::driver_stuck);
        plant.command(kUpper, 0.0, ActuatorFault::none);
        plant.advance();
    }
    EXPECT_NEAR(plant.damper(kLower).coil_A, 2.0, 1e-6);
    EXPECT_NEAR(plant.damper(kUpper).coil_A, 0.0, 1e-6);
}

TEST(SeveralDampers, each_is_told_when_a_step_ended) {
    PlantModel model = two_storeys();
    model.max_step_s = 1e-3;
    model.shaker.drive_V = 0.0;
    model.dampers[kLower].damper = std::make_shared<Counting>(1e-3);
    model.dampers[kUpper].damper = std::make_shared<Counting>(2e-3);
    const Excitation excitation = sine(model, 3.0);
    Plant plant(model, excitation, kTickRate_Hz);
    run(plant, 2, 50, 0.0);
    EXPECT_DOUBLE_EQ(plant.damper(kLower).force_N, 0.050);
    EXPECT_DOUBLE_EQ(plant.damper(kUpper).force_N, 0.100);
}

TEST(SeveralDampers, the_one_that_closes_is_named) {
    PlantModel model = two_storeys();
    model.shaker.drive_V = 20.0;
    model.dampers[kLower].damper = viscous(1.0, 0.0);
    const Excitation excitation = sine(model, 7.85);
    Plant plant(model, excitation, kTickRate_Hz);
    try {
        run(plant, 2, 10000, 0.0);
        FAIL() << "a stroke of more than 40 mm";
    } catch (const quiesce::InputError &error) {
        EXPECT_NE(std::string(error.what()).find("the damper upper closed to the end of its range"),
                  std::string::npos)
            << error.what();
    }
}

TEST(SeveralDampers, a_stiff_second_one_shortens_the_safe_step) {
    PlantModel model = two_storeys();
    const double before_s = quiesce::longest_safe_step_s(model);
    model.dampers[kUpper].damper = viscous(1e6, 0.0);
    EXPECT_LT(quiesce::longest_safe_step_s(model), 1e-2 * before_s);
    model.dampers[kUpper].damper = std::make_shared<Lagging>(1.0, 1e-6);
    EXPECT_NEAR(quiesce::longest_safe_step_s(model), 2e-6, 1e-12);
}

/// Half peak to peak of the roof in the last 2 s of 20.
double roof_amplitude_m(const PlantModel &model, double freq_Hz, double current_A) {
    const Excitation excitation = sine(model, freq_Hz);
    Plant plant(model, excitation, kTickRate_Hz);
    run(plant, 2, 18000, current_A);
    double high_m = 0.0;
    run(plant, 2, 2000, current_A,
        [&] { high_m = std::max(high_m, std::abs(plant.place(kRoof).displacement_m)); });
    return high_m;
}

TEST(TwoStoreys, are_damped_by_current_at_both_resonances) {
    const PlantModel model = two_storeys();
    const double first_m = roof_amplitude_m(model, 3.0, 0.0);
    const double second_m = roof_amplitude_m(model, 7.85, 0.0);
    EXPECT_GT(first_m, 0.02);
    EXPECT_GT(second_m, 5e-4);
    EXPECT_LT(roof_amplitude_m(model, 3.0, 1.0), 0.7 * first_m);
    EXPECT_LT(roof_amplitude_m(model, 3.0, 2.0), 0.3 * first_m);
    EXPECT_LT(roof_amplitude_m(model, 7.85, 2.0), 0.3 * second_m);
}

TEST(SeveralDampers, are_refused_where_one_is_expected) {
    EXPECT_THROW(quiesce::PeriodicOrbit(two_storeys(), {3.0, 1.0, 10, false}), quiesce::InputError);
    char error[300] = "";
    EXPECT_EQ(quiesce_plant_load(kTwoStoreys, error, sizeof error), nullptr);
    EXPECT_STREQ(error, "plant two_storeys has 2 dampers; this works on plants with one");
}

} // namespace
