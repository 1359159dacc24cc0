#include "run_answer.h"

#include <algorithm>

#include "comparing_link.h"
#include "digest.h"
#include "in_process_link.h"
#include "input_error.h"
#include "metrics.h"
#include "param_options.h"
#include "rig_metrics.h"
#include "run_options.h"
#include "table_verdict.h"
#include "trace_observer.h"
#include "visits.h"

namespace quiesce {

namespace {

/// What was measured in one window, by name; freq_hz is the excitation's in its middle.
Json window_json(const Window &window, const WindowMetrics &measured,
                 const Excitation &excitation) {
    const std::optional<double> amplitude_m = measured.amplitude_m();
    return {{"start_s", window.start_s},
            {"end_s", window.end_s},
            {"freq_hz", excitation.at(0.5 * (window.start_s + window.end_s)).freq_Hz},
            {"amp_um", amplitude_m ? Json(1e6 * *amplitude_m) : Json()},
            {"disp_rms_um", 1e6 * measured.displacement_rms_m()},
            {"peak_disp_um", 1e6 * measured.peak_displacement_m()},
            {"accel_rms_mm_s2", 1e3 * measured.accel_rms_m_s2()},
            {"mean_current_A", measured.mean_current_A()},
            {"damper_work_J", measured.damper_work_J()}};
}

std::vector<Json> windows_json(const RunSetup &setup, const RunMetrics &metrics) {
    const Excitation excitation = make_excitation(setup.scenario, setup.plant.shaker);
    std::vector<Json> out;
    for (std::size_t i = 0; i < metrics.windows.size(); ++i) {
        out.push_back(window_json(setup.scenario.windows[i], metrics.windows[i], excitation));
    }
    return out;
}

/// The figures of a window once more beside those of the run: amp_um of the first window, amp2_um
/// of the second.
void add_window(Json &out, const std::vector<Json> &windows, std::size_t index) {
    const std::string number = index == 0 ? "" : std::to_string(index + 1);
    for (const auto &[name, unit] : {std::pair<const char *, const char *>{"freq", "_hz"},
                                     {"amp", "_um"},
                                     {"accel_rms", "_mm_s2"},
                                     {"disp_rms", "_um"},
                                     {"peak_disp", "_um"}}) {
        out.set(name + number + unit,
                index < windows.size() ? windows[index].at(std::string(name) + unit) : Json());
    }
}

Json run_json(const RunSetup &setup, const std::string &target, const RunMetrics &metrics,
              const DigestObserver &digest) {
    const std::vector<Json> windows = windows_json(setup, metrics);
    Json out = {
        {"scenario", setup.scenario.name}, {"law", law_label(setup.params)}, {"target", target}};
    add_window(out, windows, 0);
    add_window(out, windows, 1);
    out.set("mean_current_A", metrics.windows.back().mean_current_A());
    out.set("rms_disp_um", 1e6 * metrics.rms_displacement_m);
    out.set("damper_work_J", metrics.windows.back().damper_work_J());
    out.set("transient_peak_disp_um",
            metrics.transient_peak_m ? Json(1e6 * *metrics.transient_peak_m) : Json());
    out.set("settle_s", json_or_null(metrics.settle_s));
    out.set("windows", windows);
    out.set("faults", digest.fault_count());
    out.set("faults_seen", digest.faults_seen());
    out.set("distinct_commands", digest.distinct_commands());
    out.set("telemetry_crc32", digest.telemetry_crc32());
    out.set("seed", setup.seed);
    out.set("noise_mg", setup.plant.sensor.noise_mg);
    out.set("drive_V", setup.plant.shaker.drive_V);
    return out;
}

/// Of each body and damper of the board, by name, in each window.
void add_rig(Json &out, const RunSetup &setup, const RigMetrics &metrics) {
    std::vector<Json> windows;
    for (const RigWindow &window : metrics.windows()) {
        Json bodies(Json::object());
        for (std::size_t i = 0; i < window.bodies.size(); ++i) {
            const BodyMetrics &body = window.bodies[i];
            bodies.set(setup.rig->file.bodies[i],
                       {{"disp_rms_um", 1e6 * body.displacement_rms_m()},
                        {"peak_disp_um", 1e6 * body.peak_m},
                        {"accel_rms_mm_s2", 1e3 * body.accel_rms_m_s2()}});
        }
        Json dampers(Json::object());
        for (std::size_t i = 0; i < window.dampers.size(); ++i) {
            const DamperMetrics &damper = window.dampers[i];
            dampers.set(setup.rig->file.dampers[i],
                        {{"mean_current_A", damper.mean_current_A()},
                         {"peak_force_N", damper.peak_force_N},
                         {"peak_stroke_um", 1e6 * damper.peak_stroke_m}});
        }
        windows.push_back({{"start_s", window.window.start_s},
                           {"end_s", window.window.end_s},
                           {"bodies", bodies},
                           {"dampers", dampers}});
    }
    out.set("board", setup.rig->file.name);
    out.set("rig", windows);
}

/// Of the table that its law works with.
std::optional<TableRange> range_in_use(const RunSetup &setup) {
    const auto controller = controller_with(setup.board(), setup.params);
    const TableWords &given = setup.tables[QUIESCE_OF_LAW];
    const std::uint32_t *words =
        given.empty() ? quiesce_table_in_use(controller.get(), QUIESCE_OF_LAW) : given.data();
    return words == nullptr ? std::nullopt : range_of(words, setup.params.phase_setting);
}

Json span_json(const std::optional<Span> &span) {
    return span ? Json(std::vector<double>{span->low, span->high}) : Json();
}

/// What the law's table covers, where the run was, and what of that it does not cover.
void add_visits(RunAnswer &answer, const std::optional<TableRange> &range,
                const VisitObserver &visits) {
    Json &out = answer.json;
    answer.warnings = range ? warnings_of(*range, visits) : std::vector<std::string>();
    const bool is_known = visits.freq_Hz().count() > 0;
    const auto most = [is_known](const Spread &spread) {
        return is_known ? std::optional(spread.most()) : std::nullopt;
    };
    out.set("visited", {{"freq_Hz", span_json(most(visits.freq_Hz()))},
                        {"rms_m_s2", span_json(most(visits.rms_m_s2()))}});
    out.set("covered", range ? Json({{"kind", range->kind},
                                     {"freq_Hz", span_json(range->freq_Hz)},
                                     {"rms_m_s2", span_json(range->rms_m_s2)}})
                             : Json());
    out.set("warnings", answer.warnings);
}

void add_counts(Json &out, const std::optional<InstructionCounts> &counts) {
    out.set("instr_median", counts ? Json(counts->median) : Json());
    out.set("instr_worst", counts ? Json(counts->worst) : Json());
}

/// Runs it repeat times and returns the result with the fastest time. trace: records the last run;
/// none where it is null. visits: of the last run.
Json repeated_run(const RunSetup &setup, ControllerLink &link, std::int64_t repeat,
                  TraceObserver *trace, VisitObserver &visits) {
    Json out;
    RunTiming best{};
    for (std::int64_t i = 0; i < repeat; ++i) {
        MetricsObserver metrics(setup);
        DigestObserver digest;
        RigMetrics rig_metrics(setup);
        std::vector<TickObserver *> observers = {&metrics, &digest};
        if (setup.rig) {
            observers.push_back(&rig_metrics);
        }
        if (i + 1 == repeat) {
            observers.push_back(&visits);
            if (trace != nullptr) {
                observers.push_back(trace);
            }
        }
        const RunTiming timing = run_scenario(setup, link, observers);
        if (i == 0 || timing.wall_s < best.wall_s) {
            best = timing;
        }
        out = run_json(setup, link.target(), metrics.result(), digest);
        if (setup.rig) {
            add_rig(out, setup, rig_metrics);
        }
    }
    out.set("ticks", best.ticks);
    out.set("wall_s", best.wall_s);
    out.set("realtime_factor", best.realtime_factor);
    return out;
}

std::optional<TraceObserver> trace_from(const Arguments &arguments, const RunSetup &setup) {
    if (!arguments.text("trace")) {
        return std::nullopt;
    }
    return TraceObserver(setup.params.law, setup.rig_or_null(), arguments.text("columns"),
                         arguments.integer("every", 1, setup.tick_count()).value_or(1));
}

} // namespace

RunAnswer run_answer(const std::vector<std::string> &words) {
    const Arguments arguments("run", words,
                              options({run_option_names(),
                                       target_option_names(),
                                       table_option_names(),
                                       {"trace", "columns", "every", "repeat"}}));
    arguments.require_no_positional();
    RunSetup setup = run_setup(arguments);
    setup.tables = tables_from(arguments, setup.board(), setup.params);
    setup.wants_report = arguments.text("trace").has_value();
    setup.wants_picture = setup.wants_report && setup.rig.has_value();
    const std::int64_t repeat = arguments.integer("repeat", 1, 1000000).value_or(1);
    const std::unique_ptr<ControllerLink> link = target_link(arguments);
    // Words that the target does not send in a tick come from the host, which checks the others.
    InProcessLink host;
    ComparingLink checked(host, *link, Answer::Checked);
    const bool is_complete = link->is_complete() && (link->has_picture() || !setup.wants_picture);
    ControllerLink &driven = is_complete ? *link : static_cast<ControllerLink &>(checked);
    std::optional<TraceObserver> trace = trace_from(arguments, setup);
    VisitObserver visits;
    RunAnswer out{repeated_run(setup, driven, repeat, trace ? &*trace : nullptr, visits), {}};
    add_visits(out, range_in_use(setup), visits);
    out.json.set("mismatches", is_complete ? Json() : Json(checked.mismatches()));
    if (trace) {
        trace->trace().write(arguments.required("trace"));
    }
    add_counts(out.json, link->finish());
    return out;
}

} // namespace quiesce
