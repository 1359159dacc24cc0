#include "scenario.h"

#include <algorithm>
#include <filesystem>

#include "input_error.h"
#include "toml_table.h"

namespace quiesce {

namespace {

constexpr std::size_t kMostWindows = 8;
constexpr double kLongest_s = 1e5;

/// In the order of FaultKind.
const std::vector<std::string> kFaultNames = {"dropout",   "stuck",       "saturate", "range",
                                              "estop",     "fault_reset", "disable",  "lost_tick",
                                              "coil_open", "driver_stuck"};

FaultKind read_fault_kind(TomlTable &table) {
    const std::string name = table.choice("kind", kFaultNames);
    std::size_t index = 0;
    while (kFaultNames[index] != name) {
        ++index;
    }
    return static_cast<FaultKind>(index);
}

InjectedFault read_placed_fault(TomlTable &table, double end_s) {
    const double start_s = table.number("t_s", {0.0, end_s, "s"});
    InjectedFault fault = read_fault(table, start_s);
    table.reject_unknown_keys();
    return fault;
}

std::vector<SegmentSpec> read_segments(TomlTable &root, double end_s) {
    std::vector<TomlTable> tables = root.tables("segment");
    if (tables.empty()) {
        root.fail("segment", "expected at least one table [[segment]]: what shakes the structure");
    }
    std::vector<SegmentSpec> segments;
    double covered_s = 0.0;
    for (std::size_t i = 0; i < tables.size(); ++i) {
        segments.push_back(read_segment(tables[i], i + 1 == tables.size()));
        covered_s += segments.back().duration_s;
    }
    if (covered_s < end_s * (1.0 - 1e-9)) {
        root.fail("segment", "the segments end at " + std::to_string(covered_s) +
                                 " s, before duration_s; expected them to cover it");
    }
    return segments;
}

Window read_window(TomlTable &table, double end_s) {
    Window window{};
    window.start_s = table.number("start_s", {0.0, end_s, "s"});
    window.end_s = table.number("end_s", {window.start_s + 1e-3, end_s, "s, after start_s"});
    table.reject_unknown_keys();
    return window;
}

std::vector<Window> read_windows(TomlTable &root, double end_s) {
    std::vector<Window> windows;
    for (TomlTable &table : root.tables("window")) {
        windows.push_back(read_window(table, end_s));
    }
    if (windows.size() > kMostWindows) {
        root.fail("window",
                  "expected at most " + std::to_string(kMostWindows) + " tables [[window]]");
    }
    if (windows.empty()) {
        constexpr double kDefault_s = 2.0;
        windows.push_back({std::max(0.0, end_s - kDefault_s), end_s});
    }
    return windows;
}

std::optional<Transient> read_transient(TomlTable &root, double end_s) {
    std::optional<TomlTable> table = root.optional_table("transient");
    if (!table) {
        return std::nullopt;
    }
    Transient transient{};
    transient.start_s = table->number("start_s", {0.0, end_s, "s"});
    transient.disp_end_s =
        table->number("disp_end_s", {transient.start_s + 1e-3, end_s, "s, after start_s"});
    table->reject_unknown_keys();
    return transient;
}

} // namespace

namespace {

const std::string &named(const Scenario &scenario, const char *key, const std::string &file) {
    std::error_code unreadable;
    if (!std::filesystem::is_regular_file(file, unreadable)) {
        throw InputError(scenario.file + ": " + key + ": there is no file " + file +
                         "; name one that is there, by its path from the folder of this file");
    }
    return file;
}

} // namespace

const std::vector<std::string> &fault_names() {
    return kFaultNames;
}

InjectedFault read_fault(TomlTable &table, double start_s) {
    InjectedFault fault{};
    fault.kind = read_fault_kind(table);
    fault.start_s = start_s;
    fault.duration_s = table.number("duration_s", {1e-4, kLongest_s, "s"});
    if (table.has("of")) {
        fault.of = table.text("of");
    }
    return fault;
}

bool befalls_damper(FaultKind kind) {
    return kind == FaultKind::coil_open || kind == FaultKind::driver_stuck;
}

Scenario load_scenario(const std::string &file) {
    const TomlFile toml(file, "quiesce-scenario", 1);
    const std::filesystem::path folder = std::filesystem::path(file).parent_path();
    TomlTable root = toml.root();
    root.text("schema");
    root.integer("version", 1, 1);
    Scenario scenario{};
    scenario.file = file;
    scenario.name = root.text("name");
    scenario.plant_file = (folder / root.text("plant")).lexically_normal().string();
    if (root.has("board")) {
        scenario.board_file = (folder / root.text("board")).lexically_normal().string();
    }
    scenario.duration_s = root.number("duration_s", {0.1, kLongest_s, "s"});
    if (root.has("drive_V")) {
        scenario.drive_V = root.number("drive_V", {0.0, 1e6, "V"});
    }
    if (root.has("noise_mg")) {
        scenario.noise_mg = root.number("noise_mg", {0.0, 1e4, "mg RMS per sample"});
    }
    scenario.seed = static_cast<std::uint64_t>(root.integer("seed", 0, INT64_MAX, 1));
    scenario.feed_current = root.boolean("feed_current", false);
    scenario.segments = read_segments(root, scenario.duration_s);
    for (TomlTable &table : root.tables("fault")) {
        scenario.faults.push_back(read_placed_fault(table, scenario.duration_s));
    }
    scenario.windows = read_windows(root, scenario.duration_s);
    scenario.transient = read_transient(root, scenario.duration_s);
    root.reject_unknown_keys();
    return scenario;
}

std::string plant_of(const Scenario &scenario) {
    return named(scenario, "plant", scenario.plant_file);
}

std::string board_of(const Scenario &scenario) {
    return scenario.board_file.empty() ? "" : named(scenario, "board", scenario.board_file);
}

bool moves_base(const Scenario &scenario, const ShakerParams &shaker) {
    return std::any_of(scenario.segments.begin(), scenario.segments.end(),
                       [&](const SegmentSpec &segment) {
                           return segment.by == ShakenBy::base ||
                                  (segment.by == ShakenBy::shaker && shaker.moves_base);
                       });
}

Excitation make_excitation(const Scenario &scenario, const ShakerParams &shaker) {
    Excitation excitation;
    for (const SegmentSpec &spec : scenario.segments) {
        excitation.append(spec.make(shaker), spec.duration_s);
    }
    return excitation;
}

} // namespace quiesce
