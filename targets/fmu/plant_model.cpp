/// The plant as an FMU: currents and what shakes it go in; what its sensors deliver, and the truth,
/// come out.
#include <cmath>

#include "delay_line.h"
#include "pushed_segment.h"
#include "resources.h"
#include "run_options.h"
#include "senses.h"
#include "sensor_values.h"

namespace quiesce {

namespace {

Variable output(const std::string &name, const std::string &unit, const std::string &what) {
    return {name, VariableType::real, Causality::output, Variability::continuous, unit, what};
}

Variable input(const std::string &name, const std::string &unit, const std::string &what) {
    return {name, VariableType::real, Causality::input, Variability::continuous, unit, what};
}

class PlantFmu final : public FmuModel {
  public:
    explicit PlantFmu(RunSetup setup);

  private:
    struct DamperPort {
        std::size_t damper; ///< of the plant
        std::size_t current_cmd, enable;
        std::size_t stroke, velocity, force, current;
        std::optional<std::size_t> temperature;
    };
    struct PlacePort {
        std::size_t displacement, velocity, accel;
    };

    void declare_damper(std::size_t damper, const std::string &name);
    void declare_place(const std::string &name, const std::string &what);
    void declare_inputs();
    void start() override;
    void tick() override;
    void visit_state(StateArchive &archive) override;
    void push();
    void command();
    void show();

    RunSetup setup_;
    SensorValues sensor_values_;
    std::vector<std::size_t> sensors_; ///< variables of their values, each followed by its is_fresh
    std::vector<DamperPort> dampers_;
    std::vector<PlacePort> places_; ///< of the plant; without any, where its sensor is
    std::optional<std::size_t> force_, base_accel_;
    std::size_t seed_ = 0;

