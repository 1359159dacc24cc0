#include "sensor_values.h"

#include <algorithm>
#include <cmath>
#include <map>

#include "board_keys.h"

namespace quiesce {

namespace {

struct SiUnit {
    const char *unit; ///< as co-simulations write it
    double factor;    ///< from the board's
    const char *suffix;
};

/// By the unit of a board's sensor.
const SiUnit &si_of(const std::string &unit) {
    static const std::map<std::string, SiUnit> units = {
        {"um/s2", {"m/s2", 1e-6, "m_s2"}}, {"um/s", {"m/s", 1e-6, "m_s"}},
        {"nm", {"m", 1e-9, "m"}},          {"mN", {"N", 1e-3, "N"}},
        {"mV", {"V", 1e-3, "V"}},          {"mdegC", {"degC", 1e-3, "degC"}},
    };
    return units.at(unit);
}

} // namespace

SensorValues::SensorValues(const quiesce_params_t &params)
    : ports_{{"sensor.accel_m_s2", "sensor.is_fresh", "m/s2", "acceleration",
              1e-9 * params.accel_scale_nm_s2 * params.accel_polarity,
              params.accel_offset_counts}} {}

SensorValues::SensorValues(const BoardFile &board) {
    for (std::size_t i = 0; i < board.sensors.size(); ++i) {
        const quiesce_board_sensor_t &sensor = board.board.sensor[i];
        const Sense &sense = senses()[static_cast<std::size_t>(sensor.sense)];
        const SiUnit &si = si_of(sense.unit);
        const std::string name = "sensor." + board.sensors[i];
        std::string quantity = sense.name;
        std::replace(quantity.begin(), quantity.end(), '_', ' ');
        ports_.push_back({name + "." + sense.name + "_" + si.suffix, name + ".is_fresh", si.unit,
                          quantity, si.factor / kScalesPerUnit * sensor.scale * sensor.polarity,
                          sensor.offset_counts});
    }
}

double SensorValues::of_counts(std::size_t sensor, std::int32_t counts) const {
    const SensorPort &port = ports_[sensor];
    return port.per_count * (static_cast<double>(counts) - port.offset_counts);
}

std::int32_t SensorValues::counts_of(std::size_t sensor, double value) const {
    const SensorPort &port = ports_[sensor];
    const double counts = std::round(value / port.per_count) + port.offset_counts;
    if (std::isnan(counts)) {
        return 0;
    }
    return static_cast<std::int32_t>(
        std::clamp(counts, static_cast<double>(INT32_MIN), static_cast<double>(INT32_MAX)));
}

} // namespace quiesce
