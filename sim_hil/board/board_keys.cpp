#include "board_keys.h"

#include <limits>

namespace quiesce {

namespace {

using Damper = quiesce_board_damper_t;
using Sensor = quiesce_board_sensor_t;

quiesce_board_t default_board() {
    quiesce_board_t board;
    quiesce_board_default(&board);
    return board;
}

/// The rule itself says what it allows when it refuses.
FieldRange asked(const quiesce_board_t &bad) {
    quiesce_board_error_t error = {};
    quiesce_board_check(&bad, &error);
    return {error.min, error.max};
}

constexpr std::int32_t kNeverAllowed = std::numeric_limits<std::int32_t>::min();

} // namespace

FieldRange range_of(std::int32_t quiesce_board_t::*field) {
    quiesce_board_t board = default_board();
    board.*field = kNeverAllowed;
    return asked(board);
}

FieldRange range_of(std::int32_t quiesce_board_sensor_t::*field) {
    quiesce_board_t board = default_board();
    board.sensor[0].*field = kNeverAllowed;
    return asked(board);
}

FieldRange range_of(std::int32_t quiesce_board_damper_t::*field) {
    quiesce_board_t board = default_board();
    board.damper[0].*field = kNeverAllowed;
    return asked(board);
}

const std::vector<RootKey> &root_keys() {
    static const std::vector<RootKey> keys = {
        {"bus_latency_us", "us", &quiesce_board_t::bus_latency_us, false},
    };
    return keys;
}

const std::vector<SensorKey> &sensor_keys() {
    static const std::vector<SensorKey> keys = {
        {"polarity", "", &Sensor::polarity, false},
        {"offset_counts", "count", &Sensor::offset_counts, false},
        {"full_scale_counts", "count", &Sensor::full_scale_counts, true},
        {"period_us", "us", &Sensor::period_us, false},
        {"max_age_us", "us", &Sensor::max_age_us, false},
        {"stuck_us", "us", &Sensor::stuck_us, false},
        {"min_noise_counts", "count", &Sensor::min_noise_counts, false},
        {"max_lost_pct", "%", &Sensor::max_lost_pct, false},
        {"latency_us", "us", &Sensor::latency_us, false},
        {"corner_mHz", "mHz", &Sensor::corner_mHz, false},
    };
    return keys;
}

const std::vector<DamperKey> &damper_keys() {
    static const std::vector<DamperKey> keys = {
        {"ceiling_mA", "mA", &Damper::ceiling_mA, true},
        {"safe_mA", "mA", &Damper::safe_mA, true},
        {"continuous_mA", "mA", &Damper::continuous_mA, false},
        {"heat_s", "s", &Damper::heat_s, false},
        {"trip_mA", "mA", &Damper::trip_mA, false},
        {"trip_us", "us", &Damper::trip_us, false},
        {"coil_lag_us", "us", &Damper::coil_lag_us, false},
        {"coil_mohm", "mOhm", &Damper::coil_mohm, false},
    };
    return keys;
}

const std::vector<Sense> &senses() {
    static const std::vector<Sense> all = {
        {"acceleration", Owner::Body, "um/s2", "scale_um_s2"},
        {"velocity", Owner::Body, "um/s", "scale_um_s"},
        {"displacement", Owner::Body, "nm", "scale_nm"},
        {"stroke", Owner::Damper, "nm", "scale_nm"},
        {"stroke_velocity", Owner::Damper, "um/s", "scale_um_s"},
        {"force", Owner::Damper, "mN", "scale_mN"},
        {"coil_voltage", Owner::Damper, "mV", "scale_mV"},
        {"temperature", Owner::Damper, "mdegC", "scale_mdegC"},
        {"supply_voltage", Owner::Board, "mV", "scale_mV"},
    };
    return all;
}

const std::vector<std::string> &axes() {
    static const std::vector<std::string> all = {"x", "y", "z"};
    return all;
}

} // namespace quiesce
