#include "tick_columns.h"

#include <algorithm>
#include <numeric>
#include <sstream>

#include "input_error.h"
#include "reply_fields.h"

namespace quiesce {

namespace {

enum Column : std::size_t { kTime, kCounts, kFlags, kTelemetry };

const std::vector<std::string> &all_names() {
    static const std::vector<std::string> names =
        with_telemetry_columns({"t_s", "accel_counts", "flags"});
    return names;
}

std::size_t index_of(const std::string &name) {
    const std::vector<std::string> &names = all_names();
    const auto found = std::find(names.begin(), names.end(), name);
    if (found != names.end()) {
        return static_cast<std::size_t>(found - names.begin());
    }
    std::string known;
    for (const std::string &each : names) {
        known += (known.empty() ? "" : ", ") + each;
    }
    throw InputError("--columns: no column '" + name + "'; there are: " + known);
}

double value_of(std::size_t column, double time_s, const lockstep_stimulus_t &stimulus,
                const quiesce_telemetry_t &telemetry) {
    switch (column) {
    case kTime:
        return time_s;
    case kCounts:
        return stimulus.accel_counts;
    case kFlags:
        return stimulus.flags;
    default:
        return telemetry_value(telemetry, column - kTelemetry);
    }
}

} // namespace

TickColumns::TickColumns(const std::optional<std::string> &list) {
    if (!list) {
        chosen_.resize(all_names().size());
        std::iota(chosen_.begin(), chosen_.end(), std::size_t{0});
        return;
    }
    std::istringstream in(*list);
    for (std::string name; std::getline(in, name, ',');) {
        chosen_.push_back(index_of(name));
    }
    if (chosen_.empty()) {
        throw InputError("--columns: expected names separated by commas");
    }
}

std::vector<std::string> TickColumns::names() const {
    std::vector<std::string> names;
    names.reserve(chosen_.size());
    for (const std::size_t index : chosen_) {
        names.push_back(all_names()[index]);
    }
    return names;
}

void TickColumns::put(double time_s, const lockstep_stimulus_t &stimulus,
                      const quiesce_telemetry_t &telemetry, Trace &trace) const {
    for (const std::size_t column : chosen_) {
        trace.put(value_of(column, time_s, stimulus, telemetry));
    }
}

} // namespace quiesce
