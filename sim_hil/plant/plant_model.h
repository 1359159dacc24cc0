/// Everything that makes up a plant, as read from a plant file.
#ifndef QUIESCE_PLANT_MODEL_H
#define QUIESCE_PLANT_MODEL_H

#include <cstdint>
#include <memory>
#include <string>

#include "accelerometer.h"
#include "coil.h"
#include "current_driver.h"
#include "damper.h"
#include "shaker.h"
#include "structure.h"

namespace quiesce {

struct PlantModel {
    std::string name;
    Structure structure;
    std::shared_ptr<const Damper> damper;
    CurrentDriverParams driver;
    CoilParams coil;
    ShakerParams shaker;
    AccelerometerParams sensor;
    double max_step_s; ///< longest integration step
};

/// Longest integration step that follows the model's fastest rate (undamped modes, damping, the
/// damper's steepest slopes): a third of what keeps the method stable.
double longest_safe_step_s(const PlantModel &model);

/// Integration steps in one tick of tick_s: the fewest that are no longer than max_step_s.
std::int64_t steps_per_tick(const PlantModel &model, double tick_s);

} // namespace quiesce

#endif