    std::shared_ptr<Stretch> stretch_ = std::make_shared<Stretch>();
    std::optional<Excitation> excitation_;
    std::optional<Plant> plant_;
    std::optional<Senses> senses_;
    DelayLine<DamperValues> bus_;
};

PlantFmu::PlantFmu(RunSetup setup)
    : FmuModel(setup.params.tick_rate_Hz), setup_(std::move(setup)),
      sensor_values_(setup_.rig ? SensorValues(setup_.rig->file) : SensorValues(setup_.params)) {
    declare_inputs();
    for (const SensorPort &port : sensor_values_.ports()) {
        sensors_.push_back(
            declare(output(port.name, port.unit, port.description + ", as sampled")));
        declare({port.fresh_name, VariableType::boolean, Causality::output, Variability::discrete,
                 "", "a sample came in the last tick"});
    }
    for (std::size_t i = 0; i < setup_.plant.dampers.size(); ++i) {
        const std::size_t of = setup_.rig ? setup_.rig->damper_of[i] : i;
        declare_damper(of, setup_.rig ? "damper." + setup_.rig->file.dampers[i] : "damper");
    }
    for (const Place &place : setup_.plant.places) {
        declare_place("place." + place.name, "place " + place.name);
    }
    if (setup_.plant.places.empty()) {
        declare_place("structure", "the place of the sensor");
    }
}

void PlantFmu::declare_inputs() {
    if (setup_.scenario.segments.empty()) {
        force_ = declare(input("shaker.force_N", "N", "force of a shaker, held over a step"));
        if (!setup_.plant.structure.base_participation.isZero(0.0)) {
            base_accel_ = declare(
                input("base.accel_m_s2", "m/s2", "acceleration of the base, held over a step"));
        }
    }
    seed_ = declare({"seed", VariableType::integer, Causality::parameter, Variability::fixed, "",
                     "of the sensors' noise", static_cast<double>(setup_.seed), 0.0, INT32_MAX});
}

void PlantFmu::declare_damper(std::size_t damper, const std::string &name) {
    DamperPort port{};
    port.damper = damper;
    port.current_cmd = declare(input(name + ".current_cmd_A", "A", "what its driver is told"));
    port.enable = declare({name + ".driver_enable", VariableType::boolean, Causality::input,
                           Variability::discrete, "", "false: the driver is off", 1.0});
    port.stroke = declare(output(name + ".stroke_m", "m", "end a less end b, from rest"));
    port.velocity = declare(output(name + ".velocity_m_s", "m/s", "of the stroke"));
    port.force = declare(output(name + ".force_N", "N", "> 0 resists a stroke that grows"));
    port.current = declare(output(name + ".current_A", "A", "in its coil"));
    const Damper &model = *setup_.plant.dampers[damper].damper;
    if (model.fluid_C(std::vector<double>(model.state_count(), 0.0).data())) {
        port.temperature = declare(output(name + ".temperature_degC", "degC", "of its fluid"));
    }
    dampers_.push_back(port);
}

void PlantFmu::declare_place(const std::string &name, const std::string &what) {
    places_.push_back(
        {declare(output(name + ".displacement_m", "m", what + ", relative to the base")),
         setup_.plant.places.empty()
             ? 0
             : declare(output(name + ".velocity_m_s", "m/s", what + ", relative to the base")),
         declare(output(name + ".accel_m_s2", "m/s2", what + ", absolute"))});
}

void PlantFmu::start() {
    setup_.seed = static_cast<std::uint64_t>(value(seed_));
    push();
    excitation_ = force_ ? pushed_by(stretch_, tick_rate_Hz())
                         : make_excitation(setup_.scenario, setup_.plant.shaker);
    plant_.emplace(setup_.plant, *excitation_, tick_rate_Hz());
    senses_.emplace(setup_.plant, setup_.rig_or_null(), tick_rate_Hz(), setup_.seed);
    bus_ = DelayLine<DamperValues>(bus_ticks(setup_.rig_or_null(), tick_rate_Hz()));
    show();
}

void PlantFmu::push() {
    const Push now = {force_ ? value(*force_) : 0.0, base_accel_ ? value(*base_accel_) : 0.0};
    *stretch_ = {0.0, now, now}; // from and to are the same: since when is no matter
}

void PlantFmu::command() {
    DamperValues told{};
    for (std::size_t i = 0; i < dampers_.size(); ++i) {
        told[i] = is_set(dampers_[i].enable) ? value(dampers_[i].current_cmd) : 0.0;
    }
    const DamperValues arrived = bus_.pass(told);
    for (std::size_t i = 0; i < dampers_.size(); ++i) {
        plant_->command(dampers_[i].damper, arrived[i], ActuatorFault::none);
    }
}

void PlantFmu::tick() {
    push();
    command();
    plant_->advance();
    show();
}

/// Reads the sensors: once an instant, as each reading has its noise.
void PlantFmu::show() {
    lockstep_stimulus_t sampled{};
    senses_->read(*plant_, plant_->tick(), sampled);
    for (std::size_t i = 0; i < sensors_.size(); ++i) {
        const bool is_fresh = (sampled.flags & LOCKSTEP_FRESH << i) != 0;
        put(sensors_[i] + 1, is_fresh ? 1.0 : 0.0);
        if (is_fresh) {
            put(sensors_[i], sensor_values_.of_counts(i, sampled.counts[i]));
        }
    }
    for (const DamperPort &port : dampers_) {
        const DamperTruth truth = plant_->damper(port.damper);
        put(port.stroke, truth.stroke_m);
        put(port.velocity, truth.velocity_m_s);
        put(port.force, truth.force_N);
        put(port.current, truth.coil_A);
        if (port.temperature) {
            put(*port.temperature, truth.fluid_C.value_or(0.0));
        }
    }
    if (setup_.plant.places.empty()) {
        put(places_[0].displacement, plant_->truth().displacement_m);
        put(places_[0].accel, plant_->truth().accel_m_s2);
        return;
    }
    for (std::size_t i = 0; i < places_.size(); ++i) {
        const PlaceTruth truth = plant_->place(i);
        put(places_[i].displacement, truth.displacement_m);
        put(places_[i].velocity, truth.velocity_m_s);
        put(places_[i].accel, truth.accel_m_s2);
    }
}

void PlantFmu::visit_state(StateArchive &archive) {
    plant_->visit_state(archive);
    senses_->visit_state(archive);
    bus_.visit_state(archive);
}

} // namespace

std::unique_ptr<FmuModel> make_plant_model(const std::vector<std::string> &words) {
    const Arguments arguments("plant", words, run_option_names());
    arguments.require_no_positional();
    RunSetup setup = arguments.text("scenario") ? run_setup(arguments)
                                                : setup_of_plant(arguments, "co-simulation");
    if (setup.seed > INT32_MAX) {
        throw InputError("seed " + std::to_string(setup.seed) + ": an FMU takes 0 .. " +
                         std::to_string(INT32_MAX));
    }
    if (!setup.scenario.faults.empty()) {
        throw InputError("scenario " + setup.scenario.name +
                         ": it has faults, which the importer of a plant is to inject; name a "
                         "scenario without any");
    }
    return std::make_unique<PlantFmu>(std::move(setup));
}

} // namespace quiesce
