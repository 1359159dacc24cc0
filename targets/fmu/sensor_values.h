/// Sensors as co-simulations see them: values in SI units, each a whole number of a sensor's
/// counts. Plant and controller have the same ones, so that nothing is lost in between.
#ifndef QUIESCE_SENSOR_VALUES_H
#define QUIESCE_SENSOR_VALUES_H

#include <cstdint>
#include <string>
#include <vector>

#include "board_file.h"

namespace quiesce {

struct SensorPort {
    std::string name; ///< sensor.accel_m_s2; of a board sensor.NAME.stroke_m
    std::string fresh_name;
    std::string unit;
    std::string description;
    double per_count; ///< in the unit
    std::int32_t offset_counts;
};

class SensorValues {
  public:
    /// The one accelerometer that parameters describe.
    explicit SensorValues(const quiesce_params_t &params);
    explicit SensorValues(const BoardFile &board);

    const std::vector<SensorPort> &ports() const { return ports_; }
    double of_counts(std::size_t sensor, std::int32_t counts) const;
    /// Rounded, and held to what 32 bits have; 0 of what is no number.
    std::int32_t counts_of(std::size_t sensor, double value) const;

  private:
    std::vector<SensorPort> ports_;
};

} // namespace quiesce

#endif
