#include "identifier.h"

#include <algorithm>
#include <cctype>

namespace quiesce {

namespace {

constexpr std::size_t kLongestName = 32;

bool is_identifier(const std::string &text) {
    const auto is_part = [](unsigned char c) {
        return c < 0x80 && (std::isalnum(c) != 0 || c == '_');
    };
    return !text.empty() && text.size() <= kLongestName &&
           std::isalpha(static_cast<unsigned char>(text[0])) != 0 &&
           std::all_of(text.begin(), text.end(), is_part);
}

} // namespace

void require_identifier(const TomlTable &table, const std::string &key, const std::string &name) {
    if (!is_identifier(name)) {
        table.fail(key,
                   "expected a letter, then at most 31 letters, digits or _, found '" + name + "'");
    }
}

} // namespace quiesce
