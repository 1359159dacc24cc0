/// replay: recorded counts through the controller, without a plant: one record, or many short ones
/// with a fresh controller each. With a board a tick is a count of each of its sensors.
#include <chrono>
#include <fstream>
#include <iostream>
#include <iterator>
#include <optional>
#include <utility>

#include "board_file.h"
#include "commands.h"
#include "digest.h"
#include "input_error.h"
#include "json.h"
#include "param_options.h"
#include "rig.h"
#include "run_options.h"
#include "start.h"
#include "tick_columns.h"
#include "trace.h"

namespace quiesce {

namespace {

/// A count that no ADC reports: no sample came in this tick.
constexpr std::int32_t kNoSample = INT32_MIN;

std::int32_t little_endian(const unsigned char *bytes) {
    return static_cast<std::int32_t>(
        static_cast<std::uint32_t>(bytes[0]) | static_cast<std::uint32_t>(bytes[1]) << 8 |
        static_cast<std::uint32_t>(bytes[2]) << 16 | static_cast<std::uint32_t>(bytes[3]) << 24);
}

std::vector<std::int32_t> read_counts(const std::string &file) {
    std::ifstream in(file, std::ios::binary);
    const std::vector<char> bytes((std::istreambuf_iterator<char>(in)), {});
    if (in.bad() || bytes.empty() || bytes.size() % 4 != 0) {
        throw InputError("--counts " + file +
                         ": expected a file of 32-bit little-endian counts, at least one");
    }
    std::vector<std::int32_t> counts;
    counts.reserve(bytes.size() / 4);
    for (std::size_t i = 0; i < bytes.size(); i += 4) {
        counts.push_back(little_endian(reinterpret_cast<const unsigned char *>(&bytes[i])));
    }
    return counts;
}

/// One record after the other, all of the same length, and what of them is written.
struct Plan {
    std::optional<BoardFile> board;
    Tables tables;
    std::size_t sensors;      ///< counts in a tick
    bool counts_instructions; ///< of the control step: reports and pictures are not made then
    std::size_t record_ticks;
    std::size_t from_tick; ///< first tick of each record that is written
    std::size_t every;     ///< ticks from one row to the next
    TickColumns columns;
};

struct Replay {
    explicit Replay(const TickColumns &columns) : trace(columns.names()) {}

