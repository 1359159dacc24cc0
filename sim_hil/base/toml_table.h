/// Strict reading of TOML: every key is asked for with what is allowed, and a key that nobody asked
/// for is an error. Messages read "FILE:LINE: key: expected ..., found ...".
#ifndef QUIESCE_TOML_TABLE_H
#define QUIESCE_TOML_TABLE_H

#include <cstdint>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <vector>

namespace quiesce {

/// A node as the library toml++ has it. Its header takes every file that reads it a second of the
/// first build, so only toml_table.cpp does.
struct TomlNode;

/// What a number may be: min .. max, both allowed, in this unit.
struct Range {
    double min;
    double max;
    const char *unit;
};

/// One table of a file. All functions throw InputError for what the file has wrong; those without a
/// fallback also for a key that is missing. Refers to the table of a TomlFile that must outlive it.
class TomlTable {
  public:
    /// table: is one. path: what comes before its keys in messages ("" for the root).
    TomlTable(const TomlNode &table, const std::string &file, std::string path);

    bool has(const std::string &key) const;
    bool is_integer(const std::string &key) const;
    bool is_array(const std::string &key) const;

    double number(const std::string &key, const Range &range);
    double number(const std::string &key, const Range &range, double fallback);
    std::int64_t integer(const std::string &key, std::int64_t min, std::int64_t max);
    std::int64_t integer(const std::string &key, std::int64_t min, std::int64_t max,
                         std::int64_t fallback);
    /// One number, or an array of 1 .. most numbers.
    std::vector<double> coefficients(const std::string &key, std::size_t most, const Range &range);
    bool boolean(const std::string &key, bool fallback);
    std::string text(const std::string &key);
    /// A file that is there, named by its path from the folder of this one.
    std::string path(const std::string &key);
    std::string choice(const std::string &key, const std::vector<std::string> &choices);

    /// An array of texts, none of them empty.
    std::vector<std::string> texts(const std::string &key);

    /// An array of numbers with this length (any length >= 1 where it is 0).
    std::vector<double> numbers(const std::string &key, std::size_t length);
    /// An array of count arrays of count numbers.
    std::vector<std::vector<double>> square(const std::string &key, std::size_t count);

    TomlTable table(const std::string &key);
    std::optional<TomlTable> optional_table(const std::string &key);
    /// [[key]]; empty when there is none.
    std::vector<TomlTable> tables(const std::string &key);

    /// Lets a key stand that this program does not read.
    void accept(const std::string &key) { asked_.insert(key); }

    /// Throws for the first key that none of the above was asked for. Call it last.
    void reject_unknown_keys() const;

    /// The messages of all of them.
    std::vector<std::string> unknown_keys() const;

    /// Every key of the table, in the order of their lines.
    std::vector<std::string> keys() const;

    /// Throws InputError: "FILE:LINE: key: message".
    [[noreturn]] void fail(const std::string &key, const std::string &message) const;

  private:
    std::string message(const std::string &key, const std::string &what) const;
    const TomlNode *find(const std::string &key);
    const TomlNode &require(const std::string &key, const std::string &expected);
    std::string full_key(const std::string &key) const;
    double checked_number(const std::string &key, const TomlNode &node, const Range &range) const;
    std::vector<double> row(const std::string &key, const TomlNode &node, std::size_t length) const;

    const TomlNode *table_;
    std::string file_;
    std::string path_;
    std::set<std::string> asked_;
};

/// A parsed file.
class TomlFile {
  public:
    /// Throws InputError when the file cannot be read or is not TOML.
    explicit TomlFile(const std::string &file);

    /// A file with schema = "..." and version = N, which are checked.
    /// Throws InputError when the file cannot be read, is not TOML, or is of another schema.
    TomlFile(const std::string &file, const std::string &schema, std::int64_t version);

    /// A text that is no file. name: what its messages begin with; paths in it are from the current
    /// folder. Throws InputError when it is not TOML.
    static TomlFile of_text(const std::string &text, const std::string &name);

    TomlTable root() const;

  private:
    TomlFile() = default;

    std::string file_;
    std::shared_ptr<const TomlNode> table_;
};

} // namespace quiesce

#endif
