#include "arguments.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <sstream>

#include "input_error.h"

namespace quiesce {

namespace {

template <typename Number>
std::optional<Number> parse_whole(const std::string &text) {
    Number value{};
    const char *end = text.data() + text.size();
    const auto [stop, error] = std::from_chars(text.data(), end, value);
    if (error != std::errc{} || stop != end) {
        return std::nullopt;
    }
    return value;
}

template <typename Number>
[[noreturn]] void refuse(const std::string &name, const std::string &text, const char *what,
                         Number min, Number max) {
    std::ostringstream message;
    message << "--" << name << " " << text << ": expected " << what << " in " << min << " .. "
            << max;
    throw InputError(message.str());
}

} // namespace

std::optional<std::int64_t> parse_integer(const std::string &text) {
    return parse_whole<std::int64_t>(text);
}

std::optional<double> parse_number(const std::string &text) {
    const std::optional<double> value = parse_whole<double>(text);
    return value && std::isfinite(*value) ? value : std::nullopt;
}

Arguments::Arguments(std::string command, const std::vector<std::string> &words,
                     const std::vector<std::string> &names)
    : command_(std::move(command)) {
    for (std::size_t i = 0; i < words.size(); ++i) {
        if (words[i].rfind("--", 0) != 0) {
            positional_.push_back(words[i]);
            continue;
        }
        const std::string name = words[i].substr(2);
        if (std::find(names.begin(), names.end(), name) == names.end()) {
            throw InputError(command_ + ": unknown option --" + name);
        }
        if (++i == words.size()) {
            throw InputError(command_ + ": option --" + name + " needs a value");
        }
        values_[name].push_back(words[i]);
    }
}

std::string Arguments::only_positional(const std::string &name) const {
    if (positional_.size() != 1) {
        throw InputError(command_ + ": expected exactly one " + name);
    }
    return positional_.front();
}

void Arguments::require_no_positional() const {
    if (!positional_.empty()) {
        throw InputError(command_ + ": unexpected word " + positional_.front());
    }
}

std::vector<std::string> Arguments::all(const std::string &name) const {
    const auto found = values_.find(name);
    return found == values_.end() ? std::vector<std::string>{} : found->second;
}

std::optional<std::string> Arguments::text(const std::string &name) const {
    const std::vector<std::string> values = all(name);
    if (values.size() > 1) {
        throw InputError(command_ + ": option --" + name + " is given more than once");
    }
    return values.empty() ? std::nullopt : std::optional<std::string>(values.front());
}

std::string Arguments::required(const std::string &name) const {
    const std::optional<std::string> value = text(name);
    if (!value) {
        throw InputError(command_ + ": option --" + name + " is missing");
    }
    return *value;
}

std::optional<double> Arguments::number(const std::string &name, double min, double max) const {
    const std::optional<std::string> given = text(name);
    if (!given) {
        return std::nullopt;
    }
    const std::optional<double> value = parse_number(*given);
    if (!value || *value < min || *value > max) {
        refuse(name, *given, "a number", min, max);
    }
    return value;
}

std::optional<std::int64_t> Arguments::integer(const std::string &name, std::int64_t min,
                                               std::int64_t max) const {
    const std::optional<std::string> given = text(name);
    if (!given) {
        return std::nullopt;
    }
    const std::optional<std::int64_t> value = parse_integer(*given);
    if (!value || *value < min || *value > max) {
        refuse(name, *given, "an integer", min, max);
    }
    return value;
}

} // namespace quiesce
