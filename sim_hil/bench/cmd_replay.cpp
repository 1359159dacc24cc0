/// replay: recorded accelerometer counts through the controller, without a plant: one record, or
/// many short ones with a fresh controller each.
#include <chrono>
#include <fstream>
#include <iostream>
#include <iterator>

#include "commands.h"
#include "digest.h"
#include "input_error.h"
#include "json.h"
#include "param_options.h"
#include "run_options.h"
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

Plan plan_from(const Arguments &arguments, std::int32_t law, std::size_t ticks) {
    const auto limit = static_cast<std::int64_t>(ticks);
    const std::int64_t record_ticks = arguments.integer("record-ticks", 1, limit).value_or(limit);
    if (limit % record_ticks != 0) {
        throw InputError("--record-ticks " + std::to_string(record_ticks) + ": " +
                         std::to_string(ticks) + " counts are not a whole number of records");
    }
    return {
        static_cast<std::size_t>(record_ticks),
        static_cast<std::size_t>(arguments.integer("from-tick", 0, record_ticks - 1).value_or(0)),
        static_cast<std::size_t>(arguments.integer("every", 1, record_ticks).value_or(1)),
        TickColumns({"t_s", "accel_counts", "flags"}, law, arguments.text("columns"))};
}

/// What the sensor delivers for one count of the file.
lockstep_stimulus_t stimulus_of(std::int32_t counts) {
    const bool is_missing = counts == kNoSample;
    return {LOCKSTEP_ENABLE | LOCKSTEP_REPORT | (is_missing ? 0u : LOCKSTEP_FRESH),
            {is_missing ? 0 : counts},
            {0}};
}

void replay_record(const std::int32_t *counts, const Plan &plan, std::int32_t tick_rate_Hz,
                   ControllerLink &link, Replay &out) {
    lockstep_reply_t reply{};
    std::size_t next_row = plan.from_tick;
    for (std::size_t tick = 0; tick < plan.record_ticks; ++tick) {
        const lockstep_stimulus_t stimulus = stimulus_of(counts[tick]);
        link.exchange(stimulus, reply);
        out.digest.add(reply);
        if (tick == next_row) {
            plan.columns.put({static_cast<double>(tick) / tick_rate_Hz,
                              static_cast<double>(stimulus.counts[0]),
                              static_cast<double>(traced_flags(stimulus.flags))},
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
    for (std::size_t first = 0; first < counts.size(); first += plan.record_ticks) {
        if (!link.start(nullptr, params)) {
            throw InputError("the controller on target " + link.target() +
                             " refuses its parameters");
        }
        replay_record(&counts[first], plan, params.tick_rate_Hz, link, out);
    }
    out.wall_s = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

} // namespace

int cmd_replay(const std::vector<std::string> &words) {
    const Arguments arguments("replay", words,
                              options({target_option_names(),
                                       {"counts", "law", "set", "trace", "record-ticks",
                                        "from-tick", "every", "columns"}}));
    arguments.require_no_positional();
    quiesce_params_t params;
    quiesce_params_default(&params);
    params = params_from(arguments, params);
    const std::vector<std::int32_t> counts = read_counts(arguments.required("counts"));
    const std::string trace_file = arguments.required("trace");
    const Plan plan = plan_from(arguments, params.law, counts.size());
    const std::unique_ptr<ControllerLink> link = target_link(arguments);
    Replay result(plan.columns);
    replay(counts, plan, params, *link, result);
    link->finish();
    result.trace.write(trace_file);
    const double duration_s = static_cast<double>(counts.size()) / params.tick_rate_Hz;
    const Json out = {{"law", law_label(params)},
                      {"target", link->target()},
                      {"ticks", counts.size()},
                      {"records", counts.size() / plan.record_ticks},
                      {"faults", result.faults},
                      {"faults_seen", result.digest.faults_seen()},
                      {"distinct_commands", result.digest.distinct_commands()},
                      {"telemetry_crc32", result.digest.telemetry_crc32()},
                      {"wall_s", result.wall_s},
                      {"realtime_factor", duration_s / result.wall_s}};
    std::cout << out.dump() << '\n';
    return 0;
}

} // namespace quiesce
