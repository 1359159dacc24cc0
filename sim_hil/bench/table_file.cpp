#include "table_file.h"

#include <array>
#include <cstdio>

#include "board_crc.h"
#include "input_error.h"
#include "param_options.h"
#include "table_container.h"
#include "table_verdict.h"

namespace quiesce {

namespace {

void require_ok(quiesce_table_verdict_t verdict, const std::string &file, const TableWords &words) {
    if (verdict != QUIESCE_TABLE_OK) {
        throw InputError(file + ": the controller refuses the table: " + reason_of(verdict, words));
    }
}

TableWords load_of_law(const std::string &file, std::int32_t law) {
    TableWords words = read_table(file).words;
    quiesce_params_t params;
    quiesce_params_default(&params);
    params.law = law;
    require_ok(use_table(*controller_with(nullptr, params), words), file, words);
    return words;
}

TableWords load_of_tracker(const std::string &file) {
    TableWords words = read_table(file).words;
    const auto count = static_cast<std::uint32_t>(words.size());
    quiesce_owner_t owner = QUIESCE_OF_LAW;
    (void)quiesce_table_kind(words.front(), &owner);
    require_ok(owner == QUIESCE_OF_TRACKER ? quiesce_table_check(words.data(), count)
                                           : QUIESCE_TABLE_MAGIC,
               file, words);
    return words;
}

std::string hex(std::uint32_t crc) {
    std::array<char, 11> text{};
    std::snprintf(text.data(), text.size(), "0x%08x", static_cast<unsigned>(crc));
    return text.data();
}

void require_board(const quiesce_board_t &board, const std::string &file) {
    const std::uint32_t made_for = read_table(file).board;
    const std::uint32_t own = board_crc32(board);
    if (made_for != 0 && made_for != own) {
        throw InputError(file + ": made for board " + hex(made_for) + ", and this is board " +
                         hex(own) +
                         "; make it anew, or say that it fits with `quiesce table stamp`");
    }
}

/// The words that it uses from then on: they live as long as it.
TableWords require_accepted(quiesce_t &controller, const std::string &file) {
    TableWords words = read_table(file).words;
    require_ok(use_table(controller, words), file, words);
    return words;
}

} // namespace

std::vector<TableWords> load_tables(const TableFiles &files) {
    std::vector<TableWords> tables;
    if (!files.rules.empty()) {
        tables.push_back(load_of_law(files.rules, QUIESCE_LAW_FUZZY));
    }
    if (!files.pulses.empty()) {
        tables.push_back(load_of_law(files.pulses, QUIESCE_LAW_PHASE));
    }
    if (!files.law.empty()) {
        tables.push_back(read_table(files.law).words);
    }
    if (!files.tracker.empty()) {
        tables.push_back(load_of_tracker(files.tracker));
    }
    return tables;
}

void require_tables(const quiesce_board_t *board, const quiesce_params_t &params,
                    const TableFiles &files) {
    for (const std::string *file : {&files.rules, &files.pulses, &files.law, &files.tracker}) {
        if (board != nullptr && !file->empty()) {
            require_board(*board, *file);
        }
    }
    const auto controller = controller_with(board, params);
    const TableWords law =
        files.law.empty() ? TableWords() : require_accepted(*controller, files.law);
    const char *lacking = quiesce_lacks_table(controller.get());
    if (lacking != nullptr && law_label(params) == lacking) {
        throw InputError("law " + std::string(lacking) +
                         " works with a table: --law-table FILE (quiesce law make)");
    }
    if (lacking != nullptr && files.tracker.empty()) {
        throw InputError("tracker " + std::string(lacking) +
                         " works with a damper's map: --force-map FILE (quiesce identify inverse)");
    }
    if (lacking != nullptr) {
        (void)require_accepted(*controller, files.tracker);
    }
}

} // namespace quiesce
