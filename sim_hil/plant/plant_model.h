/// Everything that makes up a plant, as read from a plant file.
#ifndef QUIESCE_PLANT_MODEL_H
#define QUIESCE_PLANT_MODEL_H

#include <array>
#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "accelerometer.h"
#include "coil.h"
#include "current_driver.h"
#include "damper.h"
#include "mount.h"
#include "place.h"
#include "sensor_dynamics.h"
#include "shaker.h"
#include "structure.h"

namespace quiesce {

constexpr std::size_t kMaxDampers = 4;
constexpr std::size_t kMaxPlaces = 4;
constexpr std::size_t kMaxMounts = 4;

/// A value of each damper, in the order of the plant's; beyond the last one 0.
using DamperValues = std::array<double, kMaxDampers>;

/// Name of a plant's damper that has none, because it is the only one.
inline const char *const kOnlyDamper = "damper";

struct PlantDamper {
    std::string name;
    std::shared_ptr<const Damper> damper;
    Eigen::VectorXd stroke; ///< that 1 of each mode gives, kg^-1/2: ratio x (end a less end b)
    CoilParams coil;
    double ratio = 1.0; ///< of its stroke to what its ends do: a lever
};

struct PlantModel {
    std::string name;
    Structure structure;
    std::vector<Place> places;        ///< 0 .. kMaxPlaces
    std::vector<PlantDamper> dampers; ///< 1 .. kMaxDampers
    std::vector<PlantMount> mounts;   ///< 0 .. kMaxMounts
    CurrentDriverParams driver;       ///< of each of them
    ShakerParams shaker;
    AccelerometerParams sensor;
    std::optional<WiredSensor> transducer;      ///< before that; none: it is ideal
    std::map<std::string, WiredSensor> sensors; ///< of a board, by their names; others are ideal
    /// RMS of white noise in a sample of a board's sensor, by its name, in the unit of its samples;
    /// before what its file says.
    std::map<std::string, double> noise;
    double max_step_s; ///< longest integration step
};

/// What people read: "damper", or "damper NAME" where it has one.
std::string label(const PlantDamper &damper);

/// Throws InputError where there are several: for what is made for plants with one.
void require_one_damper(const PlantModel &model);

/// Longest integration step that follows the model's fastest rate (undamped modes, damping, the
/// steepest slopes of dampers and mounts): a third of what keeps the method stable.
double longest_safe_step_s(const PlantModel &model);

/// Integration steps in one tick of tick_s: the fewest that are no longer than max_step_s.
std::int64_t steps_per_tick(const PlantModel &model, double tick_s);

} // namespace quiesce

#endif
