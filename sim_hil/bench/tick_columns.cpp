#include "tick_columns.h"

#include <algorithm>
#include <cstddef>
#include <numeric>
#include <sstream>

#include "input_error.h"
#include "reply_fields.h"

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

constexpr std::size_t kTelemetryWord = offsetof(lockstep_reply_t, telemetry) / 4;
constexpr std::size_t kReportWord = offsetof(lockstep_reply_t, report) / 4;

double value_of(const lockstep_reply_t &reply, std::size_t index) {
    const std::uint32_t word = word_of(reply, index);
    return reply_fields()[index].is_signed ? static_cast<double>(static_cast<std::int32_t>(word))
                                           : static_cast<double>(word);
}

} // namespace

std::uint32_t traced_flags(std::uint32_t flags) {
    constexpr std::uint32_t kInputs = LOCKSTEP_ENABLE | LOCKSTEP_ESTOP | LOCKSTEP_FAULT_RESET;
    return (flags & kInputs) | ((flags & LOCKSTEP_FRESH) != 0 ? 1u : 0u) |
           ((flags & LOCKSTEP_HAS_CURRENT) != 0 ? 16u : 0u);
}

TickColumns::TickColumns(std::vector<std::string> own, std::int32_t law,
                         const std::optional<std::string> &list)
    : own_count_(own.size()), all_names_(std::move(own)) {
    for (std::size_t i = kTelemetryWord; i < kReportWord; ++i) {
        all_names_.push_back(reply_fields()[i].name);
        words_.push_back(i);
    }
    const quiesce_word_t *reports = quiesce_report_words(law);
    for (std::size_t i = 0; i < QUIESCE_REPORT_WORDS && reports[i].name != nullptr; ++i) {
        all_names_.emplace_back(reports[i].name);
        words_.push_back(kReportWord + i);
    }
    choose(list);
}

void TickColumns::choose(const std::optional<std::string> &list) {
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

void TickColumns::put(std::initializer_list<double> own, const lockstep_reply_t &reply,
                      Trace &trace) const {
    for (const std::size_t column : chosen_) {
        trace.put(column < own_count_ ? own.begin()[column]
                                      : value_of(reply, words_[column - own_count_]));
    }
}

} // namespace quiesce
