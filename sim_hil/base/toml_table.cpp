#include "toml_table.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <numeric>
#include <sstream>
#include <system_error>

#include <toml++/toml.h>

#include "input_error.h"

namespace quiesce {

namespace {

const toml::node &read(const TomlNode &node) {
    return reinterpret_cast<const toml::node &>(node);
}

const TomlNode *opaque(const toml::node *node) {
    return reinterpret_cast<const TomlNode *>(node);
}

const toml::table &read_table(const TomlNode *node) {
    return *read(*node).as_table();
}

std::string joined(const std::vector<std::string> &words) {
    std::string out;
    for (const std::string &word : words) {
        out += (out.empty() ? "" : ", ") + word;
    }
    return out;
}

/// The value as the file has it, for "found ...".
std::string shown(const toml::node &node) {
    if (node.is_table() || node.is_array()) {
        return node.is_table() ? "a table" : "an array";
    }
    std::ostringstream out;
    node.visit([&out](const auto &value) {
        if constexpr (toml::is_value<decltype(value)>) {
            out << value;
        }
    });
    return out.str();
}

/// What a file has in its texts and keys must not break the line, nor steer a terminal.
std::string on_one_line(std::string message) {
    std::replace_if(
        message.begin(), message.end(), [](unsigned char c) { return std::iscntrl(c) != 0; }, ' ');
    return message;
}

/// Letters to put in, take out or change (Levenshtein) from a to b.
std::size_t distance(const std::string &a, const std::string &b) {
    std::vector<std::size_t> row(b.size() + 1);
    std::iota(row.begin(), row.end(), std::size_t{0});
    for (std::size_t i = 0; i < a.size(); ++i) {
        std::size_t diagonal = row[0];
        row[0] = i + 1;
        for (std::size_t j = 0; j < b.size(); ++j) {
            const std::size_t changed = diagonal + (a[i] == b[j] ? 0 : 1);
            diagonal = row[j + 1];
            row[j + 1] = std::min({changed, row[j] + 1, row[j + 1] + 1});
        }
    }
    return row[b.size()];
}

/// The one of `known` that `word` is most likely meant for, and not farther than a third of it.
std::optional<std::string> nearest(const std::string &word, const std::vector<std::string> &known) {
    std::optional<std::string> best;
    std::size_t least = 1 + word.size() / 3;
    for (const std::string &one : known) {
        const std::size_t apart = distance(word, one);
        if (apart > 0 && apart < least) {
            least = apart;
            best = one;
        }
    }
    return best;
}

/// Names of one row, such as end_a and end_b or c0_kg and c1_kg: one is not there for the other.
bool are_of_a_row(const std::string &a, const std::string &b) {
    const auto [in_a, in_b] = std::mismatch(a.begin(), a.end(), b.begin(), b.end());
    if (a.size() != b.size() || in_a == a.end() || !std::equal(in_a + 1, a.end(), in_b + 1)) {
        return false;
    }
    return in_a + 1 == a.end() || std::isdigit(static_cast<unsigned char>(*in_a)) != 0;
}

std::string expected_number(const Range &range) {
    std::ostringstream out;
    out << "expected a number in " << range.min << " .. " << range.max << " (" << range.unit << ")";
    return out.str();
}

} // namespace

TomlTable::TomlTable(const TomlNode &table, const std::string &file, std::string path)
    : table_(&table), file_(file), path_(std::move(path)) {}

std::string TomlTable::full_key(const std::string &key) const {
    return path_.empty() ? key : path_ + "." + key;
}

std::string TomlTable::message(const std::string &key, const std::string &what) const {
    const toml::node *node = read_table(table_).get(key);
    const auto line = (node != nullptr ? *node : read(*table_)).source().begin.line;
    const std::string where = line > 0 ? ":" + std::to_string(line) : "";
    return on_one_line(file_ + where + ": " + full_key(key) + ": " + what);
}

void TomlTable::fail(const std::string &key, const std::string &message) const {
    throw InputError(this->message(key, message));
}

bool TomlTable::has(const std::string &key) const {
    return read_table(table_).contains(key);
}

bool TomlTable::is_integer(const std::string &key) const {
    return has(key) && read_table(table_).get(key)->is_integer();
}

bool TomlTable::is_array(const std::string &key) const {
    return has(key) && read_table(table_).get(key)->is_array();
}

const TomlNode *TomlTable::find(const std::string &key) {
    asked_.insert(key);
    return opaque(read_table(table_).get(key));
}

const TomlNode &TomlTable::require(const std::string &key, const std::string &expected) {
    const TomlNode *node = find(key);
    if (node == nullptr) {
        std::vector<std::string> others = keys();
        others.erase(std::remove_if(others.begin(), others.end(),
                                    [&](const std::string &one) {
                                        return asked_.count(one) > 0 || are_of_a_row(key, one);
                                    }),
                     others.end());
        const std::optional<std::string> meant = nearest(key, others);
        fail(key, "missing; " + (meant ? "is '" + *meant + "' meant for it? " : "") + expected);
    }
    return *node;
}

double TomlTable::checked_number(const std::string &key, const TomlNode &opaque_node,
                                 const Range &range) const {
    const toml::node &node = read(opaque_node);
    const std::optional<double> value =
        node.is_number() ? node.value<double>() : std::optional<double>{};
    if (!value || !(*value >= range.min && *value <= range.max)) {
        fail(key, expected_number(range) + ", found " + shown(node));
    }
    return *value;
}

double TomlTable::number(const std::string &key, const Range &range) {
    return checked_number(key, require(key, expected_number(range)), range);
}

double TomlTable::number(const std::string &key, const Range &range, double fallback) {
    const TomlNode *node = find(key);
    return node == nullptr ? fallback : checked_number(key, *node, range);
}

std::int64_t TomlTable::integer(const std::string &key, std::int64_t min, std::int64_t max) {
    const std::string expected =
        "expected an integer in " + std::to_string(min) + " .. " + std::to_string(max);
    const toml::node &node = read(require(key, expected));
    const auto *value = node.as_integer();
    if (value == nullptr || value->get() < min || value->get() > max) {
        fail(key, expected + ", found " + shown(node));
    }
    return value->get();
}

std::int64_t TomlTable::integer(const std::string &key, std::int64_t min, std::int64_t max,
                                std::int64_t fallback) {
    return find(key) == nullptr ? fallback : integer(key, min, max);
}

std::vector<double> TomlTable::coefficients(const std::string &key, std::size_t most,
                                            const Range &range) {
    if (!is_array(key)) {
        return {number(key, range)};
    }
    std::vector<double> values = numbers(key, 0);
    if (values.size() > most) {
        fail(key, "expected a number or at most " + std::to_string(most) + " coefficients, found " +
                      std::to_string(values.size()));
    }
    return values;
}

bool TomlTable::boolean(const std::string &key, bool fallback) {
    const TomlNode *node = find(key);
    if (node == nullptr) {
        return fallback;
    }
    if (!read(*node).is_boolean()) {
        fail(key, "expected true or false, found " + shown(read(*node)));
    }
    return read(*node).as_boolean()->get();
}

std::string TomlTable::text(const std::string &key) {
    const toml::node &node = read(require(key, "expected a text in quotes"));
    if (!node.is_string() || node.as_string()->get().empty()) {
        fail(key, "expected a text in quotes, found " + shown(node));
    }
    return node.as_string()->get();
}

std::string TomlTable::path(const std::string &key) {
    const std::filesystem::path named = text(key);
    const std::filesystem::path found =
        (std::filesystem::path(file_).parent_path() / named).lexically_normal();
    std::error_code unreadable;
    if (!std::filesystem::is_regular_file(found, unreadable)) {
        fail(key, "there is no file " + found.string() +
                      "; name one that is there, by its path from the folder of this file");
    }
    return found.string();
}

std::string TomlTable::choice(const std::string &key, const std::vector<std::string> &choices) {
    const std::string expected = "expected one of: " + joined(choices);
    const toml::node &node = read(require(key, expected));
    std::string value = node.value<std::string>().value_or("");
    if (std::find(choices.begin(), choices.end(), value) == choices.end()) {
        fail(key, expected + "; found " + shown(node));
    }
    return value;
}

std::vector<std::string> TomlTable::texts(const std::string &key) {
    const std::string expected = "expected an array of texts in quotes";
    const toml::node &node = read(require(key, expected));
    if (!node.is_array()) {
        fail(key, expected + ", found " + shown(node));
    }
    std::vector<std::string> out;
    for (const toml::node &element : *node.as_array()) {
        if (!element.is_string() || element.as_string()->get().empty()) {
            fail(key, expected + ", found " + shown(element));
        }
        out.push_back(element.as_string()->get());
    }
    return out;
}

std::vector<double> TomlTable::row(const std::string &key, const TomlNode &opaque_node,
                                   std::size_t length) const {
    const toml::node &node = read(opaque_node);
    const toml::array *array = node.as_array();
    if (array == nullptr || array->empty() || (length > 0 && array->size() != length)) {
        const std::string count = length > 0 ? std::to_string(length) + " numbers" : "numbers";
        fail(key, "expected an array of " + count + ", found " +
                      (array == nullptr ? shown(node) : std::to_string(array->size())));
    }
    std::vector<double> out;
    for (const toml::node &element : *array) {
        out.push_back(checked_number(key, *opaque(&element), {-1e12, 1e12, "each element"}));
    }
    return out;
}

std::vector<double> TomlTable::numbers(const std::string &key, std::size_t length) {
    return row(key, require(key, "expected an array of numbers"), length);
}

std::vector<std::vector<double>> TomlTable::square(const std::string &key, std::size_t count) {
    const std::string expected =
        "expected " + std::to_string(count) + " rows of " + std::to_string(count) + " numbers";
    const toml::node &node = read(require(key, expected));
    const toml::array *array = node.as_array();
    if (array == nullptr || array->size() != count) {
        fail(key, expected + ", found " +
                      (array == nullptr ? shown(node) : std::to_string(array->size()) + " rows"));
    }
    std::vector<std::vector<double>> out;
    for (const toml::node &element : *array) {
        out.push_back(row(key, *opaque(&element), count));
    }
    return out;
}

TomlTable TomlTable::table(const std::string &key) {
    const toml::node &node = read(require(key, "expected a table [" + full_key(key) + "]"));
    if (!node.is_table()) {
        fail(key, "expected a table [" + full_key(key) + "], found " + shown(node));
    }
    return TomlTable(*opaque(&node), file_, full_key(key));
}

std::optional<TomlTable> TomlTable::optional_table(const std::string &key) {
    return find(key) == nullptr ? std::nullopt : std::optional<TomlTable>(table(key));
}

std::vector<TomlTable> TomlTable::tables(const std::string &key) {
    const TomlNode *found = find(key);
    std::vector<TomlTable> out;
    if (found == nullptr) {
        return out;
    }
    const toml::node &node = read(*found);
    if (!node.is_array_of_tables()) {
        fail(key, "expected tables [[" + full_key(key) + "]], found " + shown(node));
    }
    for (const toml::node &element : *node.as_array()) {
        const std::string index = "[" + std::to_string(out.size() + 1) + "]";
        out.emplace_back(*opaque(&element), file_, full_key(key) + index);
    }
    return out;
}

std::vector<std::string> TomlTable::keys() const {
    std::vector<std::string> out;
    const toml::table &table = read_table(table_);
    for (const auto &[key, node] : table) {
        out.emplace_back(key.str());
    }
    const auto line = [&table](const std::string &key) {
        return table.get(key)->source().begin.line;
    };
    std::stable_sort(out.begin(), out.end(), [&line](const std::string &a, const std::string &b) {
        return line(a) < line(b);
    });
    return out;
}

std::vector<std::string> TomlTable::unknown_keys() const {
    const std::vector<std::string> known(asked_.begin(), asked_.end());
    std::vector<std::string> out;
    for (const std::string &key : keys()) {
        if (asked_.count(key) == 0) {
            const std::optional<std::string> meant = nearest(key, known);
            out.push_back(message(key, "unknown key; " +
                                           (meant ? "is '" + *meant + "' meant? " : "") +
                                           "expected one of: " + joined(known)));
        }
    }
    return out;
}

void TomlTable::reject_unknown_keys() const {
    const std::vector<std::string> unknown = unknown_keys();
    if (unknown.empty()) {
        return;
    }
    const std::size_t more = unknown.size() - 1;
    throw InputError(unknown.front() +
                     (more > 0 ? " (and " + std::to_string(more) + " more unknown keys)" : ""));
}

namespace {

constexpr int kMostParts = 16; // of a key; every value may nest 256 times in the parser
constexpr std::size_t kMostBytes = std::size_t{16} << 20U;

std::string text_of(const std::string &file) {
    std::ifstream in(file, std::ios::binary);
    if (!in) {
        throw InputError(on_one_line(file + ": cannot be read; name a file that is there"));
    }
    std::string text;
    for (std::array<char, 4096> block{}; in;) {
        in.read(block.data(), block.size());
        text.append(block.data(), static_cast<std::size_t>(in.gcount()));
        if (text.size() > kMostBytes) {
            throw InputError(on_one_line(file + ": is greater than any file of settings"));
        }
    }
    return text;
}

/// Position after the string that begins here; where it has no end that of its line, or of the
/// text.
std::size_t after_string(const std::string &text, std::size_t at) {
    const char quote = text[at];
    const std::string triple(3, quote);
    const bool is_long = text.compare(at, 3, triple) == 0;
    at += is_long ? 3 : 1;
    for (; at < text.size(); ++at) {
        if (quote == '"' && text[at] == '\\') {
            ++at;
        } else if (is_long && text.compare(at, 3, triple) == 0) {
            const std::size_t end = text.find_first_not_of(quote, at);
            return std::min({end, at + 5, text.size()}); // it may end with two quotes of its own
        } else if (!is_long && (text[at] == quote || text[at] == '\n')) {
            return text[at] == quote ? at + 1 : at;
        }
    }
    return text.size();
}

/// The parser nests a table for each part of a key, without a bound, and its stack is no greater
/// than any other.
void check_nesting(const std::string &file, const std::string &text) {
    int parts = 1;
    for (std::size_t at = 0; at < text.size();) {
        const char c = text[at];
        if (c == '"' || c == '\'') {
            at = after_string(text, at);
            continue;
        }
        parts = c == '.' ? parts + 1 : std::strchr("=,[]{}\n", c) != nullptr ? 1 : parts;
        if (parts > kMostParts) {
            const auto line =
                1 + std::count(text.begin(), text.begin() + static_cast<std::ptrdiff_t>(at), '\n');
            throw InputError(on_one_line(file + ":" + std::to_string(line) +
                                         ": a key of more than " + std::to_string(kMostParts) +
                                         " parts"));
        }
        at = c == '#' ? std::min(text.find('\n', at), text.size()) : at + 1;
    }
}

std::shared_ptr<const TomlNode> parsed(const std::string &text, const std::string &file) {
    try {
        check_nesting(file, text);
        const auto table = std::make_shared<const toml::table>(toml::parse(text, file));
        return std::shared_ptr<const TomlNode>(table, opaque(table.get()));
    } catch (const toml::parse_error &error) {
        const auto line = error.source().begin.line;
        const std::string where = line > 0 ? ":" + std::to_string(line) : "";
        throw InputError(on_one_line(file + where + ": " + std::string(error.description()) +
                                     "; expected a TOML file"));
    }
}

} // namespace

TomlFile::TomlFile(const std::string &file) : file_(file) {
    std::error_code unreadable; // the parser tells
    if (std::filesystem::is_directory(file, unreadable)) {
        throw InputError(on_one_line(file + ": is a folder, not a file"));
    }
    table_ = parsed(text_of(file), file);
}

TomlFile TomlFile::of_text(const std::string &text, const std::string &name) {
    TomlFile out;
    out.file_ = name;
    out.table_ = parsed(text, name);
    return out;
}

TomlFile::TomlFile(const std::string &file, const std::string &schema, std::int64_t version)
    : TomlFile(file) {
    TomlTable checked = root();
    checked.choice("schema", {schema});
    checked.integer("version", version, version);
}

TomlTable TomlFile::root() const {
    return TomlTable(*table_, file_, "");
}

} // namespace quiesce
