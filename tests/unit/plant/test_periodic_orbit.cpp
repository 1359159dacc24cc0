/// Orbits against long runs of the plant under the same driver output.
#include "periodic_orbit.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <numeric>
#include <string>

#include "excitation.h"
#include "input_error.h"
#include "plant.h"
#include "plant_file.h"
#include "plant_library.h"
#include "sine_segment.h"
#include "squeeze_biviscosity.h"

namespace {

using quiesce::Excitation;
using quiesce::OrbitCase;
using quiesce::PeriodicOrbit;
using quiesce::Plant;
using quiesce::PlantModel;

constexpr const char *kPlantFile = "sim_hil/data/plants/squeeze_2012.toml";
constexpr int kTickRate_Hz = 1000;

PlantModel published_plant() {
    PlantModel model = quiesce::load_plant(kPlantFile);
    model.driver.bits = 24; // orbits know no rounding of the current
    return model;
}

/// Full current in a part of the intervals.
std::vector<double> pulse(int intervals, int from, int to) {
    std::vector<double> command_A(static_cast<std::size_t>(intervals), 0.0);
    std::fill(command_A.begin() + from, command_A.begin() + to, 5.0);
    return command_A;
}

struct LastPeriod {
    double highest_m = -1.0;
    double lowest_m = 1.0;
    double accel_squares = 0.0;
    double coil_A = 0.0;
    int count = 0;

