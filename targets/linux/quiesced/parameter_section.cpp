#include "parameter_section.h"

#include <optional>

#include "board_file.h"

namespace quiesced {

namespace {

std::optional<std::uint32_t> index_of(const std::string &name) {
    for (std::uint32_t index = 0; index < QUIESCE_PARAM_COUNT; ++index) {
        if (name == quiesce_param_info(index)->name) {
            return index;
        }
    }
    return std::nullopt;
}

std::vector<std::string> labels_of(const quiesce_param_info_t &info) {
    std::vector<std::string> labels;
    for (std::int32_t i = 0; info.labels != nullptr && i <= info.max; ++i) {
        labels.emplace_back(info.labels[i]);
    }
    return labels;
}

std::string listed_choices(const quiesce_param_info_t &info) {
    std::string out;
    for (std::uint32_t i = 0; i < info.choice_count; ++i) {
        out += (out.empty() ? "" : ", ") + std::to_string(info.choices[i]);
    }
    return out;
}

bool is_choice(const quiesce_param_info_t &info, std::int64_t value) {
    for (std::uint32_t i = 0; i < info.choice_count; ++i) {
        if (info.choices[i] == value) {
            return true;
        }
    }
    return info.choices == nullptr;
}

/// A label where there are labels and the value is none of their numbers.
std::int32_t read_value(TomlTable &table, const std::string &key,
                        const quiesce_param_info_t &info) {
    if (info.labels != nullptr && !table.is_integer(key)) {
        const std::vector<std::string> labels = labels_of(info);
        const std::string label = table.choice(key, labels);
        std::int32_t value = 0;
        while (labels[static_cast<std::size_t>(value)] != label) {
            ++value;
        }
        return value;
    }
    const std::int64_t value = table.integer(key, info.min, info.max);
    if (!is_choice(info, value)) {
        table.fail(key,
                   "expected one of: " + listed_choices(info) + "; found " + std::to_string(value));
    }
    return static_cast<std::int32_t>(value);
}

} // namespace

quiesce_params_t read_parameters(Section &section, bool has_board) {
    quiesce_params_t params{};
    quiesce_params_default(&params);
    TomlTable &table = section.table();
    const std::size_t problems_before = section.problems().size();
    for (const std::string &key : table.keys()) {
        table.accept(key);
        const std::optional<std::uint32_t> index = index_of(key);
        if (!index) {
            section.wrong(key.c_str(),
                          "no such parameter; docs/reference/parameters.md lists them");
            continue;
        }
        if (has_board && quiesce::is_of_board(key)) {
            section.wrong(key.c_str(), "comes from the board file");
            continue;
        }
        attempt(section.problems(), [&] {
            quiesce_param_set(&params, *index, read_value(table, key, *quiesce_param_info(*index)));
        });
    }
    quiesce_param_error_t error{};
    if (section.problems().size() == problems_before && !quiesce_params_check(&params, &error)) {
        section.wrong(quiesce_param_info(error.index)->name, error.reason);
    }
    return params;
}

} // namespace quiesced
