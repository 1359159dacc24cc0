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
constexpr std::size_t kPictureWord = offsetof(lockstep_reply_t, picture) / 4;

/// The words of the picture by the names of a board: "body1_accel_um_s2" is roof_accel_um_s2.
void append_picture(const BoardFile &board, std::vector<ReplyColumn> &out) {
    const auto append = [&out](const std::string &numbered, const std::string &name) {
        for (std::size_t i = kPictureWord; i < reply_fields().size(); ++i) {
            const std::string &field = reply_fields()[i].name;
            if (field.rfind(numbered, 0) == 0) {
                out.push_back({name + field.substr(numbered.size()), i});
            }
        }
    };
    append("valid_", "valid_");
    for (std::size_t i = 0; i < board.bodies.size(); ++i) {
        append("body" + std::to_string(i) + "_", board.bodies[i] + "_");
    }
    for (std::size_t i = 0; i < board.dampers.size(); ++i) {
        append("damper" + std::to_string(i) + "_", board.dampers[i] + "_");
    }
}

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

std::vector<ReplyColumn> controller_columns(std::int32_t law, const BoardFile *board) {
    std::vector<ReplyColumn> out;
    for (std::size_t i = kTelemetryWord; i < kReportWord; ++i) {
        out.push_back({reply_fields()[i].name, i});
    }
    const quiesce_word_t *reports = quiesce_report_words(law);
    for (std::size_t i = 0; i < QUIESCE_REPORT_WORDS && reports[i].name != nullptr; ++i) {
        out.push_back({reports[i].name, kReportWord + i});
    }
    if (board != nullptr) {
        append_picture(*board, out);
    }
    return out;
}

TickColumns::TickColumns(std::vector<std::string> own, const std::vector<ReplyColumn> &controller,
                         const std::optional<std::string> &list)
    : own_count_(own.size()), all_names_(std::move(own)) {
    for (const ReplyColumn &column : controller) {
        all_names_.push_back(column.name);
        words_.push_back(column.word);
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

void TickColumns::put(const std::vector<double> &own, const lockstep_reply_t &reply,
                      Trace &trace) const {
    for (const std::size_t column : chosen_) {
        trace.put(column < own_count_ ? own[column] : value_of(reply, words_[column - own_count_]));
    }
}

} // namespace quiesce
