#include "rig.h"

#include <algorithm>

#include "board_keys.h"
#include "delay_line.h"
#include "input_error.h"

namespace quiesce {

namespace {

template <typename Items>
std::string names_of(const Items &items) {
    std::string names;
    for (const auto &item : items) {
        names += (names.empty() ? "" : ", ") + item.name;
    }
    return names.empty() ? "none" : names;
}

template <typename Items>
std::size_t index_in(const Items &items, const std::string &name, const std::string &who) {
    const auto found = std::find_if(items.begin(), items.end(),
                                    [&](const auto &item) { return item.name == name; });
    if (found == items.end()) {
        throw InputError(who +
                         ": the plant has no such one ([[place]] and [[damper]] of its file "
                         "have names); it has: " +
                         names_of(items));
    }
    return static_cast<std::size_t>(found - items.begin());
}

void require_simulated(const BoardFile &file) {
    for (std::size_t i = 0; i < file.sensors.size(); ++i) {
        const std::int32_t sense = file.board.sensor[i].sense;
        if (sense == QUIESCE_SENSE_VOLTAGE || sense == QUIESCE_SENSE_SUPPLY) {
            throw InputError("sensor '" + file.sensors[i] +
                             "' of the board: the simulated plant has no voltages; leave it out "
                             "of the board for the bench");
        }
    }
}

bool keeps_temperature(const Damper &damper) {
    const std::vector<double> start(damper.state_count(), 0.0);
    return damper.fluid_C(start.data()).has_value();
}

void require_temperatures(const Rig &rig, const PlantModel &plant) {
    for (std::size_t i = 0; i < rig.file.sensors.size(); ++i) {
        const quiesce_board_sensor_t &sensor = rig.board().sensor[i];
        if (sensor.sense != QUIESCE_SENSE_TEMPERATURE) {
            continue;
        }
        const std::size_t of = rig.damper_of[static_cast<std::size_t>(sensor.at)];
        if (!keeps_temperature(*plant.dampers[of].damper)) {
            throw InputError("sensor '" + rig.file.sensors[i] + "' of the board: the " +
                             label(plant.dampers[of]) +
                             " of the plant has no temperature; give it a table [thermal]");
        }
    }
}

/// Every damper of the plant is wired to the board: one that nobody commands is no damper of it.
void require_all_dampers(const Rig &rig, const PlantModel &plant) {
    for (std::size_t i = 0; i < plant.dampers.size(); ++i) {
        if (std::find(rig.damper_of.begin(), rig.damper_of.end(), i) == rig.damper_of.end()) {
            throw InputError("damper '" + plant.dampers[i].name +
                             "' of the plant: the board has no such one");
        }
    }
}

Eigen::VectorXd shape_of(const Rig &rig, const PlantModel &plant, std::int32_t body) {
    if (body == QUIESCE_GROUND) {
        return Eigen::VectorXd::Zero(plant.structure.mode_count());
    }
    return plant.places[rig.place_of[static_cast<std::size_t>(body)]].shape;
}

/// A board that thinks a damper somewhere else, or the other way round, would see other strokes.
void require_same_ends(const Rig &rig, const PlantModel &plant) {
    constexpr double kRounding = 1e-6;
    for (std::size_t i = 0; i < rig.damper_of.size(); ++i) {
        const quiesce_board_damper_t &wired = rig.board().damper[i];
        const PlantDamper &damper = plant.dampers[rig.damper_of[i]];
        const Eigen::VectorXd stroke =
            damper.ratio * (shape_of(rig, plant, wired.end_a) - shape_of(rig, plant, wired.end_b));
        if ((stroke - damper.stroke).norm() > kRounding * (1.0 + damper.stroke.norm())) {
            throw InputError("damper '" + rig.file.dampers[i] +
                             "': its ends on the board, end_a and end_b, are not those of the "
                             "plant, a and b");
        }
    }
}

/// values: by the names of sensors.
template <typename Values>
void require_sensors(const BoardFile &file, const Values &values, const std::string &section) {
    for (const auto &[name, value] : values) {
        if (std::find(file.sensors.begin(), file.sensors.end(), name) == file.sensors.end()) {
            std::string message = section;
            message.append(".").append(name).append(" of the plant: the board has no such sensor");
            throw InputError(message);
        }
    }
}

std::vector<double> noise_of(const BoardFile &file, const PlantModel &plant) {
    require_sensors(file, plant.noise, "noise");
    std::vector<double> out;
    for (const std::string &name : file.sensors) {
        const auto own = plant.sensors.find(name);
        const auto found = plant.noise.find(name);
        out.push_back(found != plant.noise.end()   ? found->second
                      : own != plant.sensors.end() ? own->second.params.noise
                                                   : 0.0);
    }
    return out;
}

RigSensor wired(const std::string &name, const WiredSensor &sensor, std::int32_t sense,
                const PlantModel &plant) {
    const Sense &kind = senses()[static_cast<std::size_t>(sense)];
    if (sensor.params.unit != kind.unit) {
        throw InputError("sensors." + name + " of the plant: its file is in " + sensor.params.unit +
                         ", but " + kind.name + " of the board is in " + kind.unit);
    }
    RigSensor out{sensor.params, 0};
    if (sensor.cross_talk_from.empty()) {
        out.params->cross_talk = 0.0;
    } else {
        const std::string what =
            "sensors." + name + ".cross_talk_from '" + sensor.cross_talk_from + "' of the plant";
        out.other = kind.owner == Owner::Body
                        ? index_in(plant.places, sensor.cross_talk_from, what)
                        : index_in(plant.dampers, sensor.cross_talk_from, what);
    }
    return out;
}

std::vector<RigSensor> sensors_of(const BoardFile &file, const PlantModel &plant) {
    require_sensors(file, plant.sensors, "sensors");
    std::vector<RigSensor> out;
    for (std::size_t i = 0; i < file.sensors.size(); ++i) {
        const auto found = plant.sensors.find(file.sensors[i]);
        out.push_back(found == plant.sensors.end()
                          ? RigSensor{std::nullopt, 0}
                          : wired(found->first, found->second, file.board.sensor[i].sense, plant));
    }
    return out;
}

std::size_t named(const std::vector<std::string> &names, const InjectedFault &fault,
                  std::size_t otherwise) {
    const auto found = std::find(names.begin(), names.end(), fault.of);
    return found == names.end() ? otherwise : static_cast<std::size_t>(found - names.begin());
}

bool has_name(const std::vector<std::string> &names, const std::string &name) {
    return std::find(names.begin(), names.end(), name) != names.end();
}

void require_known(const InjectedFault &fault, const Rig *rig) {
    if (fault.of.empty()) {
        return;
    }
    if (rig == nullptr) {
        throw InputError("fault.of = '" + fault.of + "': names are a board's; the run has none");
    }
    const BoardFile &file = rig->file;
    if (!has_name(befalls_damper(fault.kind) ? file.dampers : file.sensors, fault.of)) {
        throw InputError("fault.of = '" + fault.of + "': the board has no such " +
                         (befalls_damper(fault.kind) ? "damper" : "sensor"));
    }
}

} // namespace

Rig make_rig(BoardFile board, const PlantModel &plant) {
    require_simulated(board);
    Rig rig{std::move(board), {}, {}, {}, {}};
    for (const std::string &name : rig.file.bodies) {
        rig.place_of.push_back(index_in(plant.places, name, "body '" + name + "' of the board"));
    }
    for (const std::string &name : rig.file.dampers) {
        rig.damper_of.push_back(
            index_in(plant.dampers, name, "damper '" + name + "' of the board"));
    }
    require_all_dampers(rig, plant);
    require_temperatures(rig, plant);
    require_same_ends(rig, plant);
    rig.noise = noise_of(rig.file, plant);
    rig.sensors = sensors_of(rig.file, plant);
    return rig;
}

std::vector<PlacedFault> place_faults(const Scenario &scenario, const Rig *rig) {
    std::vector<PlacedFault> out;
    for (const InjectedFault &fault : scenario.faults) {
        require_known(fault, rig);
        const std::vector<std::string> none;
        const auto tracked =
            rig == nullptr ? std::size_t{0} : static_cast<std::size_t>(rig->board().tracked);
        out.push_back({fault, named(rig == nullptr ? none : rig->file.sensors, fault, tracked),
                       named(rig == nullptr ? none : rig->file.dampers, fault, 0)});
    }
    return out;
}

void require_signals(const BoardFile &file, const quiesce_params_t &params) {
    quiesce_signal_t missing;
    if (quiesce_missing(&file.board, &params, &missing)) {
        throw InputError("board " + file.name + ": the law needs " + told(file, missing) +
                         ", which no sensor of it provides");
    }
}

std::size_t bus_ticks(const Rig *rig, std::int64_t tick_rate_Hz) {
    return rig == nullptr ? 0 : ticks_in(rig->board().bus_latency_us, tick_rate_Hz);
}

} // namespace quiesce
