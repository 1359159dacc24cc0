/// replay: recorded accelerometer counts through the controller, without a plant.
#include <chrono>
#include <fstream>
#include <iostream>
#include <iterator>

#include <nlohmann/json.hpp>

#include "commands.h"
#include "digest.h"
#include "input_error.h"
#include "param_options.h"
#include "run_options.h"
#include "trace.h"

namespace quiesce {

namespace {

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

struct Replay {
    DigestObserver digest;
    Trace trace{with_telemetry_columns({"t_s", "accel_counts", "flags"})};
    double wall_s = 0.0;
};

void replay(const std::vector<std::int32_t> &counts, const quiesce_params_t &params,
            ControllerLink &link, Replay &out) {
    if (!link.start(params)) {
        throw InputError("the controller on target " + link.target() + " refuses its parameters");
    }
    const auto start = std::chrono::steady_clock::now();
    for (std::size_t tick = 0; tick < counts.size(); ++tick) {
        const lockstep_stimulus_t stimulus = {counts[tick], LOCKSTEP_FRESH | LOCKSTEP_ENABLE, 0};
        lockstep_reply_t reply{};
        link.exchange(stimulus, reply);
        out.digest.add(reply);
        out.trace.put(static_cast<double>(tick) / params.tick_rate_Hz);
        out.trace.put(stimulus.accel_counts);
        out.trace.put(stimulus.flags);
        out.trace.put_telemetry(reply.telemetry);
    }
    out.wall_s = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

} // namespace

int cmd_replay(const std::vector<std::string> &words) {
    const Arguments arguments("replay", words,
                              options({target_option_names(), {"counts", "law", "set", "trace"}}));
    arguments.require_no_positional();
    quiesce_params_t params;
    quiesce_params_default(&params);
    params = params_from(arguments, params);
    const std::vector<std::int32_t> counts = read_counts(arguments.required("counts"));
    const std::string trace_file = arguments.required("trace");
    const std::unique_ptr<ControllerLink> link = target_link(arguments);
    Replay result;
    replay(counts, params, *link, result);
    link->finish();
    result.trace.write(trace_file);
    const double duration_s = static_cast<double>(counts.size()) / params.tick_rate_Hz;
    const nlohmann::ordered_json out = {{"law", law_label(params)},
                                        {"target", link->target()},
                                        {"ticks", counts.size()},
                                        {"faults", result.digest.fault_count()},
                                        {"faults_seen", result.digest.faults_seen()},
                                        {"distinct_commands", result.digest.distinct_commands()},
                                        {"telemetry_crc32", result.digest.telemetry_crc32()},
                                        {"wall_s", result.wall_s},
                                        {"realtime_factor", duration_s / result.wall_s}};
    std::cout << out.dump() << '\n';
    return 0;
}

} // namespace quiesce