    DigestObserver digest;
    Trace trace;
    std::uint64_t faults = 0;
    double wall_s = 0.0;
};

/// The counts of one tick by the names of the sensors; one by its old name.
std::vector<std::string> own_names(const std::optional<BoardFile> &board) {
    std::vector<std::string> names = {"t_s", "accel_counts", "flags"};
    for (std::size_t i = 0; board && i < board->sensors.size(); ++i) {
        names.push_back(board->sensors[i] + "_counts");
    }
    return names;
}

std::size_t ticks_in(const std::vector<std::int32_t> &counts, std::size_t sensors) {
    if (counts.size() % sensors != 0) {
        throw InputError("--counts: " + std::to_string(counts.size()) +
                         " counts are not a whole number of ticks of " + std::to_string(sensors) +
                         " sensors");
    }
    return counts.size() / sensors;
}

Plan plan_from(const Arguments &arguments, std::optional<BoardFile> board, Tables tables,
               std::int32_t law, const std::vector<std::int32_t> &counts) {
    const std::size_t sensors = board ? board->sensors.size() : 1;
    const std::size_t ticks = ticks_in(counts, sensors);
    const auto limit = static_cast<std::int64_t>(ticks);
    const std::int64_t record_ticks = arguments.integer("record-ticks", 1, limit).value_or(limit);
    if (limit % record_ticks != 0) {
        throw InputError("--record-ticks " + std::to_string(record_ticks) + ": " +
                         std::to_string(ticks) + " counts are not a whole number of records");
    }
    TickColumns columns(own_names(board), controller_columns(law, board ? &*board : nullptr),
                        arguments.text("columns"));
    return {
        std::move(board),
        std::move(tables),
        sensors,
        arguments.text("plugin").has_value(),
        static_cast<std::size_t>(record_ticks),
        static_cast<std::size_t>(arguments.integer("from-tick", 0, record_ticks - 1).value_or(0)),
        static_cast<std::size_t>(arguments.integer("every", 1, record_ticks).value_or(1)),
        std::move(columns)};
}

/// What the sensors deliver for the counts of a tick.
lockstep_stimulus_t stimulus_of(const std::int32_t *counts, const Plan &plan, bool is_first) {
    lockstep_stimulus_t out = {is_first ? 0u : LOCKSTEP_ENABLE, {0}, {0}}; // its edge arms
    if (!plan.counts_instructions) {
        out.flags |= LOCKSTEP_REPORT | (plan.board ? LOCKSTEP_PICTURE : 0u);
    }
    for (std::size_t i = 0; i < plan.sensors; ++i) {
        if (counts[i] != kNoSample) {
            out.counts[i] = counts[i];
            out.flags |= LOCKSTEP_FRESH << i;
        }
    }
    return out;
}

std::vector<double> row_of(double time_s, const lockstep_stimulus_t &stimulus, const Plan &plan) {
    std::vector<double> row = {time_s, static_cast<double>(stimulus.counts[0]),
                               static_cast<double>(traced_flags(stimulus.flags))};
    for (std::size_t i = 0; plan.board && i < plan.sensors; ++i) {
        row.push_back(stimulus.counts[i]);
    }
    return row;
}

void replay_record(const std::int32_t *counts, const Plan &plan, std::int32_t tick_rate_Hz,
                   ControllerLink &link, Replay &out) {
    lockstep_reply_t reply{};
    std::size_t next_row = plan.from_tick;
    for (std::size_t tick = 0; tick < plan.record_ticks; ++tick) {
        const lockstep_stimulus_t stimulus =
            stimulus_of(&counts[tick * plan.sensors], plan, tick == 0);
        link.exchange(stimulus, reply);
        out.digest.add(reply);
        if (tick == next_row) {
            plan.columns.put(row_of(static_cast<double>(tick) / tick_rate_Hz, stimulus, plan),
                             reply, out.trace);
            next_row += plan.every;
        }
    }
    out.faults += reply.telemetry.fault_count;
}

/// Starts the controller anew for each record.
void replay(const std::vector<std::int32_t> &counts, const Plan &plan,
            const quiesce_params_t &params, ControllerLink &link, Replay &out) {
    const auto start = std::chrono::steady_clock::now();
    const std::size_t record_counts = plan.record_ticks * plan.sensors;
    for (std::size_t first = 0; first < counts.size(); first += record_counts) {
        start_controller(link, plan.board ? &plan.board->board : nullptr, params, plan.tables);
        replay_record(&counts[first], plan, params.tick_rate_Hz, link, out);
    }
    out.wall_s = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

} // namespace

int cmd_replay(const std::vector<std::string> &words) {
    const Arguments arguments("replay", words,
                              options({target_option_names(),
                                       table_option_names(),
                                       {"counts", "board", "law", "set", "trace", "record-ticks",
                                        "from-tick", "every", "columns"}}));
    arguments.require_no_positional();
    std::optional<BoardFile> board;
    if (const auto file = arguments.text("board")) {
        board = load_board(*file);
    }
    quiesce_params_t params;
    quiesce_params_default(&params);
    params = board ? params_for_board(arguments, params) : params_from(arguments, params);
    if (board) {
        require_signals(*board, params);
    }
    Tables tables = tables_from(arguments, board ? &board->board : nullptr, params);
    const std::vector<std::int32_t> counts = read_counts(arguments.required("counts"));
    const std::string trace_file = arguments.required("trace");
    const Plan plan = plan_from(arguments, std::move(board), std::move(tables), params.law, counts);
    const std::unique_ptr<ControllerLink> link = target_link(arguments);
    Replay result(plan.columns);
    replay(counts, plan, params, *link, result);
    const auto instructions = link->finish();
    result.trace.write(trace_file);
    const std::size_t ticks = counts.size() / plan.sensors;
    const double duration_s = static_cast<double>(ticks) / params.tick_rate_Hz;
    const Json out = {{"law", law_label(params)},
                      {"target", link->target()},
                      {"ticks", ticks},
                      {"records", ticks / plan.record_ticks},
                      {"faults", result.faults},
                      {"faults_seen", result.digest.faults_seen()},
                      {"distinct_commands", result.digest.distinct_commands()},
                      {"telemetry_crc32", result.digest.telemetry_crc32()},
                      {"wall_s", result.wall_s},
                      {"realtime_factor", duration_s / result.wall_s},
                      {"instr_median", instructions ? Json(instructions->median) : Json()},
                      {"instr_worst", instructions ? Json(instructions->worst) : Json()}};
    std::cout << out.dump() << '\n';
    return 0;
}

} // namespace quiesce
