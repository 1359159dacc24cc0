/// A scenario: which plant, how it is shaken, what goes wrong when, and where to measure.
#ifndef QUIESCE_SCENARIO_H
#define QUIESCE_SCENARIO_H

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "excitation.h"
#include "segment_section.h"

namespace quiesce {

enum class FaultKind {
    dropout,      ///< no fresh sample
    stuck,        ///< the last sample again and again
    saturate,     ///< samples at positive full scale
    range,        ///< samples beyond full scale
    estop,        ///< emergency stop pressed
    fault_reset,  ///< operator lets enable go and acknowledges
    disable,      ///< operator withdraws the enable
    lost_tick,    ///< the controller does not get to run
    coil_open,    ///< no current flows
    driver_stuck, ///< the driver keeps its last output
};

/// Present in the ticks that begin in [start_s, start_s + duration_s).
struct InjectedFault {
    FaultKind kind;
    double start_s;
    double duration_s;
    std::string
        of{}; ///< name of a board's sensor or damper; "": the tracked sensor, the first damper
};

/// What files call the kinds, in their order.
const std::vector<std::string> &fault_names();

/// One that begins at start_s: the keys kind, duration_s and of. Others are left for the caller.
InjectedFault read_fault(TomlTable &table, double start_s);

/// Whether it befalls a damper; else a sensor, or nothing in particular.
bool befalls_damper(FaultKind kind);

/// A stretch of time in which steady state is measured.
struct Window {
    double start_s;
    double end_s;
};

/// A change of the excitation, and what is measured after it.
struct Transient {
    double start_s;
    double disp_end_s; ///< RMS displacement is taken from start_s to here
};

struct Scenario {
    std::string file; ///< it was read from
    std::string name;
    std::string plant_file; ///< relative paths resolved against the scenario's own folder
    std::string board_file; ///< likewise; "": the plant's one sensor and one damper
    double duration_s;
    std::optional<double> drive_V; ///< in place of the plant's
    std::optional<double> noise_mg;
    std::uint64_t seed;
    bool feed_current; ///< the controller gets the measured coil current
    std::vector<SegmentSpec> segments;
    std::vector<InjectedFault> faults;
    std::vector<Window> windows; ///< 1 .. 8
    std::optional<Transient> transient;
};

/// Reads TOML, schema "quiesce-scenario" version 1 (docs/howto/describe-a-plant.md has the table of
/// keys). Throws InputError naming file, line, key, what is wrong and what is allowed.
Scenario load_scenario(const std::string &file);

/// The file that its key "plant" or "board" names ("" without a board). Throws InputError, which
/// names the scenario, the key and the file, where there is none.
std::string plant_of(const Scenario &scenario);
std::string board_of(const Scenario &scenario);

/// Some segment shakes the base: by itself, or through a shaker that does.
bool moves_base(const Scenario &scenario, const ShakerParams &shaker);

/// The scenario's excitation on this shaker.
Excitation make_excitation(const Scenario &scenario, const ShakerParams &shaker);

} // namespace quiesce

#endif
