#include "live_session.h"

#include <algorithm>
#include <utility>

#include "input_error.h"
#include "param_options.h"
#include "run_options.h"
#include "start.h"
#include "toml_table.h"

namespace quiesce {

namespace {

constexpr Range kDrive = {0.0, 1e6, "V"};
constexpr Range kGravity = {-1.0, 1.0, "g"};

Json rms_json(const std::optional<VibrationRms> &rms) {
    return rms ? Json({{"displacement_um", 1e6 * rms->displacement_m},
                       {"accel_m_s2", rms->accel_m_s2}})
               : Json();
}

/// Those that are not at their defaults.
Json changed_json(const quiesce_params_t &params) {
    Json out = Json::object();
    for (std::uint32_t index = 0; index < QUIESCE_PARAM_COUNT; ++index) {
        const quiesce_param_info_t &info = *quiesce_param_info(index);
        std::int32_t value = 0;
        if (quiesce_param_get(&params, index, &value) && value != info.default_value) {
            out.set(info.name, value);
        }
    }
    return out;
}

/// A segment by itself, as a scenario has it.
Scenario only(const Scenario &like, const SegmentSpec &segment) {
    Scenario out = like;
    out.segments = {segment};
    out.faults.clear();
    return out;
}

} // namespace

/// What a line asks for.
struct LiveSession::Order {
    std::optional<bool> control;
    std::optional<double> drive_V;
    std::optional<double> gravity_g;
    std::optional<SegmentSpec> excite;
    std::optional<PlacedFault> fault;
    bool clears_faults = false;
};

LiveSession::LiveSession(RunSetup setup, LiveLink &link, bool is_enabled, std::int64_t now_ns)
    : setup_(std::move(setup)), link_(link), pace_(setup_.params.tick_rate_Hz, now_ns),
      vibration_(setup_.params.tick_rate_Hz) {
    start_controller(link_, setup_.board(), setup_.params, setup_.tables);
    loop_ = std::make_unique<Loop>(setup_, link_);
    loop_->enable(is_enabled);
    vibration_.control(is_enabled);
}

void LiveSession::tick(std::int64_t now_ns) {
    pace_.begin(now_ns);
    link_.pace().lateness_us = static_cast<std::uint32_t>(pace_.lateness_us());
    link_.pace().overruns = pace_.overruns();
    try {
        loop_->tick({&digest_, &vibration_});
    } catch (const TargetGone &) {
        throw;
    } catch (const InputError &error) {
        stand_still(error.what());
    }
    pace_.shift(link_.shift_ns());
    if (link_.tick_rate_Hz() != setup_.params.tick_rate_Hz) { // somebody on the bus has
        setup_.params.tick_rate_Hz = link_.tick_rate_Hz();
        pace_.change_rate(setup_.params.tick_rate_Hz, now_ns);
        begin_anew();
    }
}

bool LiveSession::is_state_due(int times_per_s) const {
    return pace_.ticks() % std::max(1, setup_.params.tick_rate_Hz / times_per_s) == 0;
}

/// The plant at rest; the controller goes on.
void LiveSession::begin_anew() {
    const bool is_enabled = loop_->is_enabled();
    loop_ = std::make_unique<Loop>(setup_, link_);
    loop_->enable(is_enabled);
    vibration_ = Vibration(setup_.params.tick_rate_Hz);
    vibration_.control(is_enabled);
}

/// A drive that is too strong for the rig is no reason to end.
void LiveSession::stand_still(const std::string &why) {
    halt_ = why;
    setup_.plant.shaker.drive_V = 0.0;
    setup_.scenario = only(setup_.scenario, lasting_sine(setup_.plant.shaker.ref_freq_Hz));
    begin_anew();
}

/// segment: may be one of the scenario that it replaces.
void LiveSession::play(const SegmentSpec &segment) {
    loop_->excite(segment.make(setup_.plant.shaker));
    setup_.scenario = only(setup_.scenario, segment);
    vibration_.excitation_changed();
}

LiveSession::Order LiveSession::order_of(const std::string &line) {
    const TomlFile toml = TomlFile::of_text("order = {" + line + "}", "rig");
    TomlTable everything = toml.root();
    TomlTable root = everything.table("order");
    everything.reject_unknown_keys();
    for (const char *key : {"control", "drive_V", "gravity_g", "excite", "fault", "clear_faults"}) {
        root.accept(key);
    }
    root.reject_unknown_keys();
    Order order;
    if (root.has("control")) {
        order.control = root.boolean("control", false);
    }
    if (root.has("drive_V")) {
        order.drive_V = root.number("drive_V", kDrive);
    }
    if (root.has("gravity_g")) {
        order.gravity_g = root.number("gravity_g", kGravity);
    }
    if (std::optional<TomlTable> table = root.optional_table("excite")) {
        order.excite = read_segment(*table, true);
        require_base(only(setup_.scenario, *order.excite), setup_.plant);
    }
    if (std::optional<TomlTable> table = root.optional_table("fault")) {
        Scenario one = setup_.scenario;
        one.faults = {read_fault(*table, loop_->time_s())};
        table->reject_unknown_keys();
        order.fault = place_faults(one, setup_.rig_or_null()).front();
    }
    order.clears_faults = root.boolean("clear_faults", false);
    return order;
}

void LiveSession::obey(const std::string &line) {
    const Order order = order_of(line);
    halt_.clear();
    if (order.control) {
        loop_->enable(*order.control);
        vibration_.control(*order.control);
    }
    if (order.clears_faults) {
        loop_->faults().clear(loop_->time_s());
    }
    if (order.fault) {
        loop_->faults().add(*order.fault);
    }
    if (order.drive_V) {
        setup_.plant.shaker.drive_V = *order.drive_V;
    }
    if (order.gravity_g) {
        loop_->lie(kGravity_m_s2 * *order.gravity_g);
    }
    if (order.excite || order.drive_V) {
        play(order.excite ? *order.excite : setup_.scenario.segments.back());
    }
}

Json LiveSession::introduction() const {
    const ShakerParams &shaker = setup_.plant.shaker;
    return {{"plant", setup_.plant.name},
            {"target", link_.target()},
            {"law", law_label(setup_.params)},
            {"params", changed_json(setup_.params)},
            {"tick_rate_Hz", setup_.params.tick_rate_Hz},
            {"faults", fault_names()},
            {"sensors", setup_.rig ? setup_.rig->file.sensors : std::vector<std::string>()},
            {"dampers", setup_.rig ? setup_.rig->file.dampers : std::vector<std::string>()},
            {"shaker",
             {{"ref_freq_Hz", shaker.ref_freq_Hz},
              {"drive_V", shaker.drive_V},
              {"moves_base", shaker.moves_base}}},
            {"has_base", !setup_.plant.structure.base_participation.isZero(0.0)},
            {"window_s", Vibration::kWindow_s}};
}

Json LiveSession::pace_json() const {
    const auto &bins = pace_.histogram();
    return {{"overruns", pace_.overruns()},
            {"lost_s", pace_.lost_s()},
            {"latest_us", pace_.latest_us()},
            {"work_us", link_.pace().work_us},
            {"late_below_2_to_i_us", std::vector<std::uint64_t>(bins.begin(), bins.end())}};
}

Json LiveSession::state() const {
    const double now_s = loop_->time_s();
    const ExcitationSample excitation = loop_->excitation();
    std::vector<std::string> present;
    for (const FaultKind kind : loop_->faults().present(now_s)) {
        present.push_back(fault_names()[static_cast<std::size_t>(kind)]);
    }
    return {{"time_s", now_s},
            {"ticks", pace_.ticks()},
            {"tick_rate_Hz", setup_.params.tick_rate_Hz},
            {"control", loop_->is_enabled()},
            {"excitation", setup_.scenario.segments.back().summary},
            {"freq_Hz", excitation.freq_Hz},
            {"drive_V", setup_.plant.shaker.drive_V},
            {"faults", present},
            {"halt", halt_},
            {"vibration",
             {{"now", rms_json(vibration_.now())},
              {"on", rms_json(vibration_.on())},
              {"off", rms_json(vibration_.off())}}},
            {"pace", pace_json()}};
}

Json LiveSession::summary() const {
    const bool is_all_told = link_.is_complete();
    return {{"ticks", pace_.ticks()},
            {"telemetry_crc32", is_all_told ? Json(digest_.telemetry_crc32()) : Json()},
            {"faults_seen", digest_.faults_seen()},
            {"pace", pace_json()}};
}

} // namespace quiesce
