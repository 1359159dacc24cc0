#include "run_options.h"

#include <cmath>
#include <limits>
#include <sstream>
#include <utility>

#include "input_error.h"
#include "param_options.h"
#include "plant_file.h"
#include "start.h"
#include "table_file.h"

namespace quiesce {

namespace {

void apply_overrides(const Arguments &arguments, RunSetup &setup) {
    setup.seed = setup.scenario.seed;
    if (const auto seed = arguments.integer("seed", 0, INT64_MAX)) {
        setup.seed = static_cast<std::uint64_t>(*seed);
    }
    if (setup.scenario.drive_V) {
        setup.plant.shaker.drive_V = *setup.scenario.drive_V;
    }
    if (setup.scenario.noise_mg) {
        setup.plant.sensor.noise_mg = *setup.scenario.noise_mg;
    }
    if (const auto noise_mg = arguments.number("noise-mg", 0.0, 1e4)) {
        setup.plant.sensor.noise_mg = *noise_mg;
    }
    if (const auto step_us = arguments.number("dt-us", 1.0, 2000.0)) {
        setup.plant.max_step_s = 1e-6 * *step_us;
    }
    if (setup.plant.max_step_s > longest_safe_step_s(setup.plant)) {
        std::ostringstream message;
        message << "--dt-us: too long for this plant; at most "
                << std::floor(1e6 * longest_safe_step_s(setup.plant));
        throw InputError(message.str());
    }
}

} // namespace

void require_base(const Scenario &scenario, const PlantModel &plant) {
    if (moves_base(scenario, plant.shaker) && plant.structure.base_participation.isZero(0.0)) {
        throw InputError("scenario " + scenario.name + ": it shakes the base, but plant " +
                         plant.name + " has no base_participation to feel it with");
    }
}

const std::vector<std::string> &run_option_names() {
    static const std::vector<std::string> names = {"scenario", "plant", "board",    "law",
                                                   "set",      "seed",  "noise-mg", "dt-us"};
    return names;
}

const std::vector<std::string> &target_option_names() {
    static const std::vector<std::string> names = {"target", "image",           "plugin",
                                                   "can",    "telemetry-every", "wait-s"};
    return names;
}

const std::vector<std::string> &table_option_names() {
    static const std::vector<std::string> names = {"rules", "pulses", "law-table", "force-map"};
    return names;
}

std::vector<std::string> options(std::initializer_list<std::vector<std::string>> lists) {
    std::vector<std::string> all;
    for (const std::vector<std::string> &list : lists) {
        all.insert(all.end(), list.begin(), list.end());
    }
    return all;
}

quiesce_params_t params_from(const Arguments &arguments, quiesce_params_t base) {
    if (const auto law = arguments.text("law")) {
        try {
            set_param(base, "law=" + *law);
        } catch (const InputError &error) {
            const std::string what = error.what();
            throw InputError("--law " + *law + what.substr(what.find(": ")));
        }
    }
    for (const std::string &assignment : arguments.all("set")) {
        set_param(base, assignment);
    }
    require_accepted(base);
    return base;
}

quiesce_params_t params_for_board(const Arguments &arguments, quiesce_params_t base) {
    for (const std::string &assignment : arguments.all("set")) {
        const std::string name = assignment.substr(0, assignment.find('='));
        if (is_of_board(name)) {
            throw InputError("--set " + assignment + ": that comes from the board file");
        }
    }
    return params_from(arguments, base);
}

namespace {

void require_board_for(const PlantModel &plant) {
    if (plant.dampers.size() > 1) {
        std::ostringstream message;
        message << "plant " << plant.name << " has " << plant.dampers.size()
                << " dampers: name a board, --board FILE, or board = \"FILE\" in the scenario";
        throw InputError(message.str());
    }
}

/// Noise is the plant's, of each sensor by its name.
void refuse_noise(const Arguments &arguments, const Scenario &scenario) {
    if (scenario.noise_mg || arguments.text("noise-mg")) {
        throw InputError("noise_mg is of a plant's own accelerometer; with a board [noise] of the "
                         "plant says it for each sensor");
    }
}

} // namespace

RunSetup run_setup(const Arguments &arguments) {
    return setup_of(arguments, load_scenario(arguments.required("scenario")));
}

RunSetup setup_of(const Arguments &arguments, Scenario scenario) {
    RunSetup setup{};
    setup.scenario = std::move(scenario);
    const auto given_plant = arguments.text("plant");
    setup.plant = load_plant(given_plant ? *given_plant : plant_of(setup.scenario));
    require_base(setup.scenario, setup.plant);
    const auto given_board = arguments.text("board");
    const std::string board = given_board ? *given_board : board_of(setup.scenario);
    quiesce_params_default(&setup.params);
    arguments.required("law");
    if (board.empty()) {
        require_board_for(setup.plant);
        fit_to_sensor(setup.params, setup.plant.sensor);
        setup.params = params_from(arguments, setup.params);
    } else {
        setup.rig = make_rig(load_board(board), setup.plant);
        refuse_noise(arguments, setup.scenario);
        setup.params = params_for_board(arguments, setup.params);
        require_signals(setup.rig->file, setup.params);
    }
    apply_overrides(arguments, setup);
    return setup;
}

RunSetup setup_of_plant(const Arguments &arguments, const std::string &name) {
    Scenario scenario{};
    scenario.name = name;
    scenario.plant_file = arguments.required("plant");
    scenario.duration_s = static_cast<double>(std::numeric_limits<float>::max());
    scenario.seed = 1;
    scenario.feed_current = true;
    return setup_of(arguments, std::move(scenario));
}

Tables tables_from(const Arguments &arguments, const quiesce_board_t *board,
                   const quiesce_params_t &params) {
    const auto file = [&arguments](const char *option) {
        return arguments.text(option).value_or("");
    };
    const TableFiles files = {file("rules"), file("pulses"), file("law-table"), file("force-map")};
    require_tables(board, params, files);
    return tables_for(board, params, load_tables(files));
}

std::unique_ptr<ControllerLink> target_link(const Arguments &arguments) {
    LinkOptions options;
    options.image_path = arguments.text("image").value_or("");
    options.plugin_path = arguments.text("plugin").value_or("");
    options.can_channel = arguments.text("can").value_or("");
    options.telemetry_every_ticks = arguments.integer("telemetry-every", 1, UINT16_MAX);
    options.greeting_time_s = arguments.number("wait-s", 0.1, 3600.0);
    return make_link(arguments.text("target").value_or("host"), options);
}

} // namespace quiesce
