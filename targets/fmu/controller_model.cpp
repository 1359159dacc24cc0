/// The controller as an FMU: the firmware itself, its tick as it runs on a target. A NaN of a
/// sensor is no sample.
#include <algorithm>
#include <array>
#include <cmath>

#include "in_process_link.h"
#include "param_options.h"
#include "plant_file.h"
#include "reply_fields.h"
#include "resources.h"
#include "rig.h"
#include "run_options.h"
#include "sensor_values.h"
#include "start.h"
#include "tick_columns.h"

namespace quiesce {

namespace {

struct ControllerSetup {
    std::optional<BoardFile> board;
    quiesce_params_t params;
    Tables tables;

    const quiesce_board_t *board_or_null() const { return board ? &board->board : nullptr; }
};

ControllerSetup controller_setup(const Arguments &arguments) {
    ControllerSetup setup{};
    quiesce_params_default(&setup.params);
    if (const auto board = arguments.text("board")) {
        setup.board = load_board(*board);
        setup.params = params_for_board(arguments, setup.params);
        require_signals(*setup.board, setup.params);
    } else {
        if (const auto plant = arguments.text("plant")) {
            fit_to_sensor(setup.params, load_plant(*plant).sensor);
        }
        setup.params = params_from(arguments, setup.params);
    }
    setup.tables = tables_from(arguments, setup.board_or_null(), setup.params);
    return setup;
}

/// What decides the model itself stays as it was packed.
bool is_packed(const std::string &name) {
    return name == "tick_rate_Hz" || name == "law" || name == "tracker" || is_of_board(name);
}

class ControllerFmu final : public FmuModel {
  public:
    explicit ControllerFmu(ControllerSetup setup);

  private:
    struct DamperPort {
        std::size_t current_meas, is_measured;
        std::size_t current_cmd, enable;
    };
    struct Param {
        std::size_t variable;
        std::uint32_t index;
    };

    void declare_sensors();
    void declare_damper(const std::string &name, bool is_measured);
    void declare_operator();
    void declare_telemetry();
    void declare_params();
    bool is_due_at_its_start() const override { return true; }
    void start() override;
    void tick() override;
    void tuned(std::size_t index) override;
    void visit_state(StateArchive &archive) override;
    quiesce_params_t params_as_set() const;
    lockstep_stimulus_t stimulus() const;
    void show();

    ControllerSetup setup_;
    SensorValues sensor_values_;
    std::vector<std::size_t> sensors_; ///< variables of their values, each followed by its is_fresh
    std::vector<DamperPort> dampers_;
    std::size_t operator_ = 0; ///< enable, then estop, fault_reset, arm_at_start
    std::vector<std::pair<std::size_t, std::size_t>> words_; ///< variable and word of the reply
    std::vector<Param> params_;
    std::array<std::size_t, 3> told_{}; ///< freq_Hz, rms_m_s2, displacement_m

