/// Band, corner, drift and cross-talk of sensors, and the files that say them.
#include <gtest/gtest.h>

#include <cmath>
#include <complex>

#include "file_mistakes.h"
#include "plant_file.h"
#include "sensor_dynamics.h"
#include "sensor_section.h"

namespace {

using quiesce::load_sensor;
using quiesce::Mistake;
using quiesce::read;
using quiesce::SensorDynamics;
using quiesce::SensorParams;
using quiesce::spoilt;

constexpr double kTwoPi = 6.28318530717958647692;
constexpr int kRate_Hz = 1000;
const char *const kAccelerometer = "sim_hil/data/sensors/pcb_333B32.toml";
const char *const kPlant = "sim_hil/data/plants/squeeze_2012_nodes.toml";

SensorParams ideal() {
    return {"ideal", "um/s2", 0.0, 0.0, 0.0, 0.0, 100.0, 0.0, 0.0};
}

/// The plant with its sensor files by whole paths, so that it may be anywhere.
std::string anywhere() {
    const std::string folder = std::filesystem::absolute("sim_hil/data/sensors").string();
    std::string text = read(kPlant);
    for (std::size_t at = text.find("../sensors"); at != std::string::npos;
         at = text.find("../sensors")) {
        text.replace(at, std::string("../sensors").size(), folder);
    }
    return text;
}

/// Output over input at this frequency, of the last 4 of 24 s.
std::complex<double> response(const SensorParams &params, double freq_Hz) {
    SensorDynamics sensor(params, kRate_Hz, 1);
    std::complex<double> sum = 0.0;
    for (int tick = 0; tick < 24 * kRate_Hz; ++tick) {
        const double angle = kTwoPi * freq_Hz * tick / kRate_Hz;
        const double out = sensor.step(std::cos(angle), 0.0, 0.0);
        sum += tick < 20 * kRate_Hz ? 0.0 : out * std::polar(1.0, -angle);
    }
    return sum / (2.0 * kRate_Hz);
}

double degrees(std::complex<double> value) {
    return std::arg(value) * 360.0 / kTwoPi;
}

TEST(SensorDynamics, an_ideal_sensor_changes_no_bit) {
    SensorDynamics sensor(ideal(), kRate_Hz, 1);
    for (double value : {0.0, 1.25, -3e7, 1e-9}) {
        EXPECT_EQ(sensor.step(value, 5.0, 2.0), value);
    }
}

TEST(SensorDynamics, a_corner_of_half_a_hertz_leads_at_5_Hz_by_5_7_degrees) {
    SensorParams params = ideal();
    params.corner_Hz = 0.5;
    const std::complex<double> at_5_Hz = response(params, 5.0);
    EXPECT_NEAR(degrees(at_5_Hz), 5.711, 0.01);
    EXPECT_NEAR(std::abs(at_5_Hz), 0.99504, 1e-3);
    EXPECT_NEAR(degrees(response(params, 0.5)), 45.0, 0.1);
    EXPECT_NEAR(std::abs(response(params, 0.5)), std::sqrt(0.5), 1e-3);
}

TEST(SensorDynamics, a_band_delays_and_takes_what_is_faster) {
    SensorParams params = ideal();
    params.band_Hz = 3000.0;
    // 53 us: 0.38 degrees at 20 Hz.
    EXPECT_NEAR(degrees(response(params, 20.0)), -0.382, 0.005);
    params.band_Hz = 20.0;
    EXPECT_NEAR(degrees(response(params, 20.0)), -45.0, 0.1);
    EXPECT_NEAR(std::abs(response(params, 20.0)), std::sqrt(0.5), 2e-3);
}

TEST(SensorDynamics, a_constant_passes_a_band_and_no_corner) {
    SensorParams params = ideal();
    params.band_Hz = 100.0;
    SensorDynamics slow(params, kRate_Hz, 1);
    EXPECT_NEAR(slow.step(3.0, 0.0, 0.0), 3.0, 1e-12) << "settled from the start";
    params.corner_Hz = 1.0;
    SensorDynamics sensor(params, kRate_Hz, 1);
    EXPECT_NEAR(sensor.step(3.0, 0.0, 0.0), 0.0, 1e-12);
}

TEST(SensorDynamics, cross_talk_adds_a_part_of_what_is_beside_it_and_of_the_coil) {
    SensorParams params = ideal();
    params.cross_talk = 0.05;
    params.cross_talk_per_A = 7.0;
    SensorDynamics sensor(params, kRate_Hz, 1);
    EXPECT_DOUBLE_EQ(sensor.step(100.0, 40.0, 2.0), 116.0);
}

TEST(SensorDynamics, drift_starts_at_0_and_has_the_stated_rms) {
    SensorParams params = ideal();
    params.drift = 2.0;
    params.drift_s = 0.05;
    SensorDynamics sensor(params, kRate_Hz, 3);
    EXPECT_LT(std::abs(sensor.step(0.0, 0.0, 0.0)), 2.0);
    double square = 0.0;
    double neighbours = 0.0;
    double last = 0.0;
    constexpr int kCount = 400000;
    for (int i = 0; i < kCount; ++i) {
        const double value = sensor.step(0.0, 0.0, 0.0);
        square += value * value;
        neighbours += value * last;
        last = value;
    }
    EXPECT_NEAR(std::sqrt(square / kCount), 2.0, 0.1);
    EXPECT_NEAR(neighbours / square, std::exp(-1e-3 / 0.05), 1e-3);
}

TEST(SensorFile, the_published_parts_are_read) {
    const SensorParams accelerometer = load_sensor(kAccelerometer);
    EXPECT_EQ(accelerometer.corner_Hz, 0.5);
    EXPECT_EQ(accelerometer.band_Hz, 3000.0);
    EXPECT_EQ(accelerometer.cross_talk, 0.05);
    EXPECT_EQ(load_sensor("sim_hil/data/sensors/keyence_AH416.toml").unit, "nm");
    EXPECT_EQ(load_sensor("sim_hil/data/sensors/load_cell_50N.toml").unit, "mN");
}

TEST(SensorFile, a_plant_takes_its_noise_from_it_and_may_say_another) {
    const quiesce::PlantModel model = quiesce::load_plant(kPlant);
    ASSERT_TRUE(model.transducer.has_value());
    EXPECT_EQ(model.transducer->params.name, "pcb_333B32");
    EXPECT_NEAR(model.sensor.noise_mg, 0.5, 1e-12);
    EXPECT_EQ(model.sensors.at("gap").params.band_Hz, 3300.0);
    EXPECT_FALSE(quiesce::load_plant("sim_hil/data/plants/squeeze_2012.toml").transducer);
}

TEST(SensorFile, every_mistake_is_named_in_one_line) {
    const Mistake mistakes[] = {
        {"unit", "\"um/s2\"", "\"g\"", "unit: expected one of: um/s2, um/s, nm, mN"},
        {"no_unit", "unit = \"um/s2\"", "", "unit: missing"},
        {"negative_corner", "corner_Hz = 0.5", "corner_Hz = -0.5", "corner_Hz: expected"},
        {"corner_text", "corner_Hz = 0.5", "corner_Hz = \"low\"", "corner_Hz: expected"},
        {"crossed", "band_Hz = 3000.0", "band_Hz = 0.4", "band_Hz: expected more than corner_Hz"},
        {"unknown", "corner_Hz = 0.5", "corner_mHz = 500", "corner_mHz: unknown key"},
        {"noise", "noise = 4903.325", "noise = -1", "noise: expected"},
        {"drift_s", "noise = 4903.325", "drift_s = 0", "drift_s: expected"},
        {"cross_talk", "cross_talk_pct = 5.0", "cross_talk_pct = 500", "cross_talk_pct: expected"},
        {"schema", "quiesce-sensor", "quiesce-plant", "schema"},
        {"not_toml", "unit = ", "unit ", "Error while parsing"},
    };
    for (const Mistake &mistake : mistakes) {
        SCOPED_TRACE(mistake.name);
        quiesce::expect_message(spoilt(read(kAccelerometer), mistake), mistake.words, load_sensor);
    }
    EXPECT_THROW(load_sensor("no_such.toml"), quiesce::InputError);
}

TEST(SensorFile, every_mistake_of_the_plant_is_named_in_one_line) {
    const Mistake mistakes[] = {
        {"other_unit", "pcb_333B32", "keyence_AH416",
         "sensor.file: expected a sensor in um/s2, an accelerometer; found one in nm"},
        {"no_place", "full_scale_g", "cross_talk_from = \"side\"\nfull_scale_g",
         "sensor.cross_talk_from: expected one of: node1"},
        {"none_of_it", "[sensors.gap]", "[sensors.gap]\ncross_talk_from = \"node4\"",
         "sensors.gap.cross_talk_from: its file has no cross_talk_pct"},
        {"unknown", "[sensors.gap]", "[sensors.gap]\nnoise = 1", "sensors.gap.noise: unknown key"},
        {"no_file", "[sensors.gap]\nfile", "[sensors.gap]\nfiles", "sensors.gap.file: missing"},
        {"name", "[sensors.gap]", "[sensors.\"a b\"]", "expected a letter"},
    };
    for (const Mistake &mistake : mistakes) {
        SCOPED_TRACE(mistake.name);
        quiesce::expect_message(spoilt(anywhere(), mistake), mistake.words, quiesce::load_plant);
    }
}

} // namespace
