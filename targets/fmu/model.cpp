#include "model.h"

#include <cmath>
#include <cstring>
#include <sstream>

#include "crc32.h"

namespace quiesce {

namespace {

/// What a time may be off a tick: times of importers are sums.
constexpr double kTickShare = 1e-6;

std::uint32_t crc_of(const std::uint8_t *bytes, std::size_t count) {
    std::vector<std::uint32_t> words(count / sizeof(std::uint32_t) +
                                     1); // the last one is filled up
    std::memcpy(words.data(), bytes, count);
    return crc32_of(words.data(), words.size());
}

/// Models whose names differ are not the same.
std::uint32_t crc_of_names(const std::vector<Variable> &variables) {
    std::string names;
    for (const Variable &variable : variables) {
        names += variable.name + '\n';
    }
    return crc_of(reinterpret_cast<const std::uint8_t *>(names.data()), names.size());
}

std::string limits_of(const Variable &variable) {
    std::ostringstream text;
    text.precision(10);
    text << variable.min.value_or(-INFINITY) << " .. " << variable.max.value_or(INFINITY);
    if (!variable.unit.empty()) {
        text << ' ' << variable.unit;
    }
    return text.str();
}

} // namespace

std::size_t FmuModel::declare(const Variable &variable) {
    variables_.push_back(variable);
    values_.push_back(variable.start);
    return variables_.size() - 1;
}

Variable &FmuModel::variable_of(std::size_t index, VariableType type) {
    if (index >= variables_.size()) {
        throw InputError("there is no value reference " + std::to_string(index));
    }
    if (variables_[index].type != type) {
        throw InputError(variables_[index].name + " is of another type");
    }
    return variables_[index];
}

double FmuModel::get(std::size_t index, VariableType type) {
    if (index == variables_.size() && type == VariableType::real) {
        return time_s_;
    }
    if (variable_of(index, type).causality == Causality::output && is_stale_) {
        if (is_running_) {
            evaluate();
        } else {
            start(); // as it would begin
        }
        is_stale_ = false;
    }
    return values_[index];
}

void FmuModel::set(std::size_t index, VariableType type, double value) {
    const Variable &variable = variable_of(index, type);
    if (variable.causality == Causality::output) {
        throw InputError(variable.name + " is an output");
    }
    if (is_running_ && variable.variability == Variability::fixed) {
        throw InputError(variable.name + " is fixed: it can be set before the start only");
    }
    // A number that is none is for the model to judge, where it may be any.
    if (value < variable.min.value_or(-INFINITY) || value > variable.max.value_or(INFINITY) ||
        (std::isnan(value) && variable.min)) {
        std::ostringstream text;
        text << variable.name << " = " << value << ": it may be " << limits_of(variable);
        throw InputError(text.str());
    }
    const double before = values_[index];
    values_[index] = value;
    is_stale_ = true;
    if (is_running_ && variable.causality == Causality::parameter) {
        try {
            tuned(index);
        } catch (const InputError &) {
            values_[index] = before;
            throw;
        }
    }
}

void FmuModel::begin() {
    start_s_ = time_s_;
    next_tick_ = 0;
    start();
    is_running_ = true;
    is_stale_ = true;
}

void FmuModel::run_until(double time_s) {
    const double ticks = (time_s - start_s_) * tick_rate_Hz_;
    const double due =
        is_due_at_its_start() ? std::ceil(ticks - kTickShare) : std::floor(ticks + kTickShare);
    while (static_cast<double>(next_tick_) < due) {
        tick();
        ++next_tick_;
    }
    time_s_ = time_s;
    is_stale_ = true;
}

void FmuModel::reset() {
    is_running_ = false;
    is_stale_ = true;
    time_s_ = 0.0;
    for (std::size_t i = 0; i < variables_.size(); ++i) {
        values_[i] = variables_[i].start;
    }
}

void FmuModel::visit_all(StateArchive &archive) {
    archive(values_);
    archive(is_running_);
    archive(is_stale_);
    archive(start_s_);
    archive(time_s_);
    archive(next_tick_);
    if (is_running_) {
        const std::vector<double> values = values_;
        if (archive.is_loading()) {
            start(); // makes what the state is loaded into
        }
        visit_state(archive);
        values_ = values;
    }
}

std::vector<std::uint8_t> FmuModel::save() {
    StateArchive archive;
    std::uint32_t names = crc_of_names(variables_);
    archive(names);
    visit_all(archive);
    std::vector<std::uint8_t> bytes = archive.bytes();
    const std::uint32_t crc = crc_of(bytes.data(), bytes.size());
    for (unsigned shift = 0; shift < 32; shift += 8) {
        bytes.push_back(static_cast<std::uint8_t>(crc >> shift));
    }
    return bytes;
}

void FmuModel::load(const std::vector<std::uint8_t> &bytes) {
    constexpr std::size_t kCrcBytes = 4;
    std::uint32_t crc = 0;
    for (std::size_t i = 0; i < kCrcBytes && bytes.size() >= kCrcBytes; ++i) {
        crc |= static_cast<std::uint32_t>(bytes[bytes.size() - kCrcBytes + i]) << 8 * i;
    }
    if (bytes.size() < kCrcBytes || crc != crc_of(bytes.data(), bytes.size() - kCrcBytes)) {
        throw InputError("the saved state is damaged");
    }
    StateArchive archive({bytes.begin(), bytes.end() - kCrcBytes});
    std::uint32_t names = 0;
    archive(names);
    if (names != crc_of_names(variables_)) {
        throw InputError("the saved state is of another model");
    }
    const std::vector<std::uint8_t> before = save();
    try {
        visit_all(archive);
        archive.require_end();
    } catch (const InputError &) {
        StateArchive back({before.begin() + sizeof names, before.end() - kCrcBytes});
        visit_all(back);
        throw;
    }
}

} // namespace quiesce
