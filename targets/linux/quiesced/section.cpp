#include "section.h"

#include <algorithm>
#include <cctype>

namespace quiesced {

namespace {

bool is_control(char c) {
    return std::iscntrl(static_cast<unsigned char>(c)) != 0;
}

std::string listed(const std::vector<std::uint32_t> &numbers) {
    std::string out;
    for (const std::uint32_t number : numbers) {
        out += (out.empty() ? "" : ", ") + std::to_string(number);
    }
    return out;
}

} // namespace

void Section::one_of(const char *key, const std::vector<std::uint32_t> &allowed,
                     std::uint32_t &value) {
    read(key, false, [&] {
        const auto [least, most] = std::minmax_element(allowed.begin(), allowed.end());
        const std::int64_t found = table_.integer(key, *least, *most);
        if (std::find(allowed.begin(), allowed.end(), found) == allowed.end()) {
            table_.fail(key,
                        "expected one of: " + listed(allowed) + "; found " + std::to_string(found));
        }
        value = static_cast<std::uint32_t>(found);
    });
}

void Section::boolean(const char *key, bool &value) {
    read(key, false, [&] { value = table_.boolean(key, value); });
}

void Section::text(const char *key, std::string &value, bool is_required) {
    read(key, is_required, [&] {
        const std::string found = table_.text(key);
        if (std::any_of(found.begin(), found.end(), is_control)) {
            table_.fail(key, "expected a text without control characters");
        }
        value = found;
    });
}

std::size_t Section::position(const char *key, const std::vector<std::string> &choices) {
    const std::string found = table_.choice(key, choices);
    return static_cast<std::size_t>(std::find(choices.begin(), choices.end(), found) -
                                    choices.begin());
}

void Section::wrong(const char *key, const std::string &what) {
    attempt(problems_, [&] { table_.fail(key, what); });
}

void Section::end() {
    for (std::string &line : table_.unknown_keys()) {
        problems_.push_back(std::move(line));
    }
}

} // namespace quiesced