    InProcessLink link_;
    lockstep_reply_t reply_{};
};

ControllerFmu::ControllerFmu(ControllerSetup setup)
    : FmuModel(setup.params.tick_rate_Hz), setup_(std::move(setup)),
      sensor_values_(setup_.board ? SensorValues(*setup_.board) : SensorValues(setup_.params)) {
    declare_sensors();
    if (setup_.board) {
        for (std::size_t i = 0; i < setup_.board->dampers.size(); ++i) {
            declare_damper("damper." + setup_.board->dampers[i],
                           setup_.board->board.damper[i].measures_current != 0);
        }
    } else {
        declare_damper("damper", false);
    }
    declare_operator();
    declare_telemetry();
    declare_params();
}

void ControllerFmu::declare_sensors() {
    for (const SensorPort &port : sensor_values_.ports()) {
        sensors_.push_back(
            declare({port.name, VariableType::real, Causality::input, Variability::continuous,
                     port.unit, port.description + "; NaN: no sample"}));
        declare({port.fresh_name, VariableType::boolean, Causality::input, Variability::discrete,
                 "", "false: no sample", 1.0});
    }
}

void ControllerFmu::declare_damper(const std::string &name, bool is_measured) {
    DamperPort port{};
    port.current_meas =
        declare({name + ".current_A", VariableType::real, Causality::input, Variability::continuous,
                 "A", "measured in its coil; NaN: no measurement"});
    port.is_measured =
        declare({name + ".current_is_measured", VariableType::boolean, Causality::input,
                 Variability::discrete, "", "false: no measurement", is_measured ? 1.0 : 0.0});
    port.current_cmd = declare({name + ".current_cmd_A", VariableType::real, Causality::output,
                                Variability::continuous, "A", "for its driver"});
    port.enable = declare({name + ".driver_enable", VariableType::boolean, Causality::output,
                           Variability::discrete, "", "false: the driver is to be off"});
    dampers_.push_back(port);
}

void ControllerFmu::declare_operator() {
    const auto button = [this](const char *name, const char *what, double start) {
        return declare({name, VariableType::boolean, Causality::input, Variability::discrete, "",
                        what, start});
    };
    operator_ = button("enable", "operator enables the output; its rising edge arms", 1.0);
    button("estop", "emergency stop", 0.0);
    button("fault_reset", "operator acknowledges a latched fault", 0.0);
    declare({"arm_at_start", VariableType::boolean, Causality::parameter, Variability::fixed, "",
             "an enable that is on from the start rises with the second tick, and so arms", 1.0});
}

void ControllerFmu::declare_telemetry() {
    const auto number = [this](const char *name, const char *unit, const char *what) {
        return declare(
            {name, VariableType::real, Causality::output, Variability::continuous, unit, what});
    };
    told_ = {number("freq_Hz", "Hz", "dominant frequency, where freq_is_valid"),
             number("rms_m_s2", "m/s2", "windowed RMS of the tracked acceleration"),
             number("displacement_m", "m", "of the tracked place, from its acceleration")};
    for (const ReplyColumn &column : controller_columns(setup_.params.law, nullptr)) {
        words_.emplace_back(declare({column.name, VariableType::integer, Causality::output,
                                     Variability::discrete, "", "word of telemetry"}),
                            column.word);
    }
}

void ControllerFmu::declare_params() {
    for (std::uint32_t i = 0; i < QUIESCE_PARAM_COUNT; ++i) {
        const quiesce_param_info_t &info = *quiesce_param_info(i);
        if (is_packed(info.name)) {
            continue;
        }
        std::int32_t now = 0;
        quiesce_param_get(&setup_.params, i, &now);
        std::string what = info.labels == nullptr ? "parameter" : "";
        for (std::int32_t label = 0; info.labels != nullptr && label <= info.max; ++label) {
            what += (label > 0 ? ", " : "") + std::to_string(label) + " " + info.labels[label];
        }
        params_.push_back({declare({std::string("param.") + info.name, VariableType::integer,
                                    Causality::parameter,
                                    info.is_live ? Variability::tunable : Variability::fixed, "",
                                    what, static_cast<double>(now), static_cast<double>(info.min),
                                    static_cast<double>(info.max)}),
                           i});
    }
}

quiesce_params_t ControllerFmu::params_as_set() const {
    quiesce_params_t params = setup_.params;
    for (const Param &param : params_) {
        quiesce_param_set(&params, param.index, static_cast<std::int32_t>(value(param.variable)));
    }
    require_accepted(params);
    return params;
}

void ControllerFmu::start() {
    start_controller(link_, setup_.board_or_null(), params_as_set(), setup_.tables);
    reply_ = lockstep_reply_t{};
    show();
}

void ControllerFmu::tuned(std::size_t /*index*/) {
    if (!link_.use_params(params_as_set())) {
        throw InputError("the controller refuses other parameters now: its start was refused");
    }
}

lockstep_stimulus_t ControllerFmu::stimulus() const {
    lockstep_stimulus_t out{LOCKSTEP_REPORT, {0}, {0}};
    for (std::size_t i = 0; i < sensors_.size(); ++i) {
        if (is_set(sensors_[i] + 1) && !std::isnan(value(sensors_[i]))) {
            out.flags |= LOCKSTEP_FRESH << i;
            out.counts[i] = sensor_values_.counts_of(i, value(sensors_[i]));
        }
    }
    for (std::size_t i = 0; i < dampers_.size(); ++i) {
        const double current_mA = 1e3 * value(dampers_[i].current_meas);
        if (is_set(dampers_[i].is_measured) && !std::isnan(current_mA)) {
            out.flags |= LOCKSTEP_HAS_CURRENT << i;
            out.current_meas_mA[i] =
                static_cast<std::int32_t>(std::lround(std::min(std::max(current_mA, -1e9), 1e9)));
        }
    }
    const bool is_let_go = next_tick() == 0 && is_set(operator_ + 3);
    out.flags |= is_set(operator_) && !is_let_go ? LOCKSTEP_ENABLE : 0u;
    out.flags |= is_set(operator_ + 1) ? LOCKSTEP_ESTOP : 0u;
    out.flags |= is_set(operator_ + 2) ? LOCKSTEP_FAULT_RESET : 0u;
    return out;
}

void ControllerFmu::tick() {
    link_.exchange(stimulus(), reply_);
    show();
}

void ControllerFmu::show() {
    for (std::size_t i = 0; i < dampers_.size(); ++i) {
        put(dampers_[i].current_cmd, 1e-3 * reply_.current_cmd_mA[i]);
        put(dampers_[i].enable, (reply_.drivers_enabled >> i & 1u) != 0 ? 1.0 : 0.0);
    }
    put(told_[0], 1e-6 * reply_.telemetry.freq_uHz);
    put(told_[1], 1e-6 * reply_.telemetry.rms_um_s2);
    put(told_[2], 1e-9 * reply_.telemetry.displacement_nm);
    for (const auto &[variable, word] : words_) {
        put(variable, static_cast<std::int32_t>(word_of(reply_, word)));
    }
}

void ControllerFmu::visit_state(StateArchive &archive) {
    archive(reply_);
    link_.visit_state(archive);
}

} // namespace

std::unique_ptr<FmuModel> make_controller_model(const std::vector<std::string> &words) {
    const Arguments arguments("controller", words,
                              options({{"board", "plant", "law", "set"}, table_option_names()}));
    arguments.require_no_positional();
    if (arguments.text("board") && arguments.text("plant")) {
        throw InputError("--plant says what the one accelerometer is; a board says it, too");
    }
    return std::make_unique<ControllerFmu>(controller_setup(arguments));
}

} // namespace quiesce
