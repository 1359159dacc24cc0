/// The C library's simulation from arrays against the plant under the same segments.
#include "plant_simulate.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <memory>
#include <string>
#include <vector>

#include "chirp_segment.h"
#include "excitation.h"
#include "plant.h"
#include "plant_file.h"
#include "sine_segment.h"

namespace {

using quiesce::Excitation;
using quiesce::Plant;
using quiesce::PlantModel;

constexpr const char *kPlantFile = "sim_hil/data/plants/squeeze_2012.toml";
constexpr int kRate_Hz = 1000;
constexpr std::size_t kTicks = 2000;
constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

struct Arrays {
    std::vector<double> amplitude_V = std::vector<double>(kTicks, 0.10);
    std::vector<double> phase_cycles = std::vector<double>(kTicks, 0.0);
    std::vector<double> command_A = std::vector<double>(kTicks, 0.0);
    std::vector<double> accel_m_s2 = std::vector<double>(kTicks, kNan);
    std::vector<double> disp_m = std::vector<double>(kTicks, kNan);
    std::vector<double> coil_A = std::vector<double>(kTicks, kNan);
};

/// Current from 0.5 s on, off from 1.2 s on.
void step_current(Arrays &arrays) {
    for (std::size_t tick = 500; tick < 1200; ++tick) {
        arrays.command_A[tick] = 3.0;
    }
}

/// Empty where it worked, else the library's message.
std::string simulate(Arrays &arrays, int rate_Hz, std::size_t ticks) {
    char error[200] = "";
    quiesce_plant *plant = quiesce_plant_load(kPlantFile, error, sizeof error);
    EXPECT_NE(plant, nullptr) << error;
    const quiesce_drive drive{rate_Hz, ticks, arrays.amplitude_V.data(), arrays.phase_cycles.data(),
                              arrays.command_A.data()};
    const quiesce_response response{arrays.accel_m_s2.data(), arrays.disp_m.data(),
                                    arrays.coil_A.data()};
    const int status = quiesce_plant_simulate(plant, &drive, &response, error, sizeof error);
    quiesce_plant_free(plant);
    EXPECT_EQ(status != 0, std::strlen(error) > 0);
    return error;
}

/// Largest difference of the acceleration from the plant's own run.
double difference(const Arrays &arrays, std::unique_ptr<quiesce::Segment> segment,
                  const PlantModel &model) {
    Excitation excitation;
    excitation.append(std::move(segment), 100.0);
    Plant plant(model, excitation, kRate_Hz);
    double worst = 0.0;
    for (std::size_t tick = 0; tick < kTicks; ++tick) {
        worst = std::max(worst, std::abs(plant.truth().accel_m_s2 - arrays.accel_m_s2[tick]));
        EXPECT_NEAR(plant.truth().coil_A, arrays.coil_A[tick], 1e-12);
        plant.command(0, arrays.command_A[tick], quiesce::ActuatorFault::none);
        plant.advance();
    }
    return worst;
}

TEST(PlantSimulate, EqualsThePlantUnderASineWithCurrentSteps) {
    Arrays arrays;
    step_current(arrays);
    for (std::size_t tick = 0; tick < kTicks; ++tick) {
        arrays.phase_cycles[tick] = 10.0 * static_cast<double>(tick) / kRate_Hz;
    }
    ASSERT_EQ(simulate(arrays, kRate_Hz, kTicks), "");
    const PlantModel model = quiesce::load_plant(kPlantFile);
    EXPECT_LT(difference(arrays, std::make_unique<quiesce::SineSegment>(model.shaker, 10.0), model),
              1e-9);
}

TEST(PlantSimulate, FollowsAChirpAndItsRollOff) {
    Arrays arrays;
    PlantModel model = quiesce::load_plant(kPlantFile);
    auto chirp = std::make_unique<quiesce::ChirpSegment>(model.shaker, 4.0, 20.0, 2.0);
    for (std::size_t tick = 0; tick < kTicks; ++tick) {
        const double time_s = static_cast<double>(tick) / kRate_Hz;
        arrays.phase_cycles[tick] = chirp->sample(time_s, 0.0).phase_cycles;
    }
    ASSERT_EQ(simulate(arrays, kRate_Hz, kTicks), "");
    // Its frequency is that of each tick's middle: 8 mHz of 4 Hz away at most.
    EXPECT_LT(difference(arrays, std::move(chirp), model), 2e-3);
}

TEST(PlantSimulate, GivesNothingWithoutDrive) {
    Arrays arrays;
    arrays.amplitude_V.assign(kTicks, 0.0);
    step_current(arrays);
    ASSERT_EQ(simulate(arrays, kRate_Hz, kTicks), "");
    EXPECT_EQ(arrays.accel_m_s2[kTicks - 1], 0.0);
    EXPECT_GT(arrays.coil_A[1199], 2.99);
}

TEST(PlantSimulate, RefusesWhatCannotBeSimulated) {
    Arrays arrays;
    EXPECT_NE(simulate(arrays, 0, kTicks), "");
    EXPECT_NE(simulate(arrays, kRate_Hz, 1), "");
    arrays.amplitude_V.assign(kTicks, 100.0);
    for (std::size_t tick = 0; tick < kTicks; ++tick) {
        arrays.phase_cycles[tick] = 11.0 * static_cast<double>(tick) / kRate_Hz;
    }
    EXPECT_NE(simulate(arrays, kRate_Hz, kTicks).find("damper closed"), std::string::npos);
}

} // namespace
