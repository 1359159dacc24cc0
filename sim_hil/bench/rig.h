/// A board and the plant that it is wired to, matched by name: bodies of the board are places of
/// the plant, dampers of the board are dampers of the plant.
#ifndef QUIESCE_RIG_H
#define QUIESCE_RIG_H

#include <optional>
#include <string>
#include <vector>

#include "board_file.h"
#include "plant_model.h"
#include "scenario.h"

namespace quiesce {

/// What a sensor of a board is in the plant; without a file it is ideal.
struct RigSensor {
    std::optional<SensorParams> params;
    std::size_t other; ///< place or damper that it sees, too, where params->cross_talk is not 0
};

struct Rig {
    BoardFile file;
    std::vector<std::size_t> place_of;  ///< of the plant, for each body of the board
    std::vector<std::size_t> damper_of; ///< likewise, for each damper
    std::vector<double> noise;          ///< RMS in a sample, for each sensor, in its unit
    std::vector<RigSensor> sensors;     ///< likewise: what comes before its samples

    const quiesce_board_t &board() const { return file.board; }
};

/// Throws InputError naming what the plant lacks, or what of it no simulation makes (voltages).
Rig make_rig(BoardFile board, const PlantModel &plant);

/// What a command takes to the drivers, in ticks; null: nothing.
std::size_t bus_ticks(const Rig *rig, std::int64_t tick_rate_Hz);

/// A fault with what it befalls.
struct PlacedFault {
    InjectedFault fault;
    std::size_t sensor; ///< of the board
    std::size_t damper; ///< of the board
};

/// Of a scenario on this rig; null: the plant's one sensor and one damper. Throws InputError where
/// it names a sensor or damper that is not there.
std::vector<PlacedFault> place_faults(const Scenario &scenario, const Rig *rig);

/// Throws InputError where the law of the parameters, or its tracker, lacks a signal of the board.
void require_signals(const BoardFile &file, const quiesce_params_t &params);

} // namespace quiesce

#endif
