/// Reads the keys of one table of the configuration and goes on after what is wrong, so that all of
/// it can be told at once.
#ifndef QUIESCED_SECTION_H
#define QUIESCED_SECTION_H

#include <string>
#include <utility>
#include <vector>

#include "input_error.h"
#include "toml_table.h"

namespace quiesced {

using quiesce::InputError;
using quiesce::TomlTable;
using Problems = std::vector<std::string>;

/// Runs a reading step; what it throws becomes a problem.
template <typename Step>
void attempt(Problems &problems, Step &&step) {
    try {
        std::forward<Step>(step)();
    } catch (const InputError &error) {
        problems.emplace_back(error.what());
    }
}

class Section {
  public:
    Section(TomlTable table, Problems &problems) : table_(std::move(table)), problems_(problems) {}

    /// Each leaves the value alone where the key is absent (unless it is required) or wrong.
    template <typename Integer>
    void integer(const char *key, std::int64_t min, std::int64_t max, Integer &value,
                 bool is_required = false) {
        read(key, is_required,
             [&] { value = static_cast<Integer>(table_.integer(key, min, max)); });
    }
    void one_of(const char *key, const std::vector<std::uint32_t> &allowed, std::uint32_t &value);
    void boolean(const char *key, bool &value);
    /// Without control characters.
    void text(const char *key, std::string &value, bool is_required = false);
    /// The position of the text in choices.
    template <typename Enum>
    void choice(const char *key, const std::vector<std::string> &choices, Enum &value,
                bool is_required = false) {
        read(key, is_required, [&] { value = static_cast<Enum>(position(key, choices)); });
    }

    template <typename Step>
    void read(const char *key, bool is_required, Step &&step) {
        table_.accept(key);
        if (is_required || table_.has(key)) {
            attempt(problems_, std::forward<Step>(step));
        }
    }

    bool has(const char *key) const { return table_.has(key); }
    TomlTable &table() { return table_; }
    Problems &problems() { return problems_; }
    /// Notes a problem of a key.
    void wrong(const char *key, const std::string &what);
    /// What nobody asked for is a problem, too. Call it last.
    void end();

  private:
    std::size_t position(const char *key, const std::vector<std::string> &choices);

    TomlTable table_;
    Problems &problems_;
};

/// Reads [key] where it is there; says that it is missing where it is required.
template <typename Read>
void with_section(Section &root, const char *key, bool is_required, Read &&read) {
    root.read(key, is_required, [&] {
        Section section(root.table().table(key), root.problems());
        read(section);
        section.end();
    });
}

} // namespace quiesced

#endif
