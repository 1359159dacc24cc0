/// Sensors of a plant file: [sensor], [sensors.NAME] and [noise], and the sensor files they name.
#ifndef QUIESCE_SENSOR_SECTION_H
#define QUIESCE_SENSOR_SECTION_H

#include <string>

#include "plant_model.h"
#include "toml_table.h"

namespace quiesce {

/// A sensor file. Throws InputError naming file and key.
SensorParams load_sensor(const std::string &file);

/// Places and dampers of the model are there already. Throws InputError naming the key that is
/// wrong.
void read_sensors(TomlTable &root, PlantModel &model);

} // namespace quiesce

#endif
