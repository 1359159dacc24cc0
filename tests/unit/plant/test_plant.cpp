#include "plant.h"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <Eigen/LU>

#include <algorithm>
#include <cmath>
#include <complex>

#include "impulse_segment.h"
#include "input_error.h"
#include "plant_file.h"
#include "record_segment.h"
#include "sine_segment.h"
#include "switched_stiffness.h"
#include "viscous.h"

namespace {

using quiesce::ActuatorFault;
using quiesce::Excitation;
using quiesce::Matrices;
using quiesce::Plant;
using quiesce::PlantModel;
using quiesce::PlantTruth;

constexpr double kTwoPi = 6.28318530717958647692;

Excitation sine(const PlantModel &model, double freq_Hz) {
    Excitation excitation;
    excitation.append(std::make_unique<quiesce::SineSegment>(model.shaker, freq_Hz), 1e5);
    return excitation;
}

/// Two masses whose damping couples the modes, with a viscous damper of 0.5 + 2 I N s/m.
Matrices coupled_matrices() {
    Matrices out;
    out.mass_kg = (Eigen::Matrix2d() << 2.0, 0.0, 0.0, 1.0).finished();
    out.stiffness_N_m = (Eigen::Matrix2d() << 3000.0, -1000.0, -1000.0, 1500.0).finished();
    out.damping_N_s_m = (Eigen::Matrix2d() << 6.0, -1.0, -1.0, 1.0).finished();
    out.force = Eigen::Vector2d(1.0, 0.0);
    out.sensor = Eigen::Vector2d(0.0, 1.0);
    out.base = Eigen::Vector2d::Ones();
    return out;
}

/// Of the damper, between the masses.
const Eigen::Vector2d kStroke(-1.0, 1.0);

void take(PlantModel &model, const Matrices &matrices) {
    model.structure = quiesce::structure_from_matrices(matrices, 2);
    model.dampers[0].stroke = model.structure.shape_of(kStroke);
}

PlantModel coupled_plant() {
    PlantModel model = quiesce::load_plant("sim_hil/data/plants/squeeze_2012.toml");
    take(model, coupled_matrices());
    model.dampers[0].damper =
        std::make_shared<quiesce::Viscous>(quiesce::ViscousParams{0.5, 2.0, 1.0});
    model.shaker = {1.0, 10.0, 0.0, 1.0};
    return model;
}

/// Amplitude at the sensor for 1 N, from the complex equations of motion.
double closed_form_amplitude_m(double freq_Hz, double damper_N_s_m, double damper_N_m = 0.0) {
    const Matrices m = coupled_matrices();
    const double omega = kTwoPi * freq_Hz;
    const Eigen::MatrixXcd dynamic =
        (m.stiffness_N_m + damper_N_m * kStroke * kStroke.transpose() - omega * omega * m.mass_kg)
            .cast<std::complex<double>>() +
        std::complex<double>(0.0, omega) *
            (m.damping_N_s_m + damper_N_s_m * kStroke * kStroke.transpose());
    const Eigen::VectorXcd motion =
        dynamic.partialPivLu().solve(m.force.cast<std::complex<double>>());
    return std::abs(m.sensor.cast<std::complex<double>>().dot(motion));
}

double simulated_amplitude_m(const PlantModel &model, double freq_Hz, double current_A) {
    const Excitation excitation = sine(model, freq_Hz);
    Plant plant(model, excitation, 1000);
    double high_m = 0.0;
    for (int tick = 0; tick < 40000; ++tick) {
        plant.command(0, current_A, ActuatorFault::none);
        for (const PlantTruth &step : plant.advance()) {
            high_m = tick < 38000 ? 0.0 : std::max(high_m, step.displacement_m);
        }
    }
    return high_m;
}

TEST(Plant, steady_state_is_the_closed_form_of_a_linear_plant) {
    const PlantModel model = coupled_plant();
    ASSERT_FALSE(model.structure.is_proportional);
    const double current_A = quiesce::CurrentDriver(model.driver).output_A(1.5);
    for (const double freq_Hz : {3.0, 5.2, 7.1}) {
        const double expected = closed_form_amplitude_m(freq_Hz, 0.5 + 2.0 * current_A);
        EXPECT_NEAR(simulated_amplitude_m(model, freq_Hz, current_A) / expected, 1.0, 5e-4)
            << freq_Hz << " Hz";
    }
}

/// Displacements at 100 Hz over half a second.
std::vector<double> displacements_m(double step_s) {
    PlantModel model = coupled_plant();
    model.max_step_s = step_s;
    const Excitation excitation = sine(model, 6.0);
    Plant plant(model, excitation, 100);
    std::vector<double> out;
    for (int tick = 0; tick < 50; ++tick) {
        plant.advance();
        out.push_back(plant.truth().displacement_m);
    }
    return out;
}

double largest_difference_m(const std::vector<double> &a, const std::vector<double> &b) {
    double largest = 0.0;
    for (std::size_t i = 0; i < a.size(); ++i) {
        largest = std::max(largest, std::abs(a[i] - b[i]));
    }
    return largest;
}

TEST(Plant, integration_error_falls_with_the_fourth_power_of_the_step) {
    const std::vector<double> exact = displacements_m(5e-5);
    const double coarse_m = largest_difference_m(displacements_m(2e-3), exact);
    const double fine_m = largest_difference_m(displacements_m(1e-3), exact);
    EXPECT_NEAR(std::log2(coarse_m / fine_m), 4.0, 0.3);
}

TEST(Plant, stays_at_rest_without_drive) {
    PlantModel model = coupled_plant();
    model.shaker.drive_V = 0.0;
    const Excitation excitation = sine(model, 10.0);
    Plant plant(model, excitation, 1000);
    for (int tick = 0; tick < 100; ++tick) {
        plant.advance();
    }
    EXPECT_EQ(plant.truth().displacement_m, 0.0);
    EXPECT_EQ(plant.truth().accel_m_s2, 0.0);
    EXPECT_EQ(plant.tick(), 100);
}

TEST(Plant, acceleration_is_the_second_derivative_of_displacement) {
    const PlantModel model = quiesce::load_plant("sim_hil/data/plants/squeeze_2012.toml");
    const Excitation excitation = sine(model, 10.0);
    Plant plant(model, excitation, 1000);
    std::vector<PlantTruth> steps;
    for (int tick = 0; tick < 1000; ++tick) {
        const std::vector<PlantTruth> &last = plant.advance();
        steps.insert(steps.end(), last.begin(), last.end());
    }
    const double dt_s = plant.step_s();
    for (std::size_t i = 1500; i < 1600; ++i) {
        const double second = (steps[i + 1].displacement_m - 2.0 * steps[i].displacement_m +
                               steps[i - 1].displacement_m) /
                              (dt_s * dt_s);
        ASSERT_NEAR(second, steps[i].accel_m_s2, 0.01 * 0.6);
    }
}

TEST(Plant, coil_follows_the_driver_with_its_lag) {
    const PlantModel model = quiesce::load_plant("sim_hil/data/plants/squeeze_2012.toml");
    const Excitation excitation = sine(model, 10.0);
    Plant plant(model, excitation, 1000);
    for (int tick = 0; tick < 5; ++tick) {
        plant.command(0, 5.0, ActuatorFault::none);
        plant.advance();
    }
    EXPECT_NEAR(plant.truth().coil_A, 5.0 * (1.0 - std::exp(-1.0)), 1e-9);
}

TEST(Plant, open_coil_carries_no_current_and_stuck_driver_keeps_it) {
    const PlantModel model = quiesce::load_plant("sim_hil/data/plants/squeeze_2012.toml");
    const Excitation excitation = sine(model, 10.0);
    Plant plant(model, excitation, 1000);
    for (int tick = 0; tick < 200; ++tick) {
        plant.command(0, tick < 100 ? 4.0 : 0.0,
                      tick < 100 ? ActuatorFault::none : ActuatorFault::driver_stuck);
        plant.advance();
    }
    EXPECT_NEAR(plant.truth().coil_A, 4.0, 1e-3);
    plant.command(0, 4.0, ActuatorFault::coil_open);
    EXPECT_EQ(plant.truth().coil_A, 0.0);
    plant.advance();
    EXPECT_EQ(plant.truth().coil_A, 0.0);
}

TEST(Plant, remanence_keeps_force_when_the_current_is_gone) {
    PlantModel model = coupled_plant();
    model.dampers[0].coil = {0.005, 0.005, 0.05};
    const Excitation excitation = sine(model, 5.0);
    Plant plant(model, excitation, 1000);
    const auto coefficient_N_s_m = [&plant] {
        return plant.truth().damper_force_N / plant.truth().damper_velocity_m_s;
    };
    for (int tick = 0; tick < 2000; ++tick) {
        plant.command(0, tick < 1000 ? 4.0 : 0.0, ActuatorFault::none);
        plant.advance();
        if (tick == 999) {
            EXPECT_NEAR(coefficient_N_s_m(), 0.5 + 2.0 * 4.0, 0.01);
        }
    }
    EXPECT_NEAR(plant.truth().coil_A, 0.0, 1e-9) << "what is measured is the coil's current";
    EXPECT_NEAR(coefficient_N_s_m(), 0.5 + 2.0 * 0.05 * 5.0, 1e-9) << "5 % of 5 A stay";
    plant.command(0, 4.0, ActuatorFault::none);
    plant.advance();
    plant.command(0, 0.0, ActuatorFault::coil_open);
    EXPECT_NEAR(coefficient_N_s_m(), 0.5 + 2.0 * 0.05 * 5.0, 1e-9) << "an open coil, too";
}

TEST(Plant, switched_stiffness_at_a_constant_current_is_a_spring) {
    PlantModel model = coupled_plant();
    model.dampers[0].damper = std::make_shared<quiesce::SwitchedStiffness>(
        quiesce::SwitchedStiffnessParams{0.5, 2.0, 200.0, 100.0, 1.0});
    const double current_A = quiesce::CurrentDriver(model.driver).output_A(1.5);
    for (const double freq_Hz : {3.0, 5.2, 7.1}) {
        const double expected =
            closed_form_amplitude_m(freq_Hz, 0.5 + 2.0 * current_A, 200.0 + 100.0 * current_A);
        EXPECT_NEAR(simulated_amplitude_m(model, freq_Hz, current_A) / expected, 1.0, 5e-4)
            << freq_Hz << " Hz";
    }
}

TEST(Plant, a_stiffness_in_the_damper_shortens_the_safe_step) {
    PlantModel model = coupled_plant();
    const double without_s = quiesce::longest_safe_step_s(model);
    model.dampers[0].damper = std::make_shared<quiesce::SwitchedStiffness>(
        quiesce::SwitchedStiffnessParams{0.5, 2.0, 0.0, 1e6, 1.0});
    EXPECT_LT(quiesce::longest_safe_step_s(model), 0.1 * without_s);
}

TEST(Plant, stops_where_the_plates_touch) {
    PlantModel model = quiesce::load_plant("sim_hil/data/plants/squeeze_2012.toml");
    model.shaker.drive_V = 5.0;
    const Excitation excitation = sine(model, 11.5);
    Plant plant(model, excitation, 1000);
    try {
        for (int tick = 0; tick < 5000; ++tick) {
            plant.advance();
        }
        FAIL() << "7 mm in a gap of 2 mm";
    } catch (const quiesce::InputError &error) {
        EXPECT_NE(std::string(error.what()).find("reduce shaker.drive_V"), std::string::npos)
            << error.what();
    }
}

TEST(Plant, stops_when_the_integration_diverges) {
    PlantModel model = coupled_plant();
    model.structure = quiesce::structure_from_modes({{1500.0, 0.01, 1.0, 1.0}});
    model.dampers[0].stroke = Eigen::VectorXd::Zero(1);
    model.max_step_s = 1e-3;
    EXPECT_GT(model.max_step_s, quiesce::longest_safe_step_s(model));
    const Excitation excitation = sine(model, 10.0);
    Plant plant(model, excitation, 1000);
    EXPECT_THROW(
        {
            for (int tick = 0; tick < 2000; ++tick) {
                plant.advance();
            }
        },
        quiesce::InputError);
}

PlantTruth after(const PlantModel &model, const Excitation &excitation, int ticks) {
    Plant plant(model, excitation, 1000);
    for (int tick = 0; tick < ticks; ++tick) {
        plant.advance();
    }
    return plant.truth();
}

Excitation record(std::vector<quiesce::RecordPoint> points) {
    Excitation excitation;
    excitation.append(std::make_unique<quiesce::RecordSegment>(std::move(points), 1.0, 1.0), 1e5);
    return excitation;
}

TEST(Plant, a_slow_ramp_of_the_bases_acceleration_bends_it_like_a_static_load) {
    // After 60 s of ramp nothing rings any more. K q = -M base a, less what the ramp's velocity
    // adds through the damping: K q' = -M base a' is constant.
    const PlantModel model = coupled_plant();
    const Matrices m = coupled_matrices();
    constexpr double kEnd_m_s2 = 2.0;
    const PlantTruth truth =
        after(model, record({{0.0, 0.0}, {60.0, kEnd_m_s2}, {61.0, 0.0}}), 60000);
    const Eigen::Vector2d load = -m.mass_kg * m.base;
    const Eigen::Vector2d velocity = m.stiffness_N_m.ldlt().solve(load) * (kEnd_m_s2 / 60.0);
    const Eigen::Matrix2d damping = m.damping_N_s_m + 0.5 * kStroke * kStroke.transpose();
    const Eigen::Vector2d static_m =
        m.stiffness_N_m.ldlt().solve(Eigen::Vector2d(load * kEnd_m_s2 - damping * velocity));
    EXPECT_NEAR(truth.displacement_m, static_m[1], 1e-9);
    EXPECT_NEAR(truth.accel_m_s2, kEnd_m_s2, 1e-6) << "the sensor rides on the base";
}

TEST(Plant, a_base_that_jumps_is_felt_at_once_by_the_sensor_alone) {
    // Free masses, the base not part of them: they stay where they are in space.
    PlantModel model = coupled_plant();
    Matrices matrices = coupled_matrices();
    matrices.stiffness_N_m.setZero();
    matrices.damping_N_s_m.setZero();
    take(model, matrices);
    const PlantTruth truth = after(model, record({{0.0, 3.0}, {1e3, 3.0}}), 1000);
    EXPECT_NEAR(truth.displacement_m, -0.5 * 3.0, 1e-9) << "the base moves away below";
    EXPECT_NEAR(truth.accel_m_s2, 0.0, 1e-9) << "at rest in space";
}

TEST(Plant, an_impulse_sets_a_free_mass_in_motion) {
    PlantModel model = coupled_plant();
    constexpr double kMass_kg = 2.5;
    const double shape = 1.0 / std::sqrt(kMass_kg);
    model.structure = quiesce::structure_from_modes({{0.001, 0.0, shape, shape}});
    model.dampers[0].stroke = Eigen::VectorXd::Constant(1, shape);
    model.dampers[0].damper =
        std::make_shared<quiesce::Viscous>(quiesce::ViscousParams{0.0, 0.0, 1.0});
    Excitation excitation;
    excitation.append(std::make_unique<quiesce::ImpulseSegment>(0.05, 0.004), 1e5);
    EXPECT_NEAR(after(model, excitation, 100).damper_velocity_m_s, 0.05 / kMass_kg, 2e-5);
}

TEST(Plant, steps_divide_the_tick) {
    PlantModel model = coupled_plant();
    model.max_step_s = 500e-6;
    EXPECT_EQ(quiesce::steps_per_tick(model, 1e-3), 2);
    EXPECT_EQ(quiesce::steps_per_tick(model, 250e-6), 1);
    model.max_step_s = 300e-6;
    EXPECT_EQ(quiesce::steps_per_tick(model, 1e-3), 4);
    model.max_step_s = 20e-6;
    EXPECT_EQ(quiesce::steps_per_tick(model, 1e-3), 50);
}

} // namespace
