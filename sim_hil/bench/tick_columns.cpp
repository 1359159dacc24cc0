#include "tick_columns.h"

#include <algorithm>
#include <numeric>
#include <sstream>

#include "input_error.h"

namespace quiesce {

namespace {

std::size_t index_of(const std::string &name, const std::vector<std::string> &names) {
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

} // namespace

TickColumns::TickColumns(std::vector<std::string> own, const std::optional<std::string> &list)
    : own_count_(own.size()), all_names_(with_telemetry_columns(std::move(own))) {
    if (!list) {
        chosen_.resize(all_names_.size());
        std::iota(chosen_.begin(), chosen_.end(), std::size_t{0});
        return;
    }
    std::istringstream in(*list);
    for (std::string name; std::getline(in, name, ',');) {
        chosen_.push_back(index_of(name, all_names_));
    }
    if (chosen_.empty()) {
        throw InputError("--columns: expected names separated by commas");
    }
}

std::vector<std::string> TickColumns::names() const {
    std::vector<std::string> names;
    names.reserve(chosen_.size());
    for (const std::size_t index : chosen_) {
        names.push_back(all_names_[index]);
    }
    return names;
}

void TickColumns::put(std::initializer_list<double> own, const quiesce_telemetry_t &telemetry,
                      Trace &trace) const {
    for (const std::size_t column : chosen_) {
        trace.put(column < own_count_ ? own.begin()[column]
                                      : telemetry_value(telemetry, column - own_count_));
    }
}

} // namespace quiesce