    void add(const quiesce::PlantTruth &now) {
        highest_m = std::max(highest_m, now.displacement_m);
        lowest_m = std::min(lowest_m, now.displacement_m);
        accel_squares += now.accel_m_s2 * now.accel_m_s2;
        coil_A += now.coil_A;
        ++count;
    }
};

/// Simulates 20 s; the command repeats after command_A.size() * ticks_each ticks.
LastPeriod long_run(const PlantModel &model, int freq_Hz, const std::vector<double> &command_A,
                    int ticks_each) {
    Excitation excitation;
    excitation.append(std::make_unique<quiesce::SineSegment>(model.shaker, freq_Hz), 1e5);
    Plant plant(model, excitation, kTickRate_Hz);
    LastPeriod last;
    const int ticks = 20 * kTickRate_Hz;
    for (int tick = 0; tick < ticks; ++tick) {
        const auto interval = static_cast<std::size_t>(tick / ticks_each) % command_A.size();
        plant.command(0, command_A[interval], quiesce::ActuatorFault::none);
        for (const quiesce::PlantTruth &now : plant.advance()) {
            if (tick >= ticks - kTickRate_Hz / freq_Hz) {
                last.add(now);
            }
        }
    }
    return last;
}

void expect_same_motion(const PlantModel &model, const OrbitCase &orbit_case,
                        const std::vector<double> &command_A) {
    PeriodicOrbit orbit(model, orbit_case);
    orbit.solve(command_A.data(), nullptr);
    const int freq_Hz = static_cast<int>(orbit_case.freq_Hz);
    const int covered = kTickRate_Hz / freq_Hz / (orbit_case.covers_period ? 1 : 2);
    const LastPeriod run = long_run(model, freq_Hz, command_A, covered / orbit_case.intervals);
    const Eigen::VectorXd &disp_m = orbit.period().disp_m;
    EXPECT_NEAR(disp_m.maxCoeff() / run.highest_m, 1.0, 1e-4);
    EXPECT_NEAR(disp_m.minCoeff() / run.lowest_m, 1.0, 1e-4);
    const double rms =
        std::sqrt(orbit.period().accel_m_s2.squaredNorm() / static_cast<double>(orbit.grid()));
    EXPECT_NEAR(rms / std::sqrt(run.accel_squares / run.count), 1.0, 2e-4);
    const std::vector<double> &coil_A = orbit.coil_half_steps_A();
    const double mean_A = std::accumulate(coil_A.begin(), coil_A.end() - 1, 0.0) /
                          static_cast<double>(coil_A.size() - 1);
    EXPECT_NEAR(mean_A, run.coil_A / run.count, 1e-3);
    EXPECT_LT(orbit.residual(), 1e-9);
}

TEST(PeriodicOrbit, equals_long_runs_with_a_pulse_below_resonance) {
    expect_same_motion(published_plant(), {5.0, 0.1, 50, false}, pulse(50, 10, 35));
}

TEST(PeriodicOrbit, equals_long_runs_with_a_pulse_above_resonance) {
    expect_same_motion(published_plant(), {20.0, 0.1, 25, false}, pulse(25, 3, 20));
}

TEST(PeriodicOrbit, equals_long_runs_on_a_base_that_moves) {
    PlantModel model = published_plant();
    model.shaker = {0.3, 10.0, 0.0, 1.0, true};
    model.max_step_s /= 4.0; // at the usual step 1.2e-4 apart
    expect_same_motion(model, {10.0, 1.0, 50, false}, pulse(50, 20, 40));
}

TEST(PeriodicOrbit, equals_long_runs_with_a_coil_that_falls_slowly) {
    PlantModel model = published_plant();
    model.dampers[0].coil = {0.004, 0.015};
    expect_same_motion(model, {10.0, 0.1, 50, false}, pulse(50, 20, 40));
}

TEST(PeriodicOrbit, equals_long_runs_with_halves_that_differ) {
    expect_same_motion(published_plant(), {5.0, 0.1, 100, true}, pulse(100, 20, 60));
}

TEST(PeriodicOrbit, equals_long_runs_where_the_film_is_very_stiff) {
    PlantModel model = published_plant();
    quiesce::SqueezeBiviscosityParams film{0.025, 0.002, 2e-5,   0.042, 1e-6,
                                           0.160, 1.0,   1000.0, 0.030, 4.74e-5};
    model.dampers[0].damper = std::make_shared<quiesce::SqueezeBiviscosity>(film);
    model.max_step_s = quiesce::longest_safe_step_s(model);
    expect_same_motion(model, {5.0, 0.1, 50, false}, std::vector<double>(50, 5.0));
}

TEST(PeriodicOrbit, starts_from_a_guess_in_fewer_periods) {
    PeriodicOrbit orbit(published_plant(), {5.0, 0.1, 50, false});
    const std::vector<double> command_A = pulse(50, 10, 35);
    orbit.solve(command_A.data(), nullptr);
    const Eigen::VectorXd start = orbit.start();
    const int from_nothing = orbit.periods();
    orbit.solve(command_A.data(), start.data());
    EXPECT_EQ(orbit.periods(), 1);
    EXPECT_GT(from_nothing, 1);
}

TEST(PeriodicOrbit, sensitivities_are_differences_of_orbits) {
    PlantModel model = published_plant();
    model.dampers[0].coil = {0.004, 0.008};
    const OrbitCase orbit_case{5.0, 0.1, 20, false};
    std::vector<double> command_A(20, 2.0);
    command_A[7] = 4.0;
    PeriodicOrbit orbit(model, orbit_case);
    orbit.solve(command_A.data(), nullptr);
    const PeriodicOrbit::Sensitivity slopes = orbit.sensitivity();
    for (const std::size_t at : {std::size_t{0}, std::size_t{7}, std::size_t{19}}) {
        constexpr double kBy_A = 1e-4;
        std::vector<double> moved_A = command_A;
        moved_A[at] += kBy_A;
        PeriodicOrbit moved(model, orbit_case);
        moved.solve(moved_A.data(), nullptr);
        const auto column = static_cast<Eigen::Index>(at);
        const Eigen::VectorXd disp = (moved.period().disp_m - orbit.period().disp_m) / kBy_A;
        const Eigen::VectorXd accel =
            (moved.period().accel_m_s2 - orbit.period().accel_m_s2) / kBy_A;
        EXPECT_LT((disp - slopes.disp_per_A.col(column)).norm(), 1e-3 * disp.norm());
        EXPECT_LT((accel - slopes.accel_per_A.col(column)).norm(), 1e-3 * accel.norm());
    }
}

TEST(PeriodicOrbit, stops_where_the_damper_closes) {
    PlantModel model = published_plant();
    model.shaker.drive_V = 100.0;
    const std::vector<double> command_A(10, 0.0);
    PeriodicOrbit orbit(model, {11.5, 100.0, 10, false});
    EXPECT_THROW(orbit.solve(command_A.data(), nullptr), quiesce::InputError);
}

class PlantLibrary : public testing::Test {
  protected:
    PlantLibrary() : plant_(quiesce_plant_load(kPlantFile, error_, sizeof error_)) {}
    ~PlantLibrary() override { quiesce_plant_free(plant_); }
    PlantLibrary(const PlantLibrary &) = delete;
    PlantLibrary &operator=(const PlantLibrary &) = delete;

