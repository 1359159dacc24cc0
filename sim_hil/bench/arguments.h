/// Command-line options of one bench command: `--name value`, each declared before it is accepted.
#ifndef QUIESCE_ARGUMENTS_H
#define QUIESCE_ARGUMENTS_H

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

namespace quiesce {

class Arguments {
  public:
    /// words: what follows the command. names: options that it takes, without the dashes.
    /// Throws InputError on an undeclared option or an option without its value.
    Arguments(std::string command, const std::vector<std::string> &words,
              const std::vector<std::string> &names);

    /// The only word that is not an option. Throws InputError, calling it name, unless there is
    /// exactly one.
    std::string only_positional(const std::string &name) const;

    /// Throws InputError when there is a word that is not an option.
    void require_no_positional() const;

    /// Every value given for the option, in order.
    std::vector<std::string> all(const std::string &name) const;

    /// Its only value. Throws InputError when the option is given twice.
    std::optional<std::string> text(const std::string &name) const;

    /// As text, but throws InputError when the option is missing.
    std::string required(const std::string &name) const;

    /// Its value as a number in [min, max]. Throws InputError otherwise.
    std::optional<double> number(const std::string &name, double min, double max) const;
    std::optional<std::int64_t> integer(const std::string &name, std::int64_t min,
                                        std::int64_t max) const;

  private:
    std::string command_;
    std::vector<std::string> positional_;
    std::map<std::string, std::vector<std::string>> values_;
};

/// The whole text as an integer or a finite number; nothing iff it is anything else.
std::optional<std::int64_t> parse_integer(const std::string &text);
std::optional<double> parse_number(const std::string &text);

} // namespace quiesce

#endif