    std::string refusal(const quiesce_orbit_case &orbit_case, double command_A) {
        quiesce_orbit orbit{};
        const std::vector<double> commands_A(10, command_A);
        error_[0] = '\0';
        const int status = quiesce_orbit_solve(plant_, &orbit_case, commands_A.data(), &orbit,
                                               error_, sizeof error_);
        EXPECT_EQ(status, 1);
        return error_;
    }

    char error_[200] = "";
    quiesce_plant *plant_;
};

TEST_F(PlantLibrary, tells_facts_of_the_file) {
    quiesce_plant_facts facts{};
    quiesce_plant_get_facts(plant_, &facts);
    EXPECT_EQ(facts.mode_count, 2);
    EXPECT_EQ(facts.max_current_A, 5.0);
    EXPECT_EQ(facts.drive_V, 0.1);
    quiesce_plant_mode mode{};
    quiesce_plant_get_mode(plant_, 1, &mode);
    EXPECT_NEAR(mode.freq_Hz, 96.0, 1e-9);
    EXPECT_NEAR(mode.damping_ratio, 0.014375, 1e-9);
    EXPECT_NEAR(quiesce_plant_shaker_per_V(plant_, 10.0), 2.96, 1e-9);
}

TEST_F(PlantLibrary, figures_follow_from_the_waveforms) {
    const quiesce_orbit_case orbit_case{10.0, 0.1, 10, 0};
    const std::size_t grid = quiesce_orbit_grid(plant_, &orbit_case);
    ASSERT_GE(grid, 400U);
    std::vector<double> disp_m(grid);
    std::vector<double> coil_A(grid);
    const std::vector<double> command_A(10, 0.0);
    quiesce_orbit orbit{};
    orbit.disp_m = disp_m.data();
    orbit.coil_A = coil_A.data();
    ASSERT_EQ(
        quiesce_orbit_solve(plant_, &orbit_case, command_A.data(), &orbit, error_, sizeof error_),
        0);
    // Without current the plant is linear: a sine of the amplitude that
    // docs/howto/describe-a-plant.md tells.
    EXPECT_NEAR(1e6 * orbit.figures.amp_m, 151.3, 0.1);
    EXPECT_NEAR(orbit.figures.amp_m, orbit.figures.disp_fundamental_m, 1e-4 * 151e-6);
    EXPECT_NEAR(disp_m[0],
                orbit.figures.disp_fundamental_m * std::cos(orbit.figures.disp_phase_rad), 2e-8);
    EXPECT_EQ(*std::max_element(coil_A.begin(), coil_A.end()), 0.0);
}

TEST_F(PlantLibrary, refuses_what_no_plant_can_do) {
    EXPECT_NE(refusal({5.0, 0.1, 10, 0}, 5.1).find("allowed are 0 .. 5"), std::string::npos);
    EXPECT_NE(refusal({5.0, 0.1, 10, 0}, std::numeric_limits<double>::quiet_NaN()).find("nan"),
              std::string::npos);
    EXPECT_NE(refusal({0.0, 0.1, 10, 0}, 1.0).find("positive"), std::string::npos);
    const quiesce_orbit_case no_intervals{5.0, 0.1, 0, 0};
    EXPECT_EQ(quiesce_orbit_grid(plant_, &no_intervals), 0U);
}

TEST(PlantLibraryFile, is_named_where_it_cannot_be_read) {
    char error[200] = "";
    EXPECT_EQ(quiesce_plant_load("no_such_file.toml", error, sizeof error), nullptr);
    EXPECT_NE(std::strstr(error, "no_such_file.toml"), nullptr);
}

} // namespace
